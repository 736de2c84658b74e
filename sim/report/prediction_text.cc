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

std::string UsedShareText(const MeanInterval& used) {
  return fmt::format("{:.0f} % ({:.0f} to {:.0f})", 100.0 * used.mean, 100.0 * used.low,
                     100.0 * used.high);
}

/// "86 % (79 to 93) of what weights of each channel can predict, 52 % (..) of what weights of all
/// can".
std::string UsedText(const PredictionCeiling& ceiling) {
  if (!std::isfinite(ceiling.used.mean)) return "has next to nothing to predict";
  std::string text =
      "uses " + UsedShareText(ceiling.used) + " of what weights of each channel's past can predict";
  if (std::isfinite(ceiling.used_of_all.mean)) {
    text += ", " + UsedShareText(ceiling.used_of_all) + " of what weights of all channels can";
  }
  return text;
}

}  // namespace

std::string PredictionText(const PredictionCeiling& ceiling) {
  const char* fitted_to = ceiling.is_same_motion ? "fitted to other repetitions of the same motion"
                                                 : "fitted to other repetitions";
  std::string fitted = Short(ceiling.fitted.mean) + " with weights of each channel";
  if (std::isfinite(ceiling.fitted_to_all.mean)) {
    fitted += ", " + Short(ceiling.fitted_to_all.mean) + " of all";
  }
  return fmt::format(
      "{} looks {} ahead and {} ({}). Without a hand, what is asked for is {} deg RMS from the "
      "wearer that much later; the glove as it is {}, {}, the glove if known ahead {}.",
      ceiling.controller, HorizonText(ceiling), UsedText(ceiling), fitted_to,
      Short(ceiling.ours.mean), Short(ceiling.now.mean), fitted, Short(ceiling.known.mean));
}

}  // namespace gauntlet::sim
