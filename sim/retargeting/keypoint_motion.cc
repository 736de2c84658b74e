#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "sim/base/error.h"
#include "sim/base/quantile.h"
#include "sim/base/text.h"
#include "sim/retargeting/fingertip_motion.h"
#include "sim/retargeting/motion_table.h"

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;

constexpr int kDigits = HandKinematics::kFingers;

/// OpenXR's joints of a digit from its base to its tip; the thumb begins with its metacarpal.
std::vector<std::string> JointsOfDigit(int finger) {
  const std::string name(HandKinematics::kFingerNames[finger]);
  if (finger == HandKinematics::kThumb) {
    return {name + "_metacarpal", name + "_proximal", name + "_distal", name + "_tip"};
  }
  return {name + "_proximal", name + "_intermediate", name + "_distal", name + "_tip"};
}

std::vector<std::string> AllKeypoints() {
  std::vector<std::string> names = {"palm", "wrist"};
  for (int finger = 0; finger < kDigits; ++finger) {
    for (const std::string& joint : JointsOfDigit(finger)) names.push_back(joint);
    if (finger == HandKinematics::kThumb) continue;
    names.push_back(std::string(HandKinematics::kFingerNames[finger]) + "_metacarpal");
  }
  return names;
}

/// `index_tip_x_mm` is index_tip_x in units of 1e-3 m.
struct KeypointColumn {
  std::string name;
  double scale_m = 1.0;
};
KeypointColumn KeypointColumnOf(std::string_view name) {
  if (name.ends_with("_mm")) return {std::string(name.substr(0, name.size() - 3)), 1e-3};
  if (name.ends_with("_m")) return {std::string(name.substr(0, name.size() - 2)), 1.0};
  return {std::string(name), 1.0};
}

/// Values [m] of the columns of a table, by the names of keypoints.
class Keypoints {
 public:
  explicit Keypoints(const MotionTable& table) : table_(table) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const KeypointColumn column = KeypointColumnOf(table.columns[i]);
      if (!columns_.emplace(column.name, Place{static_cast<Eigen::Index>(i), column.scale_m})
               .second) {
        throw UserError({.place = table.file,
                         .key = Shown(table.columns[i]),
                         .problem = "is a second column of " + column.name});
      }
    }
  }
  void Require(const std::string& joint) const {
    for (const char* axis : {"_x", "_y", "_z"}) {
      if (columns_.contains(joint + axis)) continue;
      throw UserError(
          {.place = table_.file,
           .problem = fmt::format("has no column {}{}; keypoints need wrist and four "
                                  "joints of each digit, from {} to {}",
                                  joint, axis, JointsOfDigit(0).front(), JointsOfDigit(4).back())});
    }
  }
  Vector3d At(Eigen::Index row, const std::string& joint) const {
    return {Value(row, joint + "_x"), Value(row, joint + "_y"), Value(row, joint + "_z")};
  }
  bool HasRadius(const std::string& joint) const { return columns_.contains(joint + "_radius"); }
  double Radius(Eigen::Index row, const std::string& joint) const {
    return Value(row, joint + "_radius");
  }

 private:
  struct Place {
    Eigen::Index column = 0;
    double scale_m = 1.0;
  };
  double Value(Eigen::Index row, const std::string& name) const {
    const Place& place = columns_.at(name);
    return place.scale_m * table_.values(row, place.column);
  }

  const MotionTable& table_;
  std::map<std::string, Place> columns_;
};

/// Errors: UserError unless wrist to middle fingertip along the joints is as long as in a hand.
void CheckSize(const MotionTable& table, double hand_m) {
  constexpr double kShortest_m = 0.10;
  constexpr double kLongest_m = 0.30;
  if (hand_m >= kShortest_m && hand_m <= kLongest_m) return;
  const bool may_be_mm = hand_m >= 1e3 * kShortest_m && hand_m <= 1e3 * kLongest_m;
  const std::string advice =
      may_be_mm ? "; these look like millimetres: name the columns as index_tip_x_mm" : "";
  throw UserError({.place = table.file,
                   .problem = fmt::format("from the wrist to the tip of the middle finger it is "
                                          "{:.4g} m, must be from {} to {} m{}",
                                          hand_m, kShortest_m, kLongest_m, advice)});
}

}  // namespace

FingertipMotion FingertipsOfKeypoints(const std::filesystem::path& recording,
                                      const FingertipFormat& format) {
  const std::vector<std::string> known = AllKeypoints();
  const MotionTable table =
      LoadMotionTable(recording, format.array, format.rate_hz, [&](std::string_view name) {
        const std::string column = KeypointColumnOf(name).name;
        const std::size_t end = std::min(column.rfind('_'), column.size());
        const std::string part = column.substr(end);
        return std::ranges::count(known, column.substr(0, end)) > 0 &&
               (part == "_x" || part == "_y" || part == "_z" || part == "_radius");
      });
  const Keypoints points(table);
  points.Require("wrist");
  bool has_radii = true;
  for (int finger = 0; finger < kDigits; ++finger) {
    const std::vector<std::string> joints = JointsOfDigit(finger);
    for (const std::string& joint : joints) points.Require(joint);
    has_radii = has_radii && points.HasRadius(joints.back());
  }
  FingertipMotion motion;
  motion.file = table.file;
  motion.hand = "keypoints";
  motion.time_s = table.time_s;
  motion.has_digit.fill(true);
  motion.frames.resize(table.time_s.size());
  std::array<std::vector<double>, kDigits> length_m;
  std::vector<double> hand_m;
  std::array<double, kDigits> lowered_m = {};
  for (Eigen::Index row = 0; row < table.values.rows(); ++row) {
    const Vector3d wrist = points.At(row, "wrist");
    std::array<Vector3d, kDigits> base;
    std::array<Vector3d, kDigits> tip;
    std::array<Vector3d, kDigits> last;
    std::array<double, kDigits> radius_m = {};
    std::array<double, kDigits> along_m = {};
    Vector3d middle = Vector3d::Zero();
    bool is_finite = wrist.allFinite();
    for (int finger = 0; finger < kDigits; ++finger) {
      const std::vector<std::string> joints = JointsOfDigit(finger);
      base[finger] = points.At(row, joints.front());
      Vector3d before = base[finger];
      for (std::size_t i = 1; i < joints.size(); ++i) {
        const Vector3d here = points.At(row, joints[i]);
        along_m[finger] += (here - before).norm();
        last[finger] = here - before;
        before = here;
      }
      tip[finger] = before;
      if (has_radii) radius_m[finger] = points.Radius(row, joints.back());
      is_finite = is_finite && std::isfinite(along_m[finger] + radius_m[finger]);
      if (finger != HandKinematics::kThumb) middle += 0.25 * base[finger];
    }
    motion.is_missing.push_back(!is_finite);
    if (!is_finite) continue;
    const Vector3d x = (middle - wrist).normalized();
    const Vector3d across = base[HandKinematics::kIndex] - base[HandKinematics::kLittle];
    const Vector3d y = (across - across.dot(x) * x).normalized();
    Eigen::Matrix3d to_frame;
    to_frame << x.transpose(), y.transpose(), x.cross(y).transpose();
    FingertipFrame& frame = motion.frames[row];
    for (int finger = 0; finger < kDigits; ++finger) {
      length_m[finger].push_back(along_m[finger]);
      frame.reach_m[finger] = to_frame * (tip[finger] - base[finger]);
      frame.direction[finger] = to_frame * last[finger].normalized();
      if (finger == HandKinematics::kThumb) continue;
      frame.from_thumb_m[finger] = to_frame * (tip[finger] - tip[HandKinematics::kThumb]);
      const double touch_m =
          has_radii ? radius_m[finger] + radius_m[HandKinematics::kThumb] : 1e-3 * format.touch_mm;
      frame.gap_m[finger] = frame.from_thumb_m[finger].norm() - touch_m;
      lowered_m[finger] -= frame.reach_m[finger].z();
    }
    hand_m.push_back((base[HandKinematics::kMiddle] - wrist).norm() +
                     along_m[HandKinematics::kMiddle]);
  }
  if (hand_m.empty()) throw UserError({.place = table.file, .problem = "no row has all keypoints"});
  CheckSize(table, Quantile(hand_m, 0.5));
  double lowered = 0.0;  // mean share of the fingers' length by which the tips are lowered
  for (int finger = 0; finger < kDigits; ++finger) {
    motion.length_m[finger] = Quantile(length_m[finger], 0.5);
    lowered += lowered_m[finger] / motion.length_m[finger] / 4.0 / std::ssize(hand_m);
  }
  constexpr double kLeastBend = 0.05;
  if (!(std::abs(lowered) > kLeastBend)) {
    throw UserError({.place = table.file,
                     .problem = "the fingers never bend, so the side of the palm is unknown; "
                                "record a fist, too"});
  }
  // Fingers bend towards the palm: of a left hand z has pointed there.
  for (FingertipFrame& frame : motion.frames) {
    if (lowered > 0.0) break;
    for (int finger = 0; finger < kDigits; ++finger) {
      for (Vector3d* vector :
           {&frame.reach_m[finger], &frame.direction[finger], &frame.from_thumb_m[finger]}) {
        vector->z() = -vector->z();
      }
    }
  }
  motion.remarks.push_back(fmt::format(
      "{}: a {} hand, {:.0f} mm from the wrist to the tip of the middle finger; {}", table.file,
      lowered > 0.0 ? "right" : "left", 1e3 * Quantile(hand_m, 0.5),
      has_radii ? "contact where the radii of two tips meet"
                : fmt::format("contact where two tips are {:g} mm apart (assumed, --touch-mm)",
                              format.touch_mm)));
  if (!table.ignored.empty()) {
    motion.remarks.push_back(
        fmt::format("{}: no keypoints, left out: {}", table.file, fmt::join(table.ignored, ", ")));
  }
  return motion;
}

}  // namespace gauntlet::sim
