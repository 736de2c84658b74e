#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// The candidate that the user probably meant: the one with the fewest inserted, removed, replaced
/// or swapped letters, at most a third of the name's length. Among equally near ones, the first
/// that only adds letters, else the first. Empty if none is near.
std::string NearestName(std::string_view name, const std::vector<std::string>& candidates);

/// ` (did you mean X?)`, or ` (one of: A, B, C)` if no candidate is near. A long list is cut and
/// ends with the number of names left out.
std::string Suggestion(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace gauntlet::sim
