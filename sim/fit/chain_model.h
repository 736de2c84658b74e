#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "sim/fit/command_clock.h"

namespace gauntlet::sim {

/// Model of the chain from a command u to the measured angle y:
///
///     v(t) = gain u(t - dead_time) + bend (u(t - dead_time) - bend_middle)^2
///     v    changes by speed_limit at most                        (limit before the lag)
///     q    = v - d,   d' = (play - sgn(x') d) x' / stretch       (friction, Dahl)
///     (1 + pole s) r = q
///     inertia z'' + lag z' + z = r,   |z'| <= speed_limit        (limit in the lag)
///     j    = clamp(j, w - lost_play, w + lost_play),   w = z + zero z'
///     y    = j + offset
///
/// Friction rubs on the motor before the lag (x = q) or on the moving mass (x = z). Without stretch
/// it is play, q = clamp(q, v - play, v + play). Its loop is 2 play wide in both cases. Lost motion
/// is a second play: backlash of a gear or cable slack behind the motor. `bend` is the droop of a
/// servo under a load that depends on the angle, such as gravity. extra_lag is the pole if it is
/// positive, and the negative zero if it is negative.
///
/// The lag behind slow motions is dead_time + lag + extra_lag, plus the contribution of friction
/// and lost motion. Natural frequency: 1 / (2 pi sqrt(inertia)). Damping ratio:
/// lag / (2 sqrt(inertia)).
///
/// Sources: play: Tao, Kokotovic, Automatica 29, 323-335 (1993); friction: Dahl, AIAA J. 14,
/// 1675-1682 (1976).
struct ChainModel {
  double dead_time_s = 0.0;
  double lag_s = 0.0;
  double inertia_s2 = 0.0;
  double gain = 1.0;
  double play_deg = 0.0;
  double offset_deg = 0.0;
  double lost_play_deg = 0.0;
  double stretch_deg = 0.0;
  double extra_lag_s = 0.0;
  double bend_per_deg = 0.0;
  double bend_middle_deg = 0.0;
  double speed_limit_deg_s = std::numeric_limits<double>::infinity();
  bool friction_in_lag = false;
  bool limit_in_lag = false;
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
                          const std::optional<CommandClock>& frames = {});

/// The angle of the model for a command, one value per row. Exact for straight lines between the
/// values, except where play ends within a step, friction rubs on the moving mass, or the speed is
/// limited. Before the first value nothing moves, and friction and lost motion are in their middle.
void SimulateChain(const ChainModel& model, const FineCommand& command,
                   std::span<double> angle_deg);
/// Angles of several models, in less time. Precondition: as many angles as models, of one length.
void SimulateChains(std::span<const ChainModel> models, const FineCommand& command,
                    std::span<const std::span<double>> angles_deg);

}  // namespace gauntlet::sim
