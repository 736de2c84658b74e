#include "sim/calibrate/simulated_answer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "controller/tendon_map.h"
#include "controller/timing.h"
#include "sim/hand/hand.h"

namespace gauntlet::sim {
namespace {

struct MovedJoint {
  Eigen::Index part;
  std::size_t joint;
};

std::vector<MovedJoint> MovedJoints(const ChainLog& log, const HandModel& model) {
  std::vector<MovedJoint> moved;
  for (std::size_t part = 0; part < log.parts.size(); ++part) {
    const auto drive = std::ranges::find(model.drives(), log.parts[part], &Drive::name);
    if (drive == model.drives().end() || drive->servo_key != "hand.servo") continue;
    const auto joint = std::ranges::find(model.joint_names(), log.parts[part]);
    if (joint == model.joint_names().end()) continue;
    moved.push_back({.part = static_cast<Eigen::Index>(part),
                     .joint = static_cast<std::size_t>(joint - model.joint_names().begin())});
  }
  return moved;
}

double CommandAt(const ChainLog& log, Eigen::Index part, double row) {
  const Eigen::Index last = log.command_deg.rows() - 1;
  const Eigen::Index before = std::min(static_cast<Eigen::Index>(row), last);
  const Eigen::Index behind = std::min(before + 1, last);
  return std::lerp(log.command_deg(before, part), log.command_deg(behind, part),
                   row - static_cast<double>(before));
}

}  // namespace

ChainLog SimulatedAnswer(const ChainLog& log, const std::shared_ptr<const HandModel>& model) {
  ChainLog answer;
  answer.name = log.name;
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

  const controller::TendonTransmission& transmission = model->transmission();
  controller::TendonMap map(transmission, true);
  controller::PeriodicClock event(timing.TicksOf(timing.event_period_ms));
  std::vector<double> told_rad = transmission.reference_angle_rad;
  std::vector<double> angle_rad(told_rad.size());
  std::vector<std::int32_t> counts(transmission.motor_names.size());
  const auto tell = [&](Eigen::Index tick) {
    const double row = static_cast<double>(tick) / timing.tick_rate_hz * log.rate_hz;
    for (const auto& [part, joint] : moved) {
      told_rad[joint] = CommandAt(log, part, row) * kRadPerDeg;
    }
  };
  Hand hand(model);
  tell(0);
  hand.Reset(told_rad);
  for (Eigen::Index tick = 0; tick < rows * ticks_per_row; ++tick) {
    tell(tick);
    if (event.Tick()) {
      map.ToMotorCounts(told_rad, counts);
      hand.SetCommand(counts);
    }
    if (tick % ticks_per_row == 0) {
      hand.ReadJointAngles(angle_rad);
      for (Eigen::Index i = 0; i < std::ssize(moved); ++i) {
        const std::size_t joint = moved[static_cast<std::size_t>(i)].joint;
        command_deg(tick / ticks_per_row, i) = told_rad[joint] * kDegPerRad;
        angle_deg(tick / ticks_per_row, i) = angle_rad[joint] * kDegPerRad;
      }
    }
    hand.Step();
  }
  if (!hand.health().ok) return answer;
  answer.command_deg = std::move(command_deg);
  answer.angle_deg = std::move(angle_deg);
  return answer;
}

}  // namespace gauntlet::sim
