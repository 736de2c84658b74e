#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/score/statistics/blocks.h"
#include "sim/study/study_run.h"

namespace gauntlet::sim {

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
