#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace gauntlet::sim {

/// Finds the unit of a sender's time whose name has none, such as `t`: the unit in which it
/// advances as fast as the arrivals, within a quarter, over half a second.
class SenderClock {
 public:
  /// True if a name of TimeScaleS() does not contain its unit.
  static bool NeedsUnit(std::string_view name);

  void Restart() { first_arrival_ns_.reset(); }
  /// The next frame. Returns seconds per unit once they are known.
  std::optional<double> Add(double time, std::int64_t arrival_ns);

 private:
  std::optional<std::int64_t> first_arrival_ns_;
  double first_time_ = 0.0;
};

}  // namespace gauntlet::sim
