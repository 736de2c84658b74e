#include "sim/report/prediction_text.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

/// "46 to 132 ms", or "45 ms" for all channels.
std::string HorizonText(const PredictionCeiling& ceiling) {
  const bool alike = ceiling.shortest_horizon_ms == ceiling.longest_horizon_ms;
  return (alike ? "" : fmt::format("{:.0f} to ", ceiling.shortest_horizon_ms)) +
         fmt::format("{:.0f} ms", ceiling.longest_horizon_ms);
}

}  // namespace

std::string PredictionText(const PredictionCeiling& ceiling) {
  const std::string used =
      std::isfinite(ceiling.used.mean)
          ? fmt::format(
                "uses {:.0f} % ({:.0f} to {:.0f}) of what weights of each channel, fitted to "
                "other repetitions, can predict",
                100.0 * ceiling.used.mean, 100.0 * ceiling.used.low, 100.0 * ceiling.used.high)
          : "has next to nothing to predict, as weights fitted to other repetitions show";
  return fmt::format(
      "{} looks {} ahead and {}: without a hand, what is asked for is {} deg RMS from the wearer "
      "that much later, the glove as it is {}, fitted weights {}, the glove if known ahead {}.",
      ceiling.controller, HorizonText(ceiling), used, Short(ceiling.ours.mean),
      Short(ceiling.now.mean), Short(ceiling.fitted.mean), Short(ceiling.known.mean));
}

}  // namespace gauntlet::sim
