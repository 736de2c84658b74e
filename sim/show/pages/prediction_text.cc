#include "sim/show/pages/prediction_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

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

/// "Its gain is 54 % (50 to 58) of that of a linear predictor of each channel, and .."
std::string UsedText(const PredictionCeiling& ceiling) {
  if (!std::isfinite(ceiling.used.mean)) return "A fitted linear predictor gains next to nothing.";
  const std::string of_all = UsedShareText(ceiling.used_of_all) + " of that of one of all channels";
  const bool has_all = std::isfinite(ceiling.used_of_all.mean);
  if (std::max(std::abs(ceiling.used.low - 1.0), std::abs(ceiling.used.high - 1.0)) < 1e-9) {
    return "It is the linear predictor of each channel" +
           (has_all ? ": its gain is " + of_all : std::string()) + ".";
  }
  return "Its gain is " + UsedShareText(ceiling.used) +
         " of that of a linear predictor of each channel" + (has_all ? ", and " + of_all : "") +
         ".";
}

}  // namespace

std::string PredictionText(const PredictionCeiling& ceiling) {
  std::string fitted = Short(ceiling.fitted.mean);
  if (std::isfinite(ceiling.fitted_to_all.mean)) {
    fitted += ", of all channels " + Short(ceiling.fitted_to_all.mean);
  }
  return fmt::format(
      "{} predicts {} ahead. {} Prediction error without the hand, deg RMS: {} {}, no prediction "
      "{}, linear predictor {}, true future of the glove {}. The linear predictor is fitted to the "
      "other replicates{}.",
      ceiling.controller, HorizonText(ceiling), UsedText(ceiling), ceiling.controller,
      Short(ceiling.ours.mean), Short(ceiling.now.mean), fitted, Short(ceiling.known.mean),
      ceiling.is_same_motion ? ", all of the same motion" : "");
}

}  // namespace gauntlet::sim
