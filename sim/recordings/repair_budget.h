#pragma once

#include <string>
#include <string_view>

namespace gauntlet::sim {

/// Whether a kind of problem, as RecordingReader calls it, needs a repair: something that stands in
/// the file is left out, or time is not what it says. A value that is missing is no repair, nor is
/// one beyond the joint's range.
bool NeedsRepair(std::string_view problem);

/// What most likely is wrong with a file of which so much needs repair, and what to do, by the
/// problem that is most frequent. `usual_step_s` is the median time between rows. Empty where
/// nothing is likelier than a bad file.
std::string LikelyCause(std::string_view most_frequent_problem, double usual_step_s);

}  // namespace gauntlet::sim
