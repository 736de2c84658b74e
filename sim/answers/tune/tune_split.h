#pragma once

#include <string>
#include <vector>

#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

struct TunePlan;

/// One repetition of a scenario, divided into a part for the search and a part for the verdict.
struct DividedRecording {
  int number = 0;  // of the recording, from 0: the same where repetitions share their motion
  std::vector<TickRange> fitted;    // blocks; the held-out ones follow behind
  std::vector<TickRange> held_out;  // blocks
  double length_s = 0.0;            // of a block
  double widening = 1.0;            // see BlockPlan::Widening()
};

/// The two parts of a search: settings are found on the first, and judged on the second.
enum class TunePart { kFitted, kHeldOut };

/// Division of the replicates of a search. Seeds are replicates of noise and of simulated motions.
/// A recording is the same for every seed. So recordings are divided as a whole, or each by time.
struct TuneSplit {
  enum class By { kSeeds, kRecordings, kBlocks };
  By by = By::kSeeds;
  int first_seed = 1;
  int fitted = 1;    // seeds or recordings; of blocks the seeds of both parts
  int held_out = 1;  // the same, behind the fitted ones
  int recordings = 0;
  bool is_fixed = false;  // seeds repeat one run, which is no recording: nothing is held out
  std::vector<DividedRecording> divided = {};  // of blocks: per repetition

  /// Blocks of a part, over all recordings.
  int BlocksOf(TunePart part) const;
  /// "seeds", "recordings" or "blocks": the replicates.
  std::string Noun() const;
  /// "seeds 1 to 8", "held-out blocks 5 to 8 of this recording".
  std::string Text(TunePart part) const;
  /// Advice to a user whose interval is too wide: "More seeds can decide it."
  std::string Cure() const;
};

/// Finds the division of a plan. Recordings are whole replicates if the plan's seeds do not exceed
/// them, or if there are eight: half of them is held out, in the ratio of the plan's seeds. Else
/// each is divided into blocks as those of a comparison, see DivideRecording(). The first half of
/// its blocks is fitted, the second is held out. The correlation time is that of the controller's
/// own errors before it is tuned.
/// Errors: UserError, SettingError; RunError if a recording is too short, or the controller does
/// not run.
TuneSplit SplitOf(const TunePlan& plan, int jobs);

}  // namespace gauntlet::sim
