#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sim/base/signal.h"

namespace gauntlet::sim {

/// When the frames of a command were sent, in rows of a log: at first_row + n period_rows. Rows are
/// counted from 0, and each shows the command of the last frame before it, or of one that is sent
/// with it. By default each row is a frame.
struct FrameClock {
  double period_rows = 1.0;
  double first_row = 0.0;
  double open_rows = 0.0;  // so much earlier or later all frames may have been sent

  /// When the frame was sent that this row is the first to show: after the row before, by `row`.
  double SentAt(Eigen::Index row) const;
};

/// How far a command is from that of the row before, of its travel; 0 in the first row and where it
/// holds still.
std::vector<double> ChangesOf(std::span<const double> command_deg);

/// The same of all commands together, which one frame brings: their sum.
std::vector<double> ChangesOf(const Signal& command_deg);

/// The clock that rows tell of frames. A change at row k says of the frame n that brought it
///
///     k - 1 < first_row + n period_rows <= k,
///
/// and hundreds of changes leave next to nothing open of such a line; of what they leave the middle
/// is taken. If changes come at every n-th row only, n of 2 or more, frames are sent with their
/// rows, as in a log that is written where commands are sent. A frame may bring no change.
///
/// Frames may be spread around their clock by a quarter of a row, or of what the period is longer
/// than a row. They have to be longer than a row by 4 %: shorter ones change in each row, and their
/// clock is not to be seen.
///
/// None where no such clock is seen: of a command that is smooth, or noise, or rounded, whose rests
/// lie on no line; and of one that may lie on it by chance, as few changes do, changes that are all
/// as large, and those of a command that is so slow wherever it rests.
/// Source: a line between bounds on both sides: O'Rourke, CACM 24, 574-578 (1981).
std::optional<FrameClock> FindFrameClock(std::span<const double> changes);

}  // namespace gauntlet::sim
