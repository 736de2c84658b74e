#pragma once

#include <string>
#include <string_view>

namespace gauntlet::sim {

/// Problems that the rows of a recording can have, by name.
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

/// True if it needs a repair: something that stands in the file is left out, or time is not what it
/// says. A value that is missing is no repair, nor is one beyond the joint's range.
bool NeedsRepair(RecordingProblem problem);

/// Likeliest cause in a file of which so much needs this repair, and the remedy. `usual_step_s` is
/// the median time between rows. Empty where nothing is likelier than a bad file.
std::string LikelyCause(RecordingProblem problem, double usual_step_s);

}  // namespace gauntlet::sim
