#include "controller/controller_config.h"

#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace gauntlet::controller {

namespace {

/// Whole numbers, one per motor.
void VisitCounts(SettingsVisitor& visitor, const Setting& setting, std::vector<int>& counts) {
  std::vector<double> numbers(counts.begin(), counts.end());
  visitor.Numbers(setting, numbers);
  counts.clear();
  for (const double number : numbers) {
    if (number != std::floor(number)) {
      throw SettingError(std::string(setting.key),
                         "holds " + NumberText(number) + ", must be whole numbers");
    }
    counts.push_back(static_cast<int>(number));
  }
}

void VisitCountsPerMotor(SettingsVisitor& visitor, TendonTransmission& hand) {
  constexpr double kMost = 1e9;
  VisitCounts(visitor,
              {.key = "center_counts",
               .help = "command of each motor for the reference posture",
               .min = -kMost,
               .max = kMost},
              hand.center_counts);
  VisitCounts(
      visitor,
      {.key = "min_counts", .help = "smallest command of each motor", .min = -kMost, .max = kMost},
      hand.min_counts);
  VisitCounts(
      visitor,
      {.key = "max_counts", .help = "largest command of each motor", .min = -kMost, .max = kMost},
      hand.max_counts);
}

}  // namespace

void GloveCalibration::Visit(SettingsVisitor& visitor) {
  visitor.Texts({.key = "channel_names", .help = "channels of the glove, in the order of a sample"},
                channel_names);
  visitor.Numbers({.key = "low_counts", .help = "what each channel gives in the first known pose"},
                  low_counts);
  visitor.Numbers({.key = "high_counts", .help = "and in the second"}, high_counts);
  visitor.Numbers({.key = "low_angle_rad", .help = "angle of each channel in the first known pose"},
                  low_angle_rad);
  visitor.Numbers({.key = "high_angle_rad", .help = "and in the second"}, high_angle_rad);
  visitor.Number({.key = "full_scale_counts",
                  .help = "largest value of the converter",
                  .min = 0,
                  .max = 1e9,
                  .open_range = true},
                 full_scale_counts);
}

void TendonTransmission::Visit(SettingsVisitor& visitor) {
  visitor.Texts({.key = "joint_names", .help = "joints of the hand"}, joint_names);
  visitor.Texts({.key = "motor_names", .help = "motors of the hand, in the order of a command"},
                motor_names);
  visitor.Numbers(
      {.key = "coupling", .help = "turn of each spool per turn of each joint, motor by motor"},
      coupling);
  visitor.Texts({.key = "motor_of_joint",
                 .help = "for each joint the motor that is made for it; \"\": all that move it"},
                motor_of_joint);
  visitor.Numbers({.key = "reference_angle_rad", .help = "joint angles at center_counts"},
                  reference_angle_rad);
  visitor.Numbers({.key = "joint_min_rad", .help = "smallest angle of each joint"}, joint_min_rad);
  visitor.Numbers({.key = "joint_max_rad", .help = "largest angle of each joint"}, joint_max_rad);
  visitor.Numbers({.key = "counts_per_rad", .help = "counts per turn of each spool"},
                  counts_per_rad);
  VisitCountsPerMotor(visitor, *this);
}

void RobotConfig::Visit(SettingsVisitor& visitor) {
  VisitGroup(visitor, {.key = "controller", .help = "what the controller does"}, controller);
  VisitGroup(visitor, {.key = "glove", .help = "what is known of the glove"}, glove);
  joint_map.Visit(visitor, {.key = "joint_map",
                            .help = "joints that do not follow the channel of their own name"});
  VisitGroup(visitor, {.key = "hand", .help = "what is known of the hand"}, hand);
  VisitGroup(visitor, {.key = "timing", .help = "clocks of the control loop"}, timing);
}

void ControllerConfig::Visit(SettingsVisitor& visitor) {
  VisitList(visitor,
            {.key = "filter",
             .help = "one filter, or a list of filters that are applied in this order; a filter "
                     "is its kind, or a group with the kind and its settings"},
            filters);
  static constexpr std::array<std::string_view, 2> kOn = {"counts", "angle"};
  VisitEnum(visitor,
            {.key = "filter_on",
             .help = "counts: filter the converter's counts, then linearise (the paper); angle: "
                     "linearise first"},
            kOn, filter_on);
  static constexpr std::array<std::string_view, 2> kAt = {"sample", "event"};
  VisitEnum(visitor,
            {.key = "filter_at",
             .help = "sample: the filter steps at every sample; event: once per command frame, on "
                     "the newest sample"},
            kAt, filter_at);
  visitor.Flag({.key = "coupling_compensation",
                .help = "undo the coupling of cables that cross several joints"},
               coupling_compensation);
  VisitGroup(visitor, {.key = "linearisation", .help = "from counts to bending angles"},
             linearisation);
  VisitGroup(visitor, {.key = "prediction", .help = "look ahead to make up for the delay"},
             prediction);
  VisitGroup(visitor, {.key = "motor", .help = "how commands become whole motor counts"}, motor);
  VisitGroup(visitor, {.key = "untrusted", .help = "which samples are not trusted"}, untrusted);
}

}  // namespace gauntlet::controller
