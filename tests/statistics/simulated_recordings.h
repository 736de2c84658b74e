#pragma once

#include <cstdint>

namespace gauntlet::sim {

/// Errors of two controllers in one recording, at 10 Hz. x is a standard Gauss-Markov process with
/// the correlation time of the case, w and v are white.
enum class RecordedErrors {
  kLevel,        // squared errors 100 + 10 x and 95 + 7 x', independent
  kOwn,          // errors x and 0.9 x', independent
  kShared,       // errors x + 0.3 w and 0.8 x + 0.3 v
  kOscillating,  // the same with x a damped oscillation of 2 s
  kMovements,    // the same with x the speed of movements of 0.4 to 1.2 s and rests
  kRareFast,     // the same; peak speeds are exponential, so that few movements decide
};

struct RecordingsShape {
  RecordedErrors errors = RecordedErrors::kOwn;
  double correlation_s = 1.0;  // of x; of movements the mean rest [s]
  double duration_s = 60.0;
  int recordings = 1000;
  std::uint64_t seed = 1;
};

/// Intervals of the difference of the two RMS errors, from blocks.
struct RecordingsOutcome {
  double correlation_s = 0.0;    // mean autocorrelation time that was found
  double with_intervals = 0.0;   // share of recordings
  double coverage = 0.0;         // of the 95 % intervals, NaN without any
  double family_coverage = 0.0;  // of those of a family of 45 questions
  double blocks = 0.0;           // mean
};

RecordingsOutcome SimulateRecordings(const RecordingsShape& shape);

}  // namespace gauntlet::sim
