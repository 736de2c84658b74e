#include "controller/step_recorder.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>

#include "controller/number.h"
#include "controller/settings.h"

namespace gauntlet::controller {
namespace {

constexpr int kMostSteps = 1'000'000;

std::size_t CheckedSteps(int steps) {
  if (steps < 1 || steps > kMostSteps) {
    throw SettingError("steps", "is " + std::to_string(steps) + ", must be from 1 to " +
                                    std::to_string(kMostSteps));
  }
  return static_cast<std::size_t>(steps);
}

std::vector<std::string> ColumnNames(const RobotConfig& robot) {
  std::vector<std::string> columns = {"tick", "sample", "frame_number", "event", "glove"};
  const auto add = [&](std::string_view signal, const std::vector<std::string>& names) {
    for (const std::string& name : names) columns.push_back(std::string(signal) + "." + name);
  };
  add("counts", robot.glove.channel_names);
  add("untrusted", robot.glove.channel_names);
  add("target_angle_rad", robot.hand.joint_names);
  add("command_counts", robot.hand.motor_names);
  return columns;
}

}  // namespace

StepRecorder::StepRecorder(const RobotConfig& robot, int steps)
    : channel_count_(static_cast<int>(robot.glove.channel_names.size())),
      joint_count_(static_cast<int>(robot.hand.joint_names.size())),
      motor_count_(static_cast<int>(robot.hand.motor_names.size())),
      column_names_(ColumnNames(robot)),
      steps_(CheckedSteps(steps)),
      rows_(steps_ * column_names_.size()) {}

bool StepRecorder::Keep(const GloveSample* sample, const Controller& controller,
                        const Command& command) noexcept {
  const std::int64_t tick = ticks_++;
  const bool fits = controller.channel_count() == channel_count_ &&
                    controller.joint_count() == joint_count_ &&
                    std::ssize(command.motor_counts) == motor_count_;
  if (!fits) return false;

  const std::span<const double> counts = sample ? sample->counts : std::span<const double>();
  const bool numbered = sample && sample->number;
  double* value = rows_.data() + next_ * column_names_.size();
  *value++ = static_cast<double>(tick);
  *value++ = sample ? 1.0 : 0.0;
  *value++ = numbered ? static_cast<double>(*sample->number) : kNaN;
  *value++ = command.event ? 1.0 : 0.0;
  *value++ = static_cast<int>(command.glove);
  for (int channel = 0; channel < channel_count_; ++channel) {
    *value++ = channel < std::ssize(counts) ? counts[static_cast<std::size_t>(channel)] : kNaN;
  }
  for (int channel = 0; channel < channel_count_; ++channel) {
    const std::optional<Untrusted> reason = controller.untrusted(channel);
    *value++ = reason ? 1 + static_cast<int>(*reason) : 0;
  }
  value = std::ranges::copy(controller.target_angle_rad(), value).out;
  std::ranges::copy(command.motor_counts, value);

  next_ = (next_ + 1) % steps_;
  size_ = std::min(size_ + 1, steps_);
  return true;
}

std::size_t StepRecorder::CopyTo(std::span<double> rows) const noexcept {
  const std::size_t columns = column_names_.size();
  const std::size_t count = std::min(size_, rows.size() / columns);
  const std::size_t oldest = (next_ + steps_ - count) % steps_;
  const std::size_t before_end = std::min(count, steps_ - oldest);
  const double* begin = rows_.data();
  double* rest = std::copy_n(begin + oldest * columns, before_end * columns, rows.data());
  std::copy_n(begin, (count - before_end) * columns, rest);
  return count;
}

}  // namespace gauntlet::controller
