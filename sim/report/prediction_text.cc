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

/// "It removes 54 % (50 to 58) of the error that fitted weights of each channel remove, and .."
std::string UsedText(const PredictionCeiling& ceiling) {
  if (!std::isfinite(ceiling.used.mean)) return "Fitted weights remove next to nothing.";
  std::string text = "It removes " + UsedShareText(ceiling.used) +
                     " of the error that fitted weights of each channel remove";
  if (std::isfinite(ceiling.used_of_all.mean)) {
    text += ", and " + UsedShareText(ceiling.used_of_all) + " of what weights of all channels do";
  }
  return text + ".";
}

}  // namespace

std::string PredictionText(const PredictionCeiling& ceiling) {
  std::string fitted = Short(ceiling.fitted.mean);
  if (std::isfinite(ceiling.fitted_to_all.mean)) {
    fitted += ", of all channels " + Short(ceiling.fitted_to_all.mean);
  }
  return fmt::format(
      "{} looks {} ahead. {} Error without a hand, deg RMS: no prediction {}, {} {}, fitted "
      "weights {}, true future of the glove {}. The weights are fitted to other repetitions{}.",
      ceiling.controller, HorizonText(ceiling), UsedText(ceiling), Short(ceiling.now.mean),
      ceiling.controller, Short(ceiling.ours.mean), fitted, Short(ceiling.known.mean),
      ceiling.is_same_motion ? ", all of the same motion" : "");
}

}  // namespace gauntlet::sim
