#include "sim/study/noise_free_twin.h"

namespace gauntlet::sim {

TwinSource TwinOf(const Study& study, int seed) {
  if (!study.scenario.score.noise_free_twin) return TwinSource::kNone;
  const int repetition = (seed - study.scenario.seed) % static_cast<int>(study.repetitions.size());
  if (study.repetitions[repetition].is_recorded) return TwinSource::kNone;
  const bool itself = IsWithoutNoise(GloveOf(study.scenario, seed));
  return itself ? TwinSource::kItself : TwinSource::kTrial;
}

}  // namespace gauntlet::sim
