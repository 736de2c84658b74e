#include "sim/fit/retarget/fingertip_motion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/fit/retarget/motion_table.h"

namespace gauntlet::sim {
namespace {

constexpr int kFingers = HandKinematics::kFingers;
constexpr int kThumb = HandKinematics::kThumb;

/// A column of angles: the joint and the scale to rad.
struct AngleColumn {
  std::string joint;
  double scale = kRadPerDeg;
  bool has_unit = false;
};

/// `unit`: of a name without one; empty: not given.
AngleColumn ColumnOf(std::string_view name, std::string_view unit) {
  if (name.ends_with("_deg"))
    return {std::string(name.substr(0, name.size() - 4)), kRadPerDeg, true};
  if (name.ends_with("_rad")) return {std::string(name.substr(0, name.size() - 4)), 1.0, true};
  return {std::string(name), unit == "rad" ? 1.0 : kRadPerDeg, !unit.empty()};
}

std::optional<std::size_t> PlaceOf(const std::vector<HandJoint>& joints, const std::string& name) {
  const auto found = std::ranges::find(joints, name, &HandJoint::name);
  if (found == joints.end()) return std::nullopt;
  return found - joints.begin();
}

/// Errors: UserError for angles without a unit, all of which are small enough for radians.
void CheckUnit(const MotionTable& table, const std::vector<AngleColumn>& columns) {
  constexpr double kMostRadians = 7.0;
  double largest = 0.0;
  std::string first;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].has_unit) continue;
    if (first.empty()) first = table.columns[i];
    for (const double value : table.values.col(static_cast<Eigen::Index>(i))) {
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
  }
  if (first.empty() || largest == 0.0 || largest > kMostRadians) return;
  throw UserError({.place = table.file,
                   .key = Shown(first),
                   .problem = fmt::format("no angle is above {:.3g}, so these may be radians: "
                                          "--unit rad or --unit deg, or name them {}_rad or {}_deg",
                                          largest, first, first)});
}

void AddFrame(const HandKinematics& hand, double touch_m, FingertipFrame& frame) {
  for (int finger = 0; finger < kFingers; ++finger) {
    if (!hand.digits()[finger].exists) continue;
    frame.reach_m[finger] = hand.Tip(finger) - hand.digits()[finger].base_m;
    frame.direction[finger] = hand.TipDirection(finger);
    if (finger == kThumb) continue;
    frame.from_thumb_m[finger] = hand.Tip(finger) - hand.Tip(kThumb);
    frame.gap_m[finger] = GapOfPinch(hand, finger, touch_m);
  }
}

}  // namespace

double GapOfPinch(const HandKinematics& hand, int finger, double touch_m) {
  if (const auto gap = hand.PinchGap(finger)) return gap->gap_m;
  return (hand.Tip(finger) - hand.Tip(kThumb)).norm() - touch_m;
}

FingertipMotion FingertipsOfAngles(const std::filesystem::path& recording, HandKinematics& hand,
                                   const FingertipFormat& format) {
  const auto is_other = [&format](const std::string& name) {
    return std::ranges::count(format.copied, name) > 0;
  };
  const MotionTable table = LoadMotionTable(recording, format, [&](std::string_view name) {
    const std::string joint = ColumnOf(name, format.unit).joint;
    return PlaceOf(hand.joints(), joint).has_value() || is_other(joint);
  });
  std::vector<AngleColumn> columns;
  for (const std::string& name : table.columns) columns.push_back(ColumnOf(name, format.unit));
  FingertipMotion motion;
  motion.file = table.file;
  motion.hand = hand.file();
  motion.time_s = table.time_s;
  const Eigen::Index rows = table.values.rows();
  const auto joint_count = std::ssize(hand.joints());
  motion.angle_rad.resize(rows, joint_count);
  motion.other_angle_rad.resize(rows, std::ranges::count_if(columns, [&](const AngleColumn& c) {
                                  return is_other(c.joint);
                                }));
  const std::vector<double> neutral = hand.NeutralAngles();
  for (Eigen::Index j = 0; j < joint_count; ++j) motion.angle_rad.col(j).setConstant(neutral[j]);
  std::vector<bool> is_recorded(hand.joints().size(), false);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto angle_rad = columns[i].scale * table.values.col(static_cast<Eigen::Index>(i));
    if (const auto place = PlaceOf(hand.joints(), columns[i].joint)) {
      if (is_recorded[*place]) {
        throw UserError({.place = table.file,
                         .key = Shown(table.columns[i]),
                         .problem = "is a second column of the joint " + columns[i].joint});
      }
      motion.angle_rad.col(static_cast<Eigen::Index>(*place)) = angle_rad;
      is_recorded[*place] = true;
    } else {
      motion.other_angle_rad.col(std::ssize(motion.other_joints)) = angle_rad;
      motion.other_joints.push_back(columns[i].joint);
    }
  }
  std::vector<std::string> held;
  for (std::size_t j = 0; j < is_recorded.size(); ++j) {
    motion.joints.push_back(hand.joints()[j].name);
    if (!is_recorded[j]) held.push_back(hand.joints()[j].name);
    for (int finger = 0; finger < kFingers; ++finger) {
      motion.has_digit[finger] =
          motion.has_digit[finger] || (is_recorded[j] && hand.Moves(j, finger));
    }
  }
  if (std::ranges::none_of(motion.has_digit, std::identity())) {
    throw UserError({.place = table.file,
                     .problem = fmt::format(
                         "no column is a joint that moves a fingertip of {}: {}", hand.file(),
                         OneLine(fmt::format("{}", fmt::join(motion.joints, ", ")), 200))});
  }
  CheckUnit(table, columns);
  if (!held.empty()) {
    motion.remarks.push_back(
        fmt::format("{}: not recorded, held at 0 (or the end of the range next "
                    "to it): {}",
                    table.file, fmt::join(held, ", ")));
  }
  if (!table.ignored.empty()) {
    motion.remarks.push_back(fmt::format("{}: no joints of {}, left out: {}", table.file,
                                         hand.file(), fmt::join(table.ignored, ", ")));
  }
  for (int finger = 0; finger < kFingers; ++finger) {
    motion.length_m[finger] = hand.digits()[finger].length_m;
  }
  std::vector<double> angles(hand.joints().size());
  motion.frames.resize(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    motion.is_missing.push_back(!motion.angle_rad.row(row).allFinite());
    if (motion.is_missing.back()) continue;
    Eigen::Map<Eigen::RowVectorXd>(angles.data(), joint_count) = motion.angle_rad.row(row);
    hand.SetAngles(angles);
    AddFrame(hand, 1e-3 * format.touch_mm, motion.frames[row]);
  }
  return motion;
}

}  // namespace gauntlet::sim
