#include "sim/fit/chain_problem.h"

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastDamping = 0.05;
constexpr double kLongestDelay_s = 2.0;

}  // namespace

bool ChainFamily::Has(ChainParameter parameter) const {
  return std::ranges::find(free, parameter) != free.end();
}

Index ChainFamily::At(ChainParameter parameter) const {
  GAUNTLET_ASSERT(Has(parameter));
  return std::ranges::find(free, parameter) - free.begin();
}

ChainFamily ChainFamily::With(ChainParameter parameter) const {
  ChainFamily family = *this;
  if (!Has(parameter)) family.free.push_back(parameter);
  return family;
}

ChainFamily ShiftFamily() { return {.free = {kDeadTime, kGain, kOffset}}; }
ChainFamily PlayFamily() { return ShiftFamily().With(kPlay); }
ChainFamily BasicFamily() { return PlayFamily().With(kLag).With(kInertia); }

ChainModel ModelOfChain(const ChainFamily& family, const VectorXd& parameters,
                        double bend_middle_deg) {
  const auto value = [&](ChainParameter parameter, double usual = 0.0) {
    return family.Has(parameter) ? parameters[family.At(parameter)] : usual;
  };
  return {.dead_time_s = value(kDeadTime),
          .lag_s = value(kLag),
          .inertia_s2 = value(kInertia),
          .gain = value(kGain, 1.0),
          .play_deg = value(kPlay),
          .offset_deg = value(kOffset),
          .lost_play_deg = value(kLostPlay),
          .stretch_deg = value(kStretch),
          .extra_lag_s = value(kExtraLag),
          .bend_per_deg = value(kBend),
          .bend_middle_deg = bend_middle_deg,
          .speed_limit_deg_s = 1.0 / std::max(value(kSlowness), 1e-9),
          .friction_in_lag = family.friction_in_lag,
          .limit_in_lag = family.limit_in_lag};
}

ChainProblem::ChainProblem(std::span<const double> command_deg, std::span<const double> angle_deg,
                           double rate_hz, ChainFamily family,
                           const std::optional<CommandClock>& frames, double beginning_s)
    : command_(RefineCommand(command_deg, rate_hz, frames)),
      first_(std::lround(beginning_s * rate_hz)),
      angle_deg_(
          Eigen::Map<const VectorXd>(angle_deg.data() + first_, std::ssize(angle_deg) - first_)),
      simulated_deg_(command_deg.size()),
      family_(std::move(family)),
      low_(std::ssize(family_.free)),
      high_(low_.size()),
      step_(low_.size()) {
  GAUNTLET_ASSERT(command_deg.size() == angle_deg.size());
  const auto [least, most] = std::ranges::minmax(command_deg);
  bend_middle_deg_ = 0.5 * (least + most);
  SetBounds(most - least, 1.0 / rate_hz);
}

void ChainProblem::SetBounds(double travel_deg, double period_s) {
  // A command in steps, such as command frames, needs a wide difference quotient. For a smooth
  // command with lost motion a wide one is too flat, because of the corners of the angle. With two
  // plays the sum of squares is rough: a step smaller than the row distance would give the slope of
  // the noise.
  const bool loose = family_.Has(kLostPlay);
  const double play_step_deg = (loose ? 2e-3 : 1e-4) * travel_deg;
  Bound(kDeadTime, 0.0, kLongestDelay_s, loose && command_.smooth ? 0.001 : 0.01);
  Bound(kGain, 0.01, 100.0, 1e-4);
  Bound(kOffset, -1e4, 1e4, 0.0);
  Bound(kPlay, 0.0, travel_deg, play_step_deg);
  Bound(kLag, 0.0, kLongestDelay_s, 1e-4);
  Bound(kInertia, std::pow(0.25 * period_s, 2), 1.0, 1e-6);
  Bound(kLostPlay, 0.0, travel_deg, play_step_deg);
  Bound(kStretch, family_.friction_in_lag ? 2e-3 * travel_deg : 0.0, travel_deg, 1e-3 * travel_deg);
  Bound(kExtraLag, -0.5, 0.5, 1e-3);
  Bound(kBend, -1.0 / travel_deg, 1.0 / travel_deg, 1e-4 / travel_deg);
  Bound(kSlowness, 0.0, 10.0 / travel_deg, 2e-3 / travel_deg);
  exchange_deg_ = 5e-3 * travel_deg;
}

void ChainProblem::Bound(ChainParameter parameter, double low, double high, double step) {
  if (!family_.Has(parameter)) return;
  const Index at = family_.At(parameter);
  low_[at] = low;
  high_[at] = high;
  step_[at] = step;
}

VectorXd ChainProblem::Simulated(const ChainModel& model) {
  SimulateChain(model, command_, simulated_deg_);
  return Eigen::Map<const VectorXd>(simulated_deg_.data() + first_, angle_deg_.size());
}

VectorXd ChainProblem::Residual(const VectorXd& parameters) {
  return angle_deg_ - Simulated(ModelOfChain(family_, parameters, bend_middle_deg_));
}

MatrixXd ChainProblem::Derivatives(const VectorXd& parameters) {
  MatrixXd result(angle_deg_.size(), parameters.size());
  result.col(family_.At(kOffset)).setOnes();
  struct Quotient {
    Index parameter;
    double width;
  };
  std::vector<Quotient> quotients;
  std::vector<ChainModel> models;  // below and above, of each
  for (Index i = 0; i < parameters.size(); ++i) {
    const ChainParameter parameter = family_.free[static_cast<std::size_t>(i)];
    if (parameter == kOffset || parameter == kLostPlay) continue;
    VectorXd below = parameters;
    VectorXd above = parameters;
    below[i] = std::max(below[i] - step_[i], low_[i]);
    above[i] = std::min(above[i] + step_[i], high_[i]);
    quotients.push_back({i, above[i] - below[i]});
    for (const VectorXd& place : {below, above}) {
      models.push_back(ModelOfChain(family_, place, bend_middle_deg_));
    }
  }
  MatrixXd simulated(std::ssize(simulated_deg_), std::ssize(models));
  std::vector<std::span<double>> columns;
  for (Index i = 0; i < simulated.cols(); ++i) {
    columns.emplace_back(simulated.col(i).data(), simulated_deg_.size());
  }
  SimulateChains(models, command_, columns);
  for (std::size_t i = 0; i < quotients.size(); ++i) {
    const auto residual = [&](std::size_t column) {
      return angle_deg_ - simulated.col(static_cast<Index>(column)).tail(angle_deg_.size());
    };
    result.col(quotients[i].parameter) =
        (residual(2 * i) - residual(2 * i + 1)) / quotients[i].width;
  }
  if (family_.Has(kLostPlay)) {
    result.col(family_.At(kLostPlay)) =
        result.col(family_.At(kPlay)) + DerivativeOfExchange(parameters);
  }
  return result;
}

/// Derivative of the angle for play that is moved from before the lag to behind it. The sum of both
/// plays stays the same. The two separate derivatives are rough, because they move all corners of
/// the angle, and their difference would be mostly error. With a constant sum the corners stay, so
/// a wider step is smooth.
VectorXd ChainProblem::DerivativeOfExchange(const VectorXd& parameters) {
  const Index play = family_.At(kPlay);
  const Index lost = family_.At(kLostPlay);
  VectorXd below = parameters;
  VectorXd above = parameters;
  const double less = std::min(exchange_deg_, parameters[lost]);
  const double more = std::min(exchange_deg_, parameters[play]);
  below[lost] -= less;
  below[play] += less;
  above[lost] += more;
  above[play] -= more;
  return (Residual(below) - Residual(above)) / std::max(less + more, 1e-9);
}

void ChainProblem::KeepWithinBounds(VectorXd& parameters) const {
  parameters = parameters.cwiseMax(low_).cwiseMin(high_);
  if (!family_.Has(kLag)) return;
  const double least_lag_s = 2.0 * kLeastDamping * std::sqrt(parameters[family_.At(kInertia)]);
  double& lag_s = parameters[family_.At(kLag)];
  lag_s = std::max(lag_s, least_lag_s);
}

}  // namespace gauntlet::sim
