#include "controller/validate.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>

#include "controller/angle.h"
#include "controller/angle_estimator.h"
#include "controller/controller.h"
#include "controller/filters/filter_registry.h"
#include "controller/joint_loop.h"
#include "controller/joint_map.h"
#include "controller/linearisation/linearisation.h"
#include "controller/model_predictive/model_predictive.h"
#include "controller/robot_key.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {
namespace {

/// Problems of parts, each once.
class RobotProblems {
 public:
  void Add(const std::string& key, const std::string& problem, bool is_warning = false) {
    const auto is_same = [&](const RobotProblem& other) {
      return other.key == key && other.problem == problem;
    };
    if (std::ranges::any_of(found_, is_same)) return;
    found_.push_back({.key = key, .problem = problem, .is_warning = is_warning});
  }
  /// True if `make` throws nothing. Its errors have the keys of Controller's constructor, behind
  /// `group`.
  bool Try(const std::string& group, const std::function<void()>& make) {
    try {
      make();
      return true;
    } catch (const SettingError& error) {
      const std::string inner = error.key().empty() || group.empty() ? "" : ".";
      Add(KeyInText(group + inner + error.key()), error.problem());
      return false;
    }
  }
  /// True if no key begins so.
  bool IsFree(const std::string& group) const {
    return std::ranges::none_of(
        found_, [&](const RobotProblem& problem) { return problem.key.starts_with(group); });
  }
  bool empty() const { return found_.empty(); }
  std::vector<RobotProblem> Found() && { return std::move(found_); }

 private:
  std::vector<RobotProblem> found_;
};

/// Poses in which the joint of a channel would be far beyond its range.
void WarnOfPoses(const RobotConfig& robot, RobotProblems& problems) {
  constexpr double kFarShare = 0.5;
  const JointMap map(robot.joint_map, robot.glove.channel_names, robot.hand);
  for (int j = 0; j < map.joint_count(); ++j) {
    if (map.terms(j).size() != 1) continue;  // a sum has no pose of its own
    const JointMap::Term& term = map.terms(j)[0];
    const auto joint = static_cast<std::size_t>(j);
    const auto channel = static_cast<std::size_t>(term.channel);
    const double low_rad = robot.hand.joint_min_rad[joint];
    const double high_rad = robot.hand.joint_max_rad[joint];
    const double far_rad = kFarShare * (high_rad - low_rad);
    for (const bool is_low : {true, false}) {
      const double pose_rad =
          is_low ? robot.glove.low_angle_rad[channel] : robot.glove.high_angle_rad[channel];
      const double angle_rad = map.offset_rad(j) + term.weight * pose_rad;
      if (angle_rad >= low_rad - far_rad && angle_rad <= high_rad + far_rad) continue;
      problems.Add("glove.channels." + robot.glove.channel_names[channel] +
                       (is_low ? ".low_angle_rad" : ".high_angle_rad"),
                   "is " + NumberText(pose_rad) + ", which turns " + robot.hand.joint_names[joint] +
                       " to " + NumberText(angle_rad) + " rad, far beyond its range, " +
                       NumberText(low_rad) + " to " + NumberText(high_rad) + "; is it in degrees?",
                   true);
    }
  }
}

}  // namespace

std::vector<RobotProblem> Validate(const RobotConfig& robot) {
  RobotProblems problems;
  RobotConfig seen = robot;  // a visitor may change what it sees
  for (const SettingError& error :
       SettingProblems([&seen](SettingsVisitor& visitor) { seen.Visit(visitor); })) {
    problems.Add(error.key(), error.problem());
  }
  const std::vector<std::string>& channels = robot.glove.channel_names;
  problems.Try("", [&] { CheckNames("calibration.channel_names", channels); });
  problems.Try("", [&] { ConvertersOf(robot.glove); });
  const bool has_poses = robot.glove.low_counts.size() == channels.size() &&
                         robot.glove.high_counts.size() == channels.size() &&
                         robot.glove.low_angle_rad.size() == channels.size() &&
                         robot.glove.high_angle_rad.size() == channels.size();
  const bool has_time = problems.IsFree("timing");
  const bool has_glove = has_poses && problems.IsFree("glove");
  const ControllerConfig& config = robot.controller;
  if (has_glove && problems.IsFree("controller.linearisation")) {
    problems.Try("", [&] { MakeLinearisation(config.linearisation, robot.glove, channels); });
  }
  bool has_hand = problems.IsFree("hand");
  has_hand = has_hand && problems.Try("", [&] {
    const TendonMap map(robot.hand, config.coupling_compensation);
  });
  const bool has_map = has_hand && problems.Try("joint_map", [&] {
    const JointMap map(robot.joint_map, channels, robot.hand);
  });
  if (has_time) {
    const double step_rate_hz = config.filter_at == FilterAt::kEvent
                                    ? robot.timing.event_rate_hz()
                                    : robot.timing.sample_rate_hz();
    for (std::size_t i = 0; i < config.filters.size(); ++i) {
      const std::string key = "filter[" + std::to_string(i) + "]";
      if (!problems.IsFree("controller." + key)) continue;
      problems.Try(key, [&] { MakeFilter(config.filters[i], channels, step_rate_hz); });
    }
    if (has_hand && problems.IsFree("controller.model_predictive")) {
      problems.Try("model_predictive", [&] {
        const ModelPredictive planned(config.model_predictive, robot.hand,
                                      robot.timing.event_rate_hz());
      });
    }
    if (has_hand && problems.IsFree("controller.joint_loop")) {
      problems.Try("joint_loop", [&] {
        const JointLoop loop(config.joint_loop, robot.hand, robot.timing.event_rate_hz());
      });
    }
  }
  if (has_glove && has_map) WarnOfPoses(robot, problems);
  // Problems between parts.
  const std::vector<RobotProblem> found = RobotProblems(problems).Found();
  if (std::ranges::all_of(found, &RobotProblem::is_warning)) {
    problems.Try("", [&] { const Controller made(robot); });
  }
  return std::move(problems).Found();
}

std::string TextOf(const RobotProblem& problem) {
  return (problem.is_warning ? "warning: " : "") + problem.key + ": " + problem.problem;
}

}  // namespace gauntlet::controller
