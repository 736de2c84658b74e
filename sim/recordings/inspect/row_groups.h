#pragma once

#include <cstddef>
#include <optional>
#include <set>

namespace gauntlet::sim {

/// Watches one column that may tell the rows of several hands, devices or sessions apart.
class RowGroups {
 public:
  explicit RowGroups(std::size_t column) : column_(column) {}

  std::size_t column() const { return column_; }
  /// `group` is a number or a text's number.
  void Add(double group);

  /// Number of different groups; 0 if there are too many to be hands, devices or sessions.
  std::size_t count() const;
  /// True if groups take turns from row to row.
  bool Alternate() const;

 private:
  std::size_t column_;
  double rows_ = 0.0;
  double returns_ = 0.0;  // changes to a group that had rows before
  std::optional<double> before_;
  std::set<double> groups_;
};

}  // namespace gauntlet::sim
