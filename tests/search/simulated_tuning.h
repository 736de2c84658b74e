#pragma once

#include <cstdint>

namespace gauntlet::sim {

/// Motion of a simulated wearer of one sensor.
enum class SimulatedMotion {
  kContinuous,  // a Gaussian process, low-passed twice at 1 Hz
  kMovements,   // movements of 0.4 to 1.2 s between random places, and rests of 1 s on average
};

struct TuningShape {
  SimulatedMotion motion = SimulatedMotion::kContinuous;
  double duration_s = 60.0;  // of a recording
  double fresh_s = 1500.0;   // of the fresh motion, in one recording or in as many as fit
  int files = 1;             // recordings of a scenario
  int scenarios = 100;
  std::uint64_t seed = 1;
  int jobs = 1;
};

/// The gain that Tune() prints, for the window of a moving average, against the gain of the same
/// setting in long fresh motion of the same wearer.
struct TuningOutcome {
  int answered = 0;          // not refused as too short
  int covered = 0;           // 95 % intervals that contain the fresh gain
  double printed_deg = 0.0;  // mean gain on held-out parts
  double fresh_deg = 0.0;    // mean gain in fresh motion
  int equal_parts = 0;       // the chosen setting scores the same on both parts, to the last bit
};

TuningOutcome SimulateTuning(const TuningShape& shape);

}  // namespace gauntlet::sim
