#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// The candidate that `name` was probably meant to be: the smallest number of inserted, removed,
/// replaced or swapped letters, at most a third of the name's length. Of several equally near, the
/// first that only has letters more, else the first. Empty if there is none.
std::string NearestName(std::string_view name, const std::vector<std::string>& candidates);

/// ` (did you mean X?)`, or ` (one of: A, B, C)` where no name is near. Of a long list the
/// beginning, and how many more there are.
std::string Suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace gauntlet::sim
