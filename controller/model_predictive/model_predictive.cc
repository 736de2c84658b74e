#include "controller/model_predictive/model_predictive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "controller/angle.h"
#include "controller/assert.h"
#include "controller/one_for_each.h"
#include "controller/prediction/motion_model.h"

namespace gauntlet::controller {
namespace {

double LimitOf(double setting) {
  return setting > 0.0 ? setting * kRadPerDeg : std::numeric_limits<double>::infinity();
}

}  // namespace

void ModelPredictiveConfig::Visit(SettingsVisitor& visitor) {
  static constexpr std::array<std::string_view, 2> kNames = {"none", "second_order"};
  VisitEnum(
      visitor,
      {"kind",
       "second_order: commands are planned for joints that follow them with a dead time and a lag "
       "of second order, to be where the prediction sees the wearer; once per command frame"},
      kNames, kind);
  visitor.Integer({"steps", "so many command frames are planned (second_order)", 1, kMostPlanSteps},
                  steps);
  visitor.Numbers(
      {"dead_time_ms",
       "until a command begins to move a joint; one for all joints, or one for each (second_order)",
       0, 500},
      dead_time_ms);
  visitor.Numbers({"lag_ms",
                   "delay of a joint then in slow motion; one for all joints, or one for each "
                   "(second_order)",
                   0.1, 1000},
                  lag_ms);
  visitor.Numbers({"natural_frequency_hz",
                   "of the lag; one for all joints, or one for each (second_order)", 0.1, 100},
                  natural_frequency_hz);
  visitor.Number({"change_weight",
                  "what the square of a command's change costs, in squares of a joint's error: "
                  "more gives less jitter and more delay (second_order)",
                  1e-4, 1e4},
                 change_weight);
  visitor.Number({"speed_limit_deg_s",
                  "commands of a joint change no faster; 0 is no limit (second_order)", 0, 1e5},
                 speed_limit_deg_s);
  visitor.Number({"lead_limit_deg",
                  "a command is no farther ahead of where the joint will be, beyond which a servo "
                  "has no more torque; 0 is no limit (second_order)",
                  0, 1000},
                 lead_limit_deg);
  visitor.Integer({"iterations",
                   "a joint whose plan takes more keeps its last command (second_order)", 0, 1000},
                  iterations);
}

ModelPredictive::ModelPredictive(const ModelPredictiveConfig& config,
                                 const TendonTransmission& hand, double events_per_s)
    : config_(config),
      event_s_(1.0 / events_per_s),
      change_limit_rad_(LimitOf(config.speed_limit_deg_s) * event_s_),
      lead_limit_rad_(LimitOf(config.lead_limit_deg)),
      failed_plans_(hand.joint_names.size()) {
  GAUNTLET_ASSERT(events_per_s > 0.0);
  CheckSettings(config);
  if (!on()) return;
  const auto count = static_cast<int>(hand.joint_names.size());
  const auto of_each = [count](std::string_view key, const std::vector<double>& values) {
    return OneForEach("joint", count, key, values);
  };
  const Eigen::ArrayXd dead_time_ms = of_each("dead_time_ms", config.dead_time_ms);
  const Eigen::ArrayXd lag_ms = of_each("lag_ms", config.lag_ms);
  const Eigen::ArrayXd frequency_hz = of_each("natural_frequency_hz", config.natural_frequency_hz);
  for (int i = 0; i < count; ++i) {
    joints_.push_back(MakeJoint(1e-3 * dead_time_ms[i], 1e-3 * lag_ms[i], frequency_hz[i],
                                hand.joint_min_rad[i], hand.joint_max_rad[i]));
    path_length_ = std::max(path_length_, joints_.back().first_row + config.steps + 2);
  }
  memory_.resize(joints_.size());
  Reset(hand.reference_angle_rad);
}

ModelPredictive::Joint ModelPredictive::MakeJoint(double dead_time_s, double lag_s,
                                                  double frequency_hz, double min_rad,
                                                  double max_rad) const {
  const int n = config_.steps;
  const double w = 2.0 * std::numbers::pi * frequency_hz;
  // States: angle, speed, and the command, which stays.
  MotionModel model;
  model.f << 0.0, 1.0, 0.0, -w * w, -w * w * lag_s, w * w, 0.0, 0.0, 0.0;
  model.h << 1.0, 0.0, 0.0;
  const Eigen::RowVector3d to_angle = LookAhead(model, event_s_);
  model.h << 0.0, 1.0, 0.0;
  const Eigen::RowVector3d to_speed = LookAhead(model, event_s_);
  Eigen::Matrix2d state_to_state;
  state_to_state << to_angle.head<2>(), to_speed.head<2>();
  const Eigen::Vector2d command_to_state(to_angle[2], to_speed[2]);

  Eigen::MatrixXd plan_to_path = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd state_to_path(n, 2);
  Eigen::Matrix2d power = Eigen::Matrix2d::Identity();
  for (int j = 0; j < n; ++j) {
    const double response = power.row(0).dot(command_to_state);
    for (int k = j; k < n; ++k) plan_to_path(k, k - j) = response;
    power = power * state_to_state;
    state_to_path.row(j) = power.row(0);
  }
  Eigen::MatrixXd change = Eigen::MatrixXd::Identity(n, n);
  change.diagonal(-1).setConstant(-1.0);
  const double events = dead_time_s / event_s_;
  const double whole = std::floor(events);
  const double rest = events - whole;
  return {.min_rad = min_rad,
          .max_rad = max_rad,
          .state_to_state = state_to_state,
          .command_to_state = command_to_state,
          .plan_to_path = plan_to_path,
          .state_to_path = state_to_path,
          .first_row = static_cast<int>(whole),
          .row_weights = {0.5 * rest * (rest - 1.0), 1.0 - rest * rest, 0.5 * rest * (rest + 1.0)},
          .solver = PlanSolver(plan_to_path.transpose() * plan_to_path +
                               config_.change_weight * change.transpose() * change)};
}

bool ModelPredictive::Plan(Joint& joint, std::size_t index, std::span<const double> path_rad,
                           Memory& memory) noexcept {
  const int n = config_.steps;
  const std::size_t joints = joints_.size();
  PlanVector wanted(n);
  for (int j = 0; j < n; ++j) {
    wanted[j] = 0.0;
    for (int row = 0; row < 3; ++row) {
      const auto place = static_cast<std::size_t>(joint.first_row + j + row) * joints + index;
      wanted[j] +=
          joint.row_weights[row] * std::clamp(path_rad[place], joint.min_rad, joint.max_rad);
    }
  }
  wanted.noalias() -= joint.state_to_path * memory.state;
  PlanVector g(n);
  g.noalias() = joint.plan_to_path.transpose() * wanted;
  g[0] += config_.change_weight * memory.command_rad;

  PlanLimits low(2 * n - 1), high(2 * n - 1);
  low.head(n).setConstant(joint.min_rad);
  high.head(n).setConstant(joint.max_rad);
  low.tail(n - 1).setConstant(-change_limit_rad_);
  high.tail(n - 1).setConstant(change_limit_rad_);
  low[0] = std::max(joint.min_rad, memory.command_rad - change_limit_rad_);
  high[0] = std::min(joint.max_rad, memory.command_rad + change_limit_rad_);
  const double least = std::clamp(memory.state[0] - lead_limit_rad_, low[0], high[0]);
  const double most = std::clamp(memory.state[0] + lead_limit_rad_, low[0], high[0]);
  low[0] = least;
  high[0] = most;

  PlanVector plan(n);
  if (!joint.solver.Solve(g, low, high, config_.iterations, plan)) return false;
  memory.command_rad = std::clamp(plan[0], least, most);  // what rounding leaves
  return true;
}

void ModelPredictive::Step(std::span<const double> path_rad,
                           std::span<double> command_rad) noexcept {
  GAUNTLET_ASSERT(path_rad.size() == static_cast<std::size_t>(path_length_) * joints_.size());
  GAUNTLET_ASSERT(command_rad.size() == joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    Memory& memory = memory_[i];
    if (!Plan(joint, i, path_rad, memory)) ++failed_plans_[i];
    command_rad[i] = memory.command_rad;
    memory.state =
        joint.state_to_state * memory.state + joint.command_to_state * memory.command_rad;
  }
}

void ModelPredictive::Sent(std::span<const double> wanted_rad,
                           std::span<const double> sent_rad) noexcept {
  GAUNTLET_ASSERT(wanted_rad.size() == joints_.size() && sent_rad.size() == joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const double off = sent_rad[i] - wanted_rad[i];
    if (std::isfinite(off)) memory_[i].state += joints_[i].command_to_state * off;
  }
}

void ModelPredictive::Reset(std::span<const double> angle_rad) noexcept {
  GAUNTLET_ASSERT(!on() || angle_rad.size() == joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const double angle = std::clamp(angle_rad[i], joints_[i].min_rad, joints_[i].max_rad);
    memory_[i] = {.state = {angle, 0.0}, .command_rad = angle};
    joints_[i].solver.Reset();
  }
  std::fill(failed_plans_.begin(), failed_plans_.end(), 0);
}

void ModelPredictive::SwapMemory(ModelPredictive& from,
                                 std::span<const double> angle_rad) noexcept {
  Reset(angle_rad);
  failed_plans_.swap(from.failed_plans_);
  if (on() && from.on()) memory_.swap(from.memory_);
}

}  // namespace gauntlet::controller
