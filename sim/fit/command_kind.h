#pragma once

#include <span>
#include <string>

namespace gauntlet::sim {

/// Meaning of a part's command in a log.
enum class CommandKind {
  kTarget,      // position to go to: the only one that has a delay
  kCopy,        // the angle of the same row
  kNextRow,     // the angle of the next row
  kLaterRow,    // the angle of one of the rows behind it
  kEarlierRow,  // the angle of the row before
  kMixed,       // the angle in some of the rows that move, a target in the others
  kSteps,       // changes of the angle from row to row
  kVelocity,    // speed of the angle
  kChanges,     // steps in another scale, or differences to the angle
};

/// Finds what a command is from how it fits the angle:
///
///     copy            c[n] = g a[n + k] + b,  k = -1..5, in rows that move, but for rounding
///     mixed           5 % of the rows are CopiedRows
///     steps, velocity a[n] = g sum(c[0..n - k]) + b + d n,  k up to 1.5 s; better than any
///                     a[n] = g c[n - k] + b,  k up to 3 s;  g about 1: steps, 1 / rate: velocity,
///                     else changes
///
/// A hand that follows its target exactly, one row later, looks like a copy of the next row.
/// Shapes: equal length, finite, at `rate_hz`. Units: any that both share.
CommandKind FindCommandKind(std::span<const double> command, std::span<const double> angle,
                            double rate_hz);

/// Rows of a command that are the angle of the same or the next row, in runs of at least ten moving
/// rows: those in which the command changes. A target is so at rest alone.
struct CopiedRows {
  std::size_t moving = 0;  // rows of the whole log
  std::size_t copied = 0;  // moving rows
  std::size_t first = 0;   // copied rows
  std::size_t last = 0;
  std::size_t between = 0;  // moving rows from the first to the last

  double share() const {
    return moving > 0 ? static_cast<double>(copied) / static_cast<double>(moving) : 0.0;
  }
};
CopiedRows FindCopiedRows(std::span<const double> command, std::span<const double> angle);

/// A word for a kind, as files have it.
const char* NameOf(CommandKind kind);

/// A sentence about a command that is no target, and what to do; empty for a target.
std::string ProblemOf(CommandKind kind, double rate_hz);

}  // namespace gauntlet::sim
