#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/quantile.h"
#include "sim/fit/retarget/fingertip_motion.h"
#include "sim/fit/retarget/motion_table.h"
#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;

constexpr int kDigits = HandKinematics::kFingers;

/// Names of the columns of a recording.
std::vector<std::string> NamesIn(const std::filesystem::path& recording, const std::string& array) {
  const CsvReader reader(recording.string(), StoredTable(recording, array),
                         ProblemHandling::kRepair);
  return reader.header();
}

/// The hand of this side; the only one, if no side is asked for.
KeypointColumns HandIn(const std::filesystem::path& recording,
                       const std::vector<std::string>& names, const std::string& side) {
  const auto fail = [&recording](const std::string& problem) {
    throw UserError({.place = recording.string(), .problem = problem});
  };
  const KeypointLayout layout = FindKeypoints(names, Quaternions::kLeft);
  if (!layout.problem.empty()) fail(layout.problem);
  if (layout.hands.empty()) {
    fail("has no keypoints of a hand: x, y and z of the wrist and of four joints of each digit");
  }
  if (layout.hands.size() == 1 && side.empty()) return layout.hands.front();
  if (side.empty()) fail("has both hands; --side left or --side right takes one");
  const auto hand = std::ranges::find(layout.hands, side, &KeypointColumns::hand);
  if (hand == layout.hands.end()) fail(fmt::format("has no {} hand by its names", side));
  return *hand;
}

/// Columns of a table by the names that a file gives them.
class NamedValues {
 public:
  NamedValues(const MotionTable& table, const std::vector<std::string>& names)
      : table_(table), names_(names) {}
  double operator()(Eigen::Index row, std::size_t column) const {
    const auto place = std::ranges::find(table_.columns, names_[column]) - table_.columns.begin();
    return table_.values(row, place);
  }

 private:
  const MotionTable& table_;
  const std::vector<std::string>& names_;
};

}  // namespace

FingertipMotion FingertipsOfKeypoints(const std::filesystem::path& recording,
                                      const FingertipFormat& format) {
  const std::vector<std::string> names = NamesIn(recording, format.array);
  const KeypointColumns columns = HandIn(recording, names, format.side);
  std::set<std::string, std::less<>> wanted;
  for (const auto& position : columns.position) {
    for (const std::size_t column : position) wanted.insert(names[column]);
  }
  bool has_radii = true;
  for (const auto& radius : columns.tip_radius) {
    has_radii = has_radii && radius.has_value();
    if (radius) wanted.insert(names[*radius]);
  }
  const MotionTable table = LoadMotionTable(
      recording, format, [&](std::string_view name) { return wanted.contains(name); });
  if (table.columns.size() != wanted.size()) {
    throw UserError({.place = table.file, .problem = "has two columns of one name"});
  }
  const NamedValues value(table, names);
  std::vector<HandPoints> points(table.time_s.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (int keypoint = 0; keypoint < kKeypoints; ++keypoint) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        points[k](axis, keypoint) = value(
            static_cast<Eigen::Index>(k),
            columns.position[static_cast<std::size_t>(keypoint)][static_cast<std::size_t>(axis)]);
      }
    }
  }
  PlacedHand hand;
  try {
    hand = PlaceHand(std::move(points), columns.unit_m);
  } catch (const UserError& error) {
    throw UserError({.place = table.file, .problem = error.what()});
  }
  const double unit_m = hand.unit == "m" ? 1.0 : hand.unit == "cm" ? 1e-2 : 1e-3;
  FingertipMotion motion;
  motion.file = table.file;
  motion.hand = "keypoints";
  motion.time_s = table.time_s;
  motion.has_digit.fill(true);
  motion.frames.resize(table.time_s.size());
  motion.is_missing = hand.is_lost;
  std::array<std::vector<double>, kDigits> length_m;
  for (std::size_t k = 0; k < hand.points_m.size(); ++k) {
    if (hand.is_lost[k]) continue;
    const HandPoints& frame_m = hand.points_m[k];
    const auto joint = [&frame_m](int digit, int place) -> Vector3d {
      return frame_m.col(KeypointOf(digit, place));
    };
    const auto radius_m = [&](int digit) {
      return unit_m * value(static_cast<Eigen::Index>(k),
                            columns.tip_radius[static_cast<std::size_t>(digit)].value_or(0));
    };
    FingertipFrame& frame = motion.frames[k];
    for (int finger = 0; finger < kDigits; ++finger) {
      double along_m = 0.0;
      for (int place = 1; place < kJointsOfDigit; ++place) {
        along_m += (joint(finger, place) - joint(finger, place - 1)).norm();
      }
      length_m[static_cast<std::size_t>(finger)].push_back(along_m);
      frame.reach_m[finger] = joint(finger, 3) - joint(finger, 0);
      frame.direction[finger] = (joint(finger, 3) - joint(finger, 2)).normalized();
      if (finger == HandKinematics::kThumb) continue;
      frame.from_thumb_m[finger] = joint(finger, 3) - joint(HandKinematics::kThumb, 3);
      const double touch_m =
          has_radii ? radius_m(finger) + radius_m(HandKinematics::kThumb) : 1e-3 * format.touch_mm;
      frame.gap_m[finger] = frame.from_thumb_m[finger].norm() - touch_m;
      if (std::isfinite(frame.gap_m[finger])) continue;
      motion.is_missing[k] = true;  // a radius
    }
  }
  for (int finger = 0; finger < kDigits; ++finger) {
    motion.length_m[finger] = Quantile(length_m[static_cast<std::size_t>(finger)], 0.5);
  }
  motion.remarks.push_back(fmt::format(
      "{}: {}; {}", table.file, RemarkOf(hand, columns),
      has_radii ? "contact where the radii of two tips meet"
                : fmt::format("contact where two tips are {:g} mm apart (assumed, --touch-mm)",
                              format.touch_mm)));
  std::vector<std::string> ignored = table.ignored;
  std::erase_if(ignored, [&](const std::string& name) {
    const auto column = std::ranges::find(names, name) - names.begin();
    return std::ranges::count(columns.all, static_cast<std::size_t>(column)) > 0;
  });
  if (!ignored.empty()) {
    motion.remarks.push_back(
        fmt::format("{}: no keypoints, left out: {}", table.file, fmt::join(ignored, ", ")));
  }
  return motion;
}

}  // namespace gauntlet::sim
