#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/recordings/column_map.h"
#include "sim/recordings/envelope.h"

namespace gauntlet::sim {

/// Channels from the columns of rows, in the same way for files, streams of text and live frames:
///
///     value = sum of factor * envelope(unwrapped(column)) + offset    over the parts of a channel
///
/// Units: those of factor and offset.
class ChannelValues {
 public:
  struct Part {
    std::size_t column = 0;
    double factor = 1.0;
    double offset = -0.0;      // which leaves every number as it is, a zero's sign included
    double wraps_at = 0.0;     // as in ColumnMapping
    double envelope_ms = 0.0;  // as in ColumnMapping
  };
  using Parts = std::vector<Part>;

  ChannelValues() = default;
  explicit ChannelValues(std::vector<Parts> channels);

  std::size_t size() const { return channels_.size(); }
  const Parts& parts(std::size_t channel) const { return channels_[channel]; }
  /// True if a value depends on the times of the rows.
  bool needs_time() const;

  /// The value of a channel in the next row, which is at `time_s`. NaN if a part of it is missing;
  /// that of an envelope also is where the time does not rise. A clock that goes back by more than
  /// a second was started anew, and the envelope with it.
  double Next(std::size_t channel, double time_s, std::span<const double> row);

  /// Jumps of a part that were undone so far.
  std::size_t jumps(std::size_t channel, std::size_t part) const {
    return states_[channel][part].jumps;
  }

 private:
  struct State {
    double before = std::numeric_limits<double>::quiet_NaN();
    double turned = 0.0;  // added to values since the last jump
    std::size_t jumps = 0;
    std::optional<Envelope> envelope = std::nullopt;
    double time_s = -std::numeric_limits<double>::infinity();  // of the last value
  };
  /// A value without its jumps by `wraps_at`.
  static double Unwrapped(double value, double wraps_at, State& state);

  std::vector<Parts> channels_;
  std::vector<std::vector<State>> states_;  // of the parts
};

/// One sentence for each envelope of a map: it lags, and what it is of.
std::vector<std::string> EnvelopesOf(const ColumnMap& map);

/// A clock that goes back further than this was started anew; less is a row out of order.
inline constexpr double kClockRestart_s = 1.0;

}  // namespace gauntlet::sim
