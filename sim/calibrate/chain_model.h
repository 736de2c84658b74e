#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sim/calibrate/frame_clock.h"

namespace gauntlet::sim {

/// What stands between a command and the angle that follows it: dead time, then play, as dry
/// friction against a soft servo makes it, then a lag of second order, then lost motion: another
/// play, as of a gear or a slack cable behind the motor.
///
///     v(t) = gain u(t - dead_time)
///     q    = clamp(q, v - play, v + play)               the width of its loop is 2 play
///     inertia z'' + lag z' + z = q
///     j    = clamp(j, z - lost_play, z + lost_play),    y = j + offset
///
/// Slow motions are late by dead_time + lag, and by what both plays add. The natural frequency is
/// 1 / (2 pi sqrt(inertia)), the damping ratio lag / (2 sqrt(inertia)).
///
/// Dry friction and the backlash of a gear look alike but for the side of the lag on which they
/// are. Source: model of play: Tao, Kokotovic, Automatica 29, 323-335 (1993).
struct ChainModel {
  double dead_time_s = 0.0;
  double lag_s = 0.0;
  double inertia_s2 = 0.0;
  double gain = 1.0;
  double play_deg = 0.0;
  double offset_deg = 0.0;
  double lost_play_deg = 0.0;
};

/// A command as a chain gets it, between the rows of a log, too: `steps_per_row` values for each
/// row, and straight lines between them.
struct FineCommand {
  std::vector<double> values_deg;
  double rate_hz = 1000.0;  // of the values
  Eigen::Index steps_per_row = 1;
  double late_steps = 0.0;  // it comes so much later: lines that lead up to a step begin before it
  bool smooth = false;
};

/// Where rows are further apart than 2 ms and the command is smooth, a cubic through the two rows
/// before and the two behind tells what it did between them. One that comes in `frames` holds still
/// but for a step when each is sent; values are means over a fine step then, which leave every step
/// where it is. Otherwise rows stand as they are, and straight lines between them.
///
/// A command is smooth if such a cubic through their neighbours tells rows better than straight
/// lines do, in the mean square: that of a person or of sines is, one that is held and steps, or is
/// mostly noise, is not.
FineCommand RefineCommand(std::span<const double> command_deg, double rate_hz,
                          const std::optional<FrameClock>& frames = {});

/// The angle that the model gives for a command, one value per row; exact for straight lines
/// between the command's values but for the corners where play ends within a step. Before the
/// first value all stands still, in the middle of its play.
void SimulateChain(const ChainModel& model, const FineCommand& command,
                   std::span<double> angle_deg);

}  // namespace gauntlet::sim
