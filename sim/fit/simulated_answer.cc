#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/tendon_map.h"
#include "sim/base/timing.h"
#include "sim/fit/answering_servo.h"
#include "sim/hand/hand_model.h"
#include "sim/trial/loop/hand_loop.h"

namespace gauntlet::sim {
namespace {

constexpr double kFullScale_counts = 1e6;
constexpr double kMostAngle_rad = 10.0;  // beyond the range of any joint

struct MovedJoint {
  Eigen::Index part;
  std::size_t joint;
  std::optional<CommandClock> frames;  // of its command
};

std::vector<MovedJoint> MovedJoints(const ChainLog& log, const HandModel& model) {
  const std::vector<std::optional<CommandClock>> frames = FramesOf(log);
  std::vector<MovedJoint> moved;
  for (std::size_t part = 0; part < log.parts.size(); ++part) {
    const auto drive = std::ranges::find(model.drives(), log.parts[part], &Drive::name);
    if (drive == model.drives().end() || drive->servo_key != "hand.servo") continue;
    const auto joint = std::ranges::find(model.joint_names(), log.parts[part]);
    if (joint == model.joint_names().end()) continue;
    moved.push_back({.part = static_cast<Eigen::Index>(part),
                     .joint = static_cast<std::size_t>(joint - model.joint_names().begin()),
                     .frames = frames[part]});
  }
  return moved;
}

double CommandAt(const ChainLog& log, const MovedJoint& joint, double row) {
  constexpr double kRounding = 1e-6;  // of a row
  const Eigen::Index last = log.command_deg.rows() - 1;
  const auto command = log.command_deg.col(joint.part);
  const Eigen::Index before = std::min(static_cast<Eigen::Index>(row + kRounding), last);
  const Eigen::Index behind = std::min(before + 1, last);
  if (joint.frames) {
    return command[joint.frames->SentAt(behind) <= row + kRounding ? behind : before];
  }
  return std::lerp(command[before], command[behind], row - static_cast<double>(before));
}

/// A glove of these joints with an exact scale from counts to angles: without a filter its counts
/// are the command of the hand.
controller::GloveCalibration ExactGlove(const std::vector<std::string>& joints) {
  return {.channel_names = joints,
          .low_counts = std::vector<double>(joints.size(), 0.0),
          .high_counts = std::vector<double>(joints.size(), kFullScale_counts),
          .low_angle_rad = std::vector<double>(joints.size(), -kMostAngle_rad),
          .high_angle_rad = std::vector<double>(joints.size(), kMostAngle_rad),
          .full_scale_counts = {kFullScale_counts}};
}

double CountsOf(double angle_rad) {
  return kFullScale_counts * 0.5 * (1.0 + angle_rad / kMostAngle_rad);
}

/// Joint angles for given spool angles, with cables that neither stretch nor go slack.
class JointsOfSpools {
 public:
  explicit JointsOfSpools(const controller::TendonTransmission& hand)
      : hand_(hand), map_(hand, true), motor_(hand.motor_names.size()) {}

  void Read(const Hand& hand, std::span<double> joint_angle_rad) {
    hand.ReadSpoolAngles(motor_);
    for (std::size_t i = 0; i < motor_.size(); ++i) {
      motor_[i] = hand_.center_counts[i] + hand_.counts_per_rad[i] * motor_[i];
    }
    map_.ToJointAngles(std::span<const double>(motor_), joint_angle_rad);
  }

 private:
  const controller::TendonTransmission& hand_;
  controller::TendonMap map_;
  std::vector<double> motor_;  // counts
};

}  // namespace

ChainLog SimulatedAnswer(const ChainLog& log, const HandConfig& hand) {
  const auto model =
      std::make_shared<const HandModel>(hand, MakeLoopTiming({.event_delay_ms = 0.0}));
  ChainLog answer;
  answer.name = log.name;
  answer.held = log.held && log.rate_hz <= kMostAnswerRows_hz;
  const std::vector<MovedJoint> moved = MovedJoints(log, *model);
  if (moved.empty()) return answer;
  for (const MovedJoint& joint : moved) answer.parts.push_back(log.parts[joint.part]);
  const controller::Timing& timing = model->timing().controller;
  const auto ticks_per_row = std::max<Eigen::Index>(
      1, std::lround(timing.tick_rate_hz / std::min(log.rate_hz, kMostAnswerRows_hz)));
  answer.rate_hz = timing.tick_rate_hz / static_cast<double>(ticks_per_row);
  const double duration_s =
      std::min(static_cast<double>(log.command_deg.rows()) / log.rate_hz, kLongestAnswer_s);
  const auto rows = static_cast<Eigen::Index>(duration_s * answer.rate_hz);
  Signal command_deg(rows, std::ssize(moved));
  Signal angle_deg(rows, std::ssize(moved));
  Signal motor_deg(rows, std::ssize(moved));

  HandLoop loop({}, ExactGlove(answer.parts), {}, model);
  std::vector<double> joint_angle_rad = model->transmission().reference_angle_rad;
  for (const auto& [part, joint, frames] : moved) {
    joint_angle_rad[joint] = log.command_deg(0, part) * kRadPerDeg;
  }
  loop.Reset(joint_angle_rad);
  JointsOfSpools joints_of_spools(model->transmission());
  std::vector<double> told_by_spools_rad(joint_angle_rad.size());
  std::vector<double> counts(moved.size());
  for (Eigen::Index tick = 0; tick < rows * ticks_per_row; ++tick) {
    const double log_row = static_cast<double>(tick) / timing.tick_rate_hz * log.rate_hz;
    const Eigen::Index row = tick / ticks_per_row;
    const bool kept = tick % ticks_per_row == 0;
    if (kept) {
      loop.hand().ReadJointAngles(joint_angle_rad);
      joints_of_spools.Read(loop.hand(), told_by_spools_rad);
    }
    for (Eigen::Index i = 0; i < std::ssize(moved); ++i) {
      const MovedJoint& joint = moved[static_cast<std::size_t>(i)];
      const double told_deg = CommandAt(log, joint, log_row);
      counts[static_cast<std::size_t>(i)] = CountsOf(told_deg * kRadPerDeg);
      if (!kept) continue;
      command_deg(row, i) = told_deg;
      angle_deg(row, i) = joint_angle_rad[joint.joint] * kDegPerRad;
      motor_deg(row, i) = told_by_spools_rad[joint.joint] * kDegPerRad;
    }
    loop.Step({.counts = counts});
  }
  if (!loop.hand().health().ok) return answer;
  answer.command_deg = std::move(command_deg);
  answer.angle_deg = std::move(angle_deg);
  answer.motor_deg = std::move(motor_deg);
  return answer;
}

}  // namespace gauntlet::sim
