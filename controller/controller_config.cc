#include "controller/controller_config.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

#include "controller/one_for_each.h"

namespace gauntlet::controller {

namespace {

constexpr double kMostCounts = 1e9;

constexpr Setting kFullScaleCounts = {
    "full_scale_counts", "largest value of the converter, one for all channels or one for each",
    -kMostCounts, kMostCounts};
constexpr Setting kMinCounts = {
    "min_counts",
    "smallest value of the converter, below 0 if it is signed, one for all channels or one for "
    "each",
    -kMostCounts, kMostCounts};

/// One value for each channel. Errors: SettingError for another number of values, or one outside.
std::vector<double> OfEachChannel(const Setting& setting, const std::vector<double>& values,
                                  int channel_count) {
  const std::string key = "calibration." + std::string(setting.key);
  const Eigen::ArrayXd each = OneForEach("channel", channel_count, key, values);
  for (const double value : each) {
    const std::string problem = RangeProblem(setting, value);
    if (!problem.empty()) throw SettingError(key, problem);
  }
  return {each.begin(), each.end()};
}

/// A table: a group with a row of settings for each of these names, so that no value can end up
/// with the wrong one.
void VisitRows(SettingsVisitor& visitor, const Setting& setting,
               const std::vector<std::string>& names,
               const std::function<void(std::size_t, SettingsVisitor&)>& visit_row) {
  visitor.Group(setting, [&](SettingsVisitor& table) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      table.Group({.key = names[i], .help = "", .required = true},
                  [&](SettingsVisitor& row) { visit_row(i, row); });
    }
  });
}

void VisitJoint(SettingsVisitor& row, TendonTransmission& hand, std::size_t i) {
  row.Text({"motor", "the motor that is made for it; \"\": all that move it"},
           hand.motor_of_joint[i]);
  row.Number({.key = "reference_angle_rad", .help = "its angle at center_counts", .required = true},
             hand.reference_angle_rad[i]);
  row.Number({.key = "joint_min_rad", .help = "its smallest angle", .required = true},
             hand.joint_min_rad[i]);
  row.Number({.key = "joint_max_rad", .help = "its largest angle", .required = true},
             hand.joint_max_rad[i]);
}

void VisitMotor(SettingsVisitor& row, TendonTransmission& hand, std::size_t i) {
  const auto visit = [&row](std::string_view key, std::string_view help, int& counts) {
    row.Integer(
        {.key = key, .help = help, .min = -kMostCounts, .max = kMostCounts, .required = true},
        counts);
  };
  visit("center_counts", "its command for the reference posture", hand.center_counts[i]);
  visit("min_counts", "its smallest command", hand.min_counts[i]);
  visit("max_counts", "its largest command", hand.max_counts[i]);
  row.Number({.key = "counts_per_rad", .help = "counts per turn of its spool", .required = true},
             hand.counts_per_rad[i]);
}

/// The matrix with a row per motor.
void VisitCoupling(SettingsVisitor& visitor, TendonTransmission& hand) {
  const std::size_t joints = hand.joint_names.size();
  visitor.Group(
      {"coupling", "turn of each motor's spool per turn of each joint, as in joint_names"},
      [&](SettingsVisitor& matrix) {
        for (std::size_t motor = 0; motor < hand.motor_names.size(); ++motor) {
          const auto begin = hand.coupling.begin() + static_cast<std::ptrdiff_t>(motor * joints);
          std::vector<double> row(begin, begin + static_cast<std::ptrdiff_t>(joints));
          matrix.Numbers({.key = hand.motor_names[motor],
                          .help = "one value per joint",
                          .required = true,
                          .count = joints},
                         row);
          row.resize(joints);
          std::copy(row.begin(), row.end(), begin);
        }
      });
}

}  // namespace

std::vector<ConverterRange> ConvertersOf(const GloveCalibration& glove) {
  const std::size_t count = glove.low_counts.size();
  const auto channels = static_cast<int>(count);
  const std::vector<double> least = OfEachChannel(kMinCounts, glove.min_counts, channels);
  const std::vector<double> most =
      OfEachChannel(kFullScaleCounts, glove.full_scale_counts, channels);
  std::vector<ConverterRange> converters;
  for (std::size_t i = 0; i < count; ++i) {
    converters.push_back({.min_counts = least[i], .full_scale_counts = most[i]});
    if (least[i] < most[i]) continue;
    const bool named = i < glove.channel_names.size();
    throw SettingError("calibration.full_scale_counts",
                       "is " + NumberText(most[i]) + " for channel " +
                           (named ? glove.channel_names[i] : std::to_string(i)) +
                           ", must be above its min_counts, " + NumberText(least[i]) +
                           ", and at most " + NumberText(kMostCounts));
  }
  return converters;
}

void GloveCalibration::Visit(SettingsVisitor& visitor) {
  visitor.Texts({.key = "channel_names",
                 .help = "channels of the glove, in the order of a sample",
                 .required = true},
                channel_names);
  VisitOneForEach(visitor, kFullScaleCounts, full_scale_counts);
  if (visitor.ShowsOptional(kMinCounts, min_counts != std::vector{0.0})) {
    VisitOneForEach(visitor, kMinCounts, min_counts);
  }
  visitor.Integer({"frame_number_bits",
                   "width of the frames' numbers, which begin anew behind it; 64 if they never do",
                   kLeastFrameNumberBits, kMostFrameNumberBits},
                  frame_number_bits);
  struct Column {
    std::string_view key, help;
    std::vector<double>* values;
    double most = std::numeric_limits<double>::infinity();
  };
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;  // more are degrees by mistake
  const Column columns[] = {
      {"low_counts", "what it gives in the first known pose", &low_counts},
      {"high_counts", "and in the second", &high_counts},
      {"low_angle_rad", "its angle in the first known pose", &low_angle_rad, kTurn_rad},
      {"high_angle_rad", "and in the second", &high_angle_rad, kTurn_rad}};
  for (const Column& column : columns) column.values->resize(channel_names.size());
  VisitRows(visitor, {"channels", "two known poses of each channel"}, channel_names,
            [&](std::size_t i, SettingsVisitor& row) {
              for (const Column& column : columns) {
                row.Number({.key = column.key,
                            .help = column.help,
                            .min = -column.most,
                            .max = column.most,
                            .required = true},
                           (*column.values)[i]);
              }
            });
}

void TendonTransmission::Visit(SettingsVisitor& visitor) {
  visitor.Texts({.key = "joint_names", .help = "joints of the hand", .required = true},
                joint_names);
  visitor.Texts({.key = "motor_names",
                 .help = "motors of the hand, in the order of a command",
                 .required = true},
                motor_names);
  const std::size_t joints = joint_names.size();
  const std::size_t motors = motor_names.size();
  if (motor_of_joint.empty() && motors == joints) motor_of_joint = motor_names;
  motor_of_joint.resize(joints);
  for (auto* values : {&reference_angle_rad, &joint_min_rad, &joint_max_rad}) {
    values->resize(joints);
  }
  VisitRows(visitor, {"joints", "posture at center_counts, and range"}, joint_names,
            [this](std::size_t i, SettingsVisitor& row) { VisitJoint(row, *this, i); });
  counts_per_rad.resize(motors);
  for (auto* values : {&center_counts, &min_counts, &max_counts}) values->resize(motors);
  VisitRows(visitor, {"motors", "commands of each motor"}, motor_names,
            [this](std::size_t i, SettingsVisitor& row) { VisitMotor(row, *this, i); });
  coupling.resize(motors * joints);
  VisitCoupling(visitor, *this);
  visitor.Flag({"joint_sensors", "the angles of its joints are measured"}, joint_sensors);
}

void RobotConfig::Visit(SettingsVisitor& visitor) {
  VisitGroup(visitor, {.key = "controller", .help = "what the controller does", .required = true},
             controller);
  VisitGroup(visitor, {"glove", "what is known of the glove"}, glove);
  joint_map.Visit(visitor,
                  {"joint_map", "joints that do not follow the channel of their own name"});
  VisitGroup(visitor, {"hand", "what is known of the hand"}, hand);
  VisitGroup(visitor, {.key = "timing", .help = "clocks of the control loop", .required = true},
             timing);
}

void ControllerConfig::Visit(SettingsVisitor& visitor) {
  VisitList(visitor,
            {"filter",
             "one filter, or a list of filters that are applied in this order; a filter is its "
             "kind, or a group with the kind and its settings"},
            filters);
  static constexpr std::array<std::string_view, 2> kOn = {"counts", "angle"};
  VisitEnum(
      visitor,
      {"filter_on",
       "counts: filter the converter's counts, then linearise (the paper); angle: linearise first"},
      kOn, filter_on);
  static constexpr std::array<std::string_view, 2> kAt = {"sample", "event"};
  VisitEnum(visitor,
            {"filter_at",
             "sample: the filter steps at every sample; event: per command frame, on the "
             "newest sample"},
            kAt, filter_at);
  visitor.Flag(
      {"coupling_compensation", "compensate the coupling of cables that cross several joints"},
      coupling_compensation);
  VisitGroup(visitor, {"linearisation", "from counts to bending angles"}, linearisation);
  VisitGroup(visitor, {"prediction", "prediction to compensate the delay"}, prediction);
  VisitGroup(visitor, {"model_predictive", "commands planned for how joints follow them"},
             model_predictive);
  VisitGroup(visitor, {"joint_loop", "what it does with measured joint angles"}, joint_loop);
  VisitGroup(visitor, {"motor", "how commands become whole motor counts"}, motor);
  VisitGroup(visitor, {"untrusted", "which samples are not trusted"}, untrusted);
}

}  // namespace gauntlet::controller
