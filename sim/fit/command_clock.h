#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sim/base/signal.h"

namespace gauntlet::sim {

/// Clock of the command frames in rows of a log (counted from 0): frame n is sent at first_row + n
/// period_rows. A row contains the command of the last frame that was sent before it or together
/// with it. By default each row is a frame.
struct CommandClock {
  double period_rows = 1.0;
  double first_row = 0.0;
  double open_rows = 0.0;  // possible error of all times

  /// Time at which the frame that appears first in this row was sent: after the row before, at the
  /// latest at `row`.
  double SentAt(Eigen::Index row) const;
};

/// Change of the command from row to row, as a share of its travel; 0 in the first row and where it
/// is constant.
std::vector<double> ChangesOf(std::span<const double> command_deg);

/// Sum of the changes of all commands, which one frame changes together.
std::vector<double> ChangesOf(const Signal& command_deg);

/// Finds the clock of the frames. A change at row k belongs to a frame n with
///
///     k - 1 < first_row + n period_rows <= k,
///
/// Hundreds of changes leave almost no freedom for such a line; the middle of the rest is taken. If
/// changes come at multiples of n >= 2 rows only, frames are sent together with their rows, as in a
/// log that is written where the commands are sent. A frame need not change the command.
///
/// Frames may deviate from their clock by a quarter of min(1, period - 1) rows. Their period must
/// exceed a row by 4 %. With shorter periods every row changes, and the clock is not visible.
///
/// None if no clock is found: for a smooth, noisy or quantised command. Also none if chance may
/// explain the clock: with few changes, with changes of equal size, and for a command that moves
/// slowly wherever a row repeats a value.
/// Source: line between upper and lower bounds: O'Rourke, CACM 24, 574-578 (1981).
std::optional<CommandClock> FindCommandClock(std::span<const double> changes);

/// Steps of a command that is constant in most rows, such as a test of steps. Each step happened
/// between its row and the row before. If the steps have an even distance that is no whole number
/// of rows, all rows together tell when; otherwise the time is known within half a row. None for
/// other commands.
std::optional<CommandClock> StepsOf(std::span<const double> changes);

}  // namespace gauntlet::sim
