#include "sim/answers/compare/smoothing_ranking.h"

#include <variant>

#include "sim/score/no_score.h"
#include "sim/study/trial_score.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {

std::vector<SmoothingRank> RankBySmoothing(const Study& study, const StudyResult& result) {
  const int seed = study.scenario.seed;
  GloveConfig config = GloveOf(study.scenario, seed);
  auto* recording = std::get_if<RecordedMotionConfig>(&config.motion.settings);
  const bool is_smoothed = recording != nullptr && recording->use == RecordingUse::kMeasured &&
                           recording->reference.empty();
  if (!is_smoothed || result.first_traces.empty()) return {};
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t wanted[] = {tracking};
  std::vector<SmoothingRank> ranks;
  for (const double smoothing_hz : {0.5, 1.0, 2.0, 5.0}) {
    recording->smoothing_hz = smoothing_hz;
    const GloveSignal glove = SynthesiseGlove(config, static_cast<std::uint64_t>(seed));
    const Signal reference_rad = ReferenceAngles(study.joint_map(), glove.true_angle_rad);
    SmoothingRank& rank = ranks.emplace_back();
    rank.smoothing_hz = smoothing_hz;
    for (std::size_t c = 0; c < result.first_traces.size(); ++c) {
      const Trace& trace = result.first_traces[c];
      rank.tracking_rmse_deg.push_back(trace.health.ok
                                           ? ScoreTrial(study, study.scenario.controllers[c].config,
                                                        glove, reference_rad, trace, {}, wanted)
                                                 .summary[tracking]
                                           : kNoScore);
    }
  }
  return ranks;
}

}  // namespace gauntlet::sim
