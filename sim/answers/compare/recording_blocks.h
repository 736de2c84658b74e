#pragma once

#include <string>
#include <vector>

#include "sim/score/statistics/blocks.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

/// The first trial of each controller of a study, to be divided into blocks.
struct CountedTime {
  std::vector<CountedTicks> joints;  // the ticks that count, per measured joint
  int ticks = 0;                     // of the trial
  double duration_s = 0.0;           // of the ticks that count, mean over joints
  /// Autocorrelation time of the differences of all pairs of controllers, see DivideRecording(); of
  /// one controller that of its own errors.
  double correlation_s = 0.0;
};

/// The result has the signals of its first trials. Errors are not scored where a trial failed.
CountedTime CountedTimeOf(const Study& study, const StudyResult& result);

/// Blocks side by side that hold equal amounts of ticks that count, summed over joints. Together
/// they are the whole trial.
std::vector<TickRange> DivideTicks(const CountedTime& time, int count);

/// True for a score that the jackknife serves: means over time, their roots, and delays, of the
/// main metrics. Extreme values have no values of blocks.
bool HasBlockValues(const Metric& metric);

/// A block of a trial [s], from its begin.
struct RecordingBlock {
  double start_s = 0.0;
  double end_s = 0.0;
};

/// Blocks of a single recording as replicates of a comparison. The trials are not restarted: a
/// block is left out of the scores alone.
struct RecordingBlocks {
  bool is_wanted = false;   // one recording, and nothing is drawn at random
  double duration_s = 0.0;  // of the time that counts, mean over joints
  BlockPlan plan;           // no blocks: the recording is too short
  std::vector<RecordingBlock> blocks;
  /// Controllers x metrics x blocks, see BlockValues(). Empty where a score has none: it is no main
  /// metric, or without some block it has no value.
  std::vector<std::vector<std::vector<double>>> values;

  bool empty() const { return blocks.empty(); }
  /// "12 blocks of 5.0 s"; empty without blocks.
  std::string Text() const;
};

/// Divides the recording of a comparison. The blocks are the same for all controllers, and hold
/// equal amounts of time that counts. Their length follows from the autocorrelation time of the
/// differences of all pairs of controllers,
///
///     d(t) = mean over joints of e_1^2 / (2 RMS_1) - e_2^2 / (2 RMS_2)
///
/// in the error e and in the jitter e of the hand, over the smallest relevant differences of these:
/// so the pairs with the widest intervals decide. A controller of which the trial failed has no
/// values. Deterministic for any number of jobs.
RecordingBlocks DivideRecording(const Study& study, const StudyResult& result, int jobs);

}  // namespace gauntlet::sim
