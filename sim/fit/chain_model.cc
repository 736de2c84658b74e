#include "sim/fit/chain_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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
                               const CommandClock& frames) {
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

/// State of the chain behind its dead time, in steps of one fine value.
class ChainState {
 public:
  ChainState(const ChainModel& model, double rate_hz, double start)
      : model_(model),
        lag_(LagStepOf(model, rate_hz)),
        step_limit_deg_(model.speed_limit_deg_s / rate_hz),
        zero_steps_(std::max(-model.extra_lag_s, 0.0) * rate_hz),
        per_stretch_(model.stretch_deg > 0.0 ? 1.0 / model.stretch_deg : 0.0),
        limited_(start),
        played_(start),
        pole_(start),
        angle_(start),
        joint_(start) {
    const double pole_steps = std::max(model.extra_lag_s, 0.0) * rate_hz;
    if (pole_steps > 0.0) {
      keep_ = std::exp(-1.0 / pole_steps);
      pole_of_push_ = 1.0 - pole_steps * (1.0 - keep_);
    }
  }

  void Step(double wanted) {
    const bool slew = !model_.limit_in_lag;
    if (slew) wanted = Dragged(wanted, limited_, step_limit_deg_);
    const double before = played_;
    Rub(wanted);
    limited_ = wanted;
    const double filtered = pole_;
    pole_ = keep_ * pole_ + (1.0 - keep_) * before + pole_of_push_ * (played_ - before);
    const double angle = angle_;
    Lag(filtered, pole_ - filtered);
    if (!slew && std::abs(change_) > step_limit_deg_) {
      change_ = std::copysign(step_limit_deg_, change_);
      angle_ = angle + change_;
    }
    if (model_.friction_in_lag) RubOnMass(angle_ - angle);
    joint_ = Dragged(joint_, angle_ + zero_steps_ * change_, model_.lost_play_deg);
  }

  double joint() const { return joint_; }

 private:
  /// exp(x) for x >= 0, such that 1 - 1 / Grown(x) is 1 - exp(-x) within 0.025: monotonic and
  /// bounded, without a call of exp().
  static double Grown(double x) {
    constexpr double kSixth = 1.0 / 6.0;
    return 1.0 + x * (1.0 + x * (0.5 + x * kSixth));
  }

  /// Friction before the lag: moves played_ after the driver `wanted`.
  void Rub(double wanted) {
    if (model_.friction_in_lag) {
      played_ = wanted - deflection_;
    } else if (model_.stretch_deg <= 0.0) {
      played_ = Dragged(played_, wanted, model_.play_deg);
    } else {
      const double change = std::abs(wanted - limited_);
      const double sign = wanted < limited_ ? -1.0 : 1.0;
      const double open = model_.play_deg - sign * deflection_;
      // x + open (1 - exp(-x / stretch)) = change, by two steps of Newton from below.
      double x = change * model_.stretch_deg / (model_.stretch_deg + open);
      for (int i = 0; i < 2; ++i) {
        const double grown = Grown(x * per_stretch_);  // on both sides of the fraction, for speed
        x += ((change - x - open) * grown + open) / (grown + open * per_stretch_);
      }
      played_ += sign * x;
      deflection_ = std::clamp(wanted - played_, -model_.play_deg, model_.play_deg);
      played_ = wanted - deflection_;
    }
  }

  void RubOnMass(double moved) {
    const double sign = moved < 0.0 ? -1.0 : 1.0;
    const double open = model_.play_deg - sign * deflection_;
    deflection_ += sign * open * (1.0 - 1.0 / Grown(std::abs(moved) * per_stretch_));
  }

  void Lag(double input, double push) {
    const double before = angle_;
    angle_ = lag_.angle[2] * input + lag_.angle[3] * push + lag_.angle[0] * before +
             lag_.angle[1] * change_;
    change_ = lag_.change[2] * input + lag_.change[3] * push + lag_.change[0] * before +
              lag_.change[1] * change_;
  }

  const ChainModel& model_;
  LagStep lag_;
  double step_limit_deg_;
  double zero_steps_;
  double per_stretch_;         // 1 / stretch_deg
  double keep_ = 0.0;          // share of the pole's state after a step
  double pole_of_push_ = 1.0;  // share of a change within the step
  double limited_;
  double deflection_ = 0.0;  // of friction: driver less driven
  double played_;
  double pole_;
  double angle_;
  double change_ = 0.0;
  double joint_;
};

/// A model with its state, and where its command has got to.
struct Running {
  Running(const ChainModel& chain, const FineCommand& command) : model(chain) {
    const double dead_samples = chain.dead_time_s * command.rate_hz + command.late_steps;
    const double floor = std::floor(dead_samples);
    whole = static_cast<Index>(floor);
    fraction = dead_samples - floor;
    state.emplace(model, command.rate_hz, Driven(command.values_deg.front()));
  }
  double Driven(double u) const {
    const double from_middle = u - model.bend_middle_deg;
    return model.gain * u + model.bend_per_deg * from_middle * from_middle;
  }

  const ChainModel model;
  Index whole = 0;  // steps of the dead time
  double fraction = 0.0;
  std::optional<ChainState> state;
};

/// SimulateChain() of several models. Each step waits for the one before, so a processor has time
/// for the steps of others.
template <std::size_t kModels>
void SimulateTogether(const std::array<const ChainModel*, kModels>& models,
                      const FineCommand& command,
                      const std::array<std::span<double>, kModels>& angles_deg) {
  const std::size_t rows = angles_deg.front().size();
  GAUNTLET_ASSERT(command.steps_per_row > 0 &&
                  std::ssize(command.values_deg) >
                      (static_cast<Index>(rows) - 1) * command.steps_per_row);
  std::vector<Running> running;
  running.reserve(kModels);
  for (const ChainModel* const model : models) {
    GAUNTLET_ASSERT(model->dead_time_s >= 0.0);
    running.emplace_back(*model, command);
  }
  const double* const values = command.values_deg.data();
  Index step = 1;
  for (std::size_t row = 0; row < rows; ++row) {
    const Index last = static_cast<Index>(row) * command.steps_per_row;
    for (; step <= last; ++step) {
      for (std::size_t i = 0; i < kModels; ++i) {
        Running& one = running[i];
        if (step <= one.whole) continue;  // nothing moves before the second value arrives
        const double* const arrived = values + (step - one.whole - 1);
        one.state->Step(one.Driven(arrived[1] + one.fraction * (arrived[0] - arrived[1])));
      }
    }
    for (std::size_t i = 0; i < kModels; ++i) {
      angles_deg[i][row] = running[i].state->joint() + running[i].model.offset_deg;
    }
  }
}

}  // namespace

FineCommand RefineCommand(std::span<const double> command_deg, double rate_hz,
                          const std::optional<CommandClock>& frames) {
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
  SimulateTogether<1>({&model}, command, {angle_deg});
}

void SimulateChains(std::span<const ChainModel> models, const FineCommand& command,
                    std::span<const std::span<double>> angles_deg) {
  GAUNTLET_ASSERT(angles_deg.size() == models.size());
  std::size_t i = 0;
  for (; i + 4 <= models.size(); i += 4) {
    SimulateTogether<4>({&models[i], &models[i + 1], &models[i + 2], &models[i + 3]}, command,
                        {angles_deg[i], angles_deg[i + 1], angles_deg[i + 2], angles_deg[i + 3]});
  }
  for (; i < models.size(); ++i) SimulateChain(models[i], command, angles_deg[i]);
}

}  // namespace gauntlet::sim
