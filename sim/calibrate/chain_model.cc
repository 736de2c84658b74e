#include "sim/calibrate/chain_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;

/// True if a cubic through the neighbours predicts the rows better than a straight line does.
bool IsSmooth(std::span<const double> rows) {
  double line = 0.0;
  double cubic = 0.0;
  for (std::size_t k = 2; k + 2 < rows.size(); ++k) {
    const double near = rows[k - 1] + rows[k + 1];
    const double far = rows[k - 2] + rows[k + 2];
    line += std::pow(rows[k] - near / 2.0, 2);
    cubic += std::pow(rows[k] - (4.0 * near - far) / 6.0, 2);
  }
  return cubic < line;
}

/// Lagrange's cubic through four rows, between row k (share 0) and the next row (share 1).
double CubicAt(std::span<const double> rows, Index k, double share) {
  GAUNTLET_ASSERT(1 <= k && k + 2 < std::ssize(rows));
  const double before = share + 1.0;
  const double next = share - 1.0;
  const double behind = share - 2.0;
  return -share * next * behind / 6.0 * rows[k - 1] + before * next * behind / 2.0 * rows[k] -
         before * share * behind / 2.0 * rows[k + 1] + before * share * next / 6.0 * rows[k + 2];
}

/// The command up to the last row, `steps` values per row: cubic, linear in the first and last
/// interval.
std::vector<double> SmoothValues(std::span<const double> rows, Index steps) {
  const Index last = std::ssize(rows) - 1;
  std::vector<double> values;
  values.reserve(rows.size() * static_cast<std::size_t>(steps));
  for (Index k = 0; k < last; ++k) {
    const bool at_an_end = k == 0 || k + 1 == last;
    values.push_back(rows[k]);
    for (Index i = 1; i < steps; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(steps);
      values.push_back(at_an_end ? std::lerp(rows[k], rows[k + 1], share)
                                 : CubicAt(rows, k, share));
    }
  }
  values.push_back(rows[last]);
  return values;
}

/// Mean of the command over each fine step. The command steps to row k when its frame is sent.
std::vector<double> HeldValues(std::span<const double> rows, Index steps,
                               const FrameClock& frames) {
  const Index last = std::ssize(rows) - 1;
  std::vector<double> values(static_cast<std::size_t>(last * steps + 1), rows[last]);
  for (Index k = 0; k < last; ++k) std::fill_n(values.begin() + k * steps, steps, rows[k]);
  for (Index k = 1; k <= last; ++k) {
    const double sent = frames.SentAt(k) * static_cast<double>(steps);
    for (auto i = static_cast<Index>(sent); i < k * steps; ++i) {
      const double share = std::min(static_cast<double>(i + 1) - sent, 1.0);
      values[i] += share * (rows[k] - rows[k - 1]);
    }
  }
  return values;
}

/// Position of an element with backlash +-play after its driver moves to `middle`.
double Dragged(double before, double middle, double play) {
  return std::min(std::max(before, middle - play), middle + play);
}

/// Discrete transition of the second-order lag over one step: a 2 x 4 matrix from [angle, change of
/// the angle per step, input, change of the input per step] to the next [angle, change]. Default:
/// no lag, so the angle equals the input.
struct LagStep {
  std::array<double, 4> angle = {0.0, 0.0, 1.0, 1.0};
  std::array<double, 4> change = {};
};

/// Transition of inertia z'' + lag z' + z = q, exact if q changes linearly within the step.
LagStep LagStepOf(const ChainModel& model, double rate_hz) {
  if (model.inertia_s2 <= 0.0 && model.lag_s <= 0.0) return {};
  constexpr double kLeastInertia = 1e-4;  // steps^2; approximates a first-order lag
  const double inertia = std::max(model.inertia_s2 * rate_hz * rate_hz, kLeastInertia);
  const double stiffness = 1.0 / inertia;
  const double friction = model.lag_s * rate_hz / inertia;
  Eigen::Matrix4d rate = Eigen::Matrix4d::Zero();
  rate(0, 1) = 1.0;
  rate.row(1) << -stiffness, -friction, stiffness, 0.0;
  rate(2, 3) = 1.0;
  const Eigen::Matrix4d step = rate.exp();
  LagStep lag;
  for (Index i = 0; i < step.cols(); ++i) {
    lag.angle[i] = step(0, i);
    lag.change[i] = step(1, i);
  }
  return lag;
}

}  // namespace

FineCommand RefineCommand(std::span<const double> command_deg, double rate_hz,
                          const std::optional<FrameClock>& frames) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && !command_deg.empty());
  constexpr double kFineRate_hz = 500.0;
  FineCommand fine{.values_deg = {}, .smooth = !frames && IsSmooth(command_deg)};
  if (frames || fine.smooth) {
    fine.steps_per_row = std::max<Index>(std::lround(kFineRate_hz / rate_hz), 1);
  }
  fine.rate_hz = rate_hz * static_cast<double>(fine.steps_per_row);
  if (frames) {
    // Lines rise over one step before each value, so they reach half of a step change half a step
    // early.
    fine.late_steps = 0.5;
    fine.values_deg = HeldValues(command_deg, fine.steps_per_row, *frames);
  } else {
    fine.values_deg = SmoothValues(command_deg, fine.steps_per_row);
  }
  return fine;
}

void SimulateChain(const ChainModel& model, const FineCommand& command,
                   std::span<double> angle_deg) {
  GAUNTLET_ASSERT(command.steps_per_row > 0 && model.dead_time_s >= 0.0);
  GAUNTLET_ASSERT(std::ssize(command.values_deg) >
                  (std::ssize(angle_deg) - 1) * command.steps_per_row);
  const double dead_samples = model.dead_time_s * command.rate_hz + command.late_steps;
  const double whole = std::floor(dead_samples);
  const double fraction = dead_samples - whole;
  const LagStep lag = LagStepOf(model, command.rate_hz);
  const double* arrived = command.values_deg.data();
  double played = model.gain * *arrived;
  double angle = played;
  double change = 0.0;
  double joint = played;
  Index step = static_cast<Index>(whole) + 1;  // nothing moves before the second value arrives
  for (std::size_t row = 0; row < angle_deg.size(); ++row) {
    const Index last = static_cast<Index>(row) * command.steps_per_row;
    for (; step <= last; ++step) {
      const double wanted = model.gain * (arrived[1] + fraction * (arrived[0] - arrived[1]));
      ++arrived;
      const double next = Dragged(played, wanted, model.play_deg);
      const double push = next - played;
      const double before = angle;
      angle = lag.angle[2] * played + lag.angle[3] * push + lag.angle[0] * before +
              lag.angle[1] * change;
      change = lag.change[2] * played + lag.change[3] * push + lag.change[0] * before +
               lag.change[1] * change;
      played = next;
      joint = Dragged(joint, angle, model.lost_play_deg);
    }
    angle_deg[row] = joint + model.offset_deg;
  }
}

}  // namespace gauntlet::sim
