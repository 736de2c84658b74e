#include "sim/score/score_config.h"

#include <cmath>

#include "sim/score/jitter.h"

namespace gauntlet::sim {

void ScoreConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"jitter_above_hz",
                  "where jitter begins: nothing counts below 0.8, all above 1.2 times this (at "
                  "most 6.6 for a tremor of 8 to 12 Hz)",
                  2, 100},
                 jitter_above_hz);
  visitor.Flag({"noise_free_twin",
                "run every trial also with a noise-free glove, for what its noise adds and for the "
                "causes of the error; false: half the time, and these scores are missing"},
               noise_free_twin);
  visitor.Number({"recovery_s",
                  "after a gap or restart of a recording nothing counts for so long, as filters "
                  "and hand come back",
                  0, 60},
                 recovery_s);
}

void ScoreConfig::Check(double rate_hz, Eigen::Index ticks) const {
  const Eigen::Index needed = TremblingTicks(rate_hz, jitter_above_hz);
  if (ticks >= needed || jitter_above_hz >= ScoreConfig{}.jitter_above_hz) return;
  const double lowest_hz =  // rounded up, to be enough
      0.1 *
      std::ceil(10.0 * jitter_above_hz * static_cast<double>(needed) / static_cast<double>(ticks));
  using controller::NumberText;
  throw controller::SettingError(
      "jitter_above_hz",
      "is " + NumberText(jitter_above_hz) + ", must be at least " + NumberText(lowest_hz) +
          " in a trial of " + NumberText(static_cast<double>(ticks) / rate_hz) +
          " s: the high pass needs " + NumberText(static_cast<double>(needed) / rate_hz) + " s");
}

}  // namespace gauntlet::sim
