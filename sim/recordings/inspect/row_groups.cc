#include "sim/recordings/inspect/row_groups.h"

#include <cmath>

namespace gauntlet::sim {
namespace {

constexpr std::size_t kMostGroups = 64;

}  // namespace

void RowGroups::Add(double group) {
  if (std::isnan(group) || groups_.size() > kMostGroups) return;
  const bool is_known = !groups_.insert(group).second;
  returns_ += is_known && group != before_ ? 1.0 : 0.0;
  before_ = group;
  ++rows_;
}

std::size_t RowGroups::count() const { return groups_.size() > kMostGroups ? 0 : groups_.size(); }

bool RowGroups::Alternate() const {
  constexpr double kOften = 0.3;  // of the rows
  return count() > 1 && returns_ > kOften * rows_;
}

}  // namespace gauntlet::sim
