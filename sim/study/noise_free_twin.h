#pragma once

#include "sim/study/study.h"

namespace gauntlet::sim {

/// Source of the noise-free twin of the trials of a seed.
enum class TwinSource {
  kNone,    // not wanted, or not to be had: a recorded glove cannot be without its noise
  kItself,  // the trial has no noise, nor faults
  kTrial,   // a trial of its own, before the other
};
TwinSource TwinOf(const Study& study, int seed);

}  // namespace gauntlet::sim
