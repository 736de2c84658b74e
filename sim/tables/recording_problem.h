#pragma once

#include <string>
#include <string_view>

namespace gauntlet::sim {

/// What can be wrong in the rows of a recording, by its name.
enum class RecordingProblem {
  kBeyondRange,
  kClockRestart,
  kGap,
  kFarBeyondRange,
  kGlitch,
  kShortHeader,
  kMissingValue,
  kNoTime,
  kNotANumber,
  kNotFinite,
  kRepeatedTime,
  kOutOfOrder,
  kRowTooLong,
  kTimeOutOfRange,
  kTruncatedRow,
  kWildTime,
};

/// As remarks call it.
std::string_view NameOf(RecordingProblem problem);

/// Whether it needs a repair: something that stands in the file is left out, or time is not what it
/// says. A value that is missing is no repair, nor is one beyond the joint's range.
bool NeedsRepair(RecordingProblem problem);

/// What most likely is wrong with a file of which so much needs this repair, and what to do.
/// `usual_step_s` is the median time between rows. Empty where nothing is likelier than a bad file.
std::string LikelyCause(RecordingProblem problem, double usual_step_s);

}  // namespace gauntlet::sim
