#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sim/calibrate/frame_clock.h"

namespace gauntlet::sim {

/// Model of the chain from a command u to the measured angle y: dead time, play (dry friction
/// against a compliant servo), second-order lag, and lost motion (a second play: backlash of a gear
/// or cable slack behind the motor).
/// play, as of a gear or a slack cable behind the motor.
///
///     v(t) = gain u(t - dead_time)
///     q    = clamp(q, v - play, v + play)               the width of its loop is 2 play
///     inertia z'' + lag z' + z = q
///     j    = clamp(j, z - lost_play, z + lost_play),    y = j + offset
///
/// The lag behind slow motions is dead_time + lag, plus the contribution of both plays. Natural
/// frequency: 1 / (2 pi sqrt(inertia)). Damping ratio: lag / (2 sqrt(inertia)).
///
/// Dry friction and backlash differ only by the side of the lag on which they act.
/// Source: model of play: Tao, Kokotovic, Automatica 29, 323-335 (1993).
struct ChainModel {
  double dead_time_s = 0.0;
  double lag_s = 0.0;
  double inertia_s2 = 0.0;
  double gain = 1.0;
  double play_deg = 0.0;
  double offset_deg = 0.0;
  double lost_play_deg = 0.0;
};

/// A command with `steps_per_row` values for each row of a log, and straight lines between them.
struct FineCommand {
  std::vector<double> values_deg;
  double rate_hz = 1000.0;  // of the values
  Eigen::Index steps_per_row = 1;
  double late_steps = 0.0;  // added to the dead time: lines rise before a step
  bool smooth = false;
};

/// Refines a command between the rows of a log. With `frames`, the command is held and steps when
/// each frame is sent; the values are means over a fine step, so each step keeps its time. A smooth
/// command with rows more than 2 ms apart is interpolated by a cubic through two rows before and
/// two rows after. Otherwise the rows stay, with straight lines between them.
///
/// A command is smooth if the cubic predicts rows from their neighbours with a smaller mean square
/// error than straight lines. This holds for motions of a person and for sines, but not for
/// commands in steps or with much noise.
FineCommand RefineCommand(std::span<const double> command_deg, double rate_hz,
                          const std::optional<FrameClock>& frames = {});

/// The angle of the model for a command, one value per row. Exact for straight lines between the
/// values, except where play ends within a step. Before the first value nothing moves, and both
/// plays are in their middle.
void SimulateChain(const ChainModel& model, const FineCommand& command,
                   std::span<double> angle_deg);

}  // namespace gauntlet::sim
