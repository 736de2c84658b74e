#include "sim/base/nearest_name.h"

#include <fmt/format.h>

#include <algorithm>

namespace gauntlet::sim {
namespace {

// Longest list in a message, in characters; a longer one ends with the number of names left out.
constexpr std::size_t kLongList = 120;
// Longest name. A longer text has no near name.
constexpr std::size_t kLongName = 100;

/// Damerau-Levenshtein distance (optimal string alignment).
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

/// True if `candidate` contains all letters of `name` in their order: letters are missing in
/// `name`.
bool LacksLettersOnly(std::string_view name, std::string_view candidate) {
  std::size_t found = 0;
  for (const char letter : candidate) {
    if (found < name.size() && name[found] == letter) ++found;
  }
  return found == name.size();
}

}  // namespace

std::string NearestName(std::string_view name, const std::vector<std::string>& candidates) {
  std::string nearest;
  if (name.size() > kLongName) return nearest;
  std::size_t best = std::max<std::size_t>(1, (name.size() + 2) / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = EditDistance(name, candidate);
    const bool likelier = distance == best && !nearest.empty() &&
                          LacksLettersOnly(name, candidate) && !LacksLettersOnly(name, nearest);
    if (distance < best || likelier) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

std::string Suggestion(std::string_view name, const std::vector<std::string>& candidates) {
  if (candidates.empty()) return "";
  if (const std::string nearest = NearestName(name, candidates); !nearest.empty()) {
    return fmt::format(" (did you mean {}?)", nearest);
  }
  std::string list;
  std::size_t shown = 0;
  for (; shown < candidates.size() && list.size() < kLongList; ++shown) {
    list += (shown == 0 ? "" : ", ") + candidates[shown];
  }
  if (shown < candidates.size()) list += fmt::format(", and {} more", candidates.size() - shown);
  return fmt::format(" (one of: {})", list);
}

}  // namespace gauntlet::sim
