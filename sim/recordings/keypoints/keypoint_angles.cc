#include "sim/recordings/keypoints/keypoint_angles.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/quantile.h"
#include "sim/base/signal.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;

constexpr int kWrist = 0;
constexpr int kThumb = 0;
constexpr int kIndex = 1;
constexpr int kMiddle = 2;
constexpr int kLittle = 4;
constexpr double kShortest_m = 0.10;
constexpr double kLongest_m = 0.30;

/// Bones as pairs of keypoints: from the wrist to each digit, and along the digits.
using Bone = std::pair<int, int>;
const std::vector<Bone>& Bones() {
  static const std::vector<Bone> kBones = [] {
    std::vector<Bone> bones;
    for (int digit = 0; digit < kDigitsOfHand; ++digit) {
      bones.emplace_back(kWrist, KeypointOf(digit, 0));
      for (int joint = 1; joint < kJointsOfDigit; ++joint) {
        bones.emplace_back(KeypointOf(digit, joint - 1), KeypointOf(digit, joint));
      }
    }
    return bones;
  }();
  return kBones;
}

double LengthOf(const HandPoints& points, const Bone& bone) {
  return (points.col(bone.second) - points.col(bone.first)).norm();
}

double LengthOfHand(const HandPoints& points) {
  double length = LengthOf(points, {kWrist, KeypointOf(kMiddle, 0)});
  for (int joint = 1; joint < kJointsOfDigit; ++joint) {
    length += LengthOf(points, {KeypointOf(kMiddle, joint - 1), KeypointOf(kMiddle, joint)});
  }
  return length;
}

bool IsOnePoint(const HandPoints& points) {
  return (points.colwise() - points.col(0)).cwiseAbs().maxCoeff() == 0.0;
}

/// Frames that are no measurement.
std::vector<bool> LostFrames(const std::vector<HandPoints>& points) {
  std::vector<bool> is_lost(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    is_lost[k] = !points[k].allFinite() || IsOnePoint(points[k]);
  }
  MarkRepeats([&](std::size_t k) { return points[k] == points[k - 1]; }, is_lost);
  return is_lost;
}

/// Median length of each bone over the frames that are not lost.
std::vector<double> UsualLengths(const std::vector<HandPoints>& points,
                                 const std::vector<bool>& is_lost) {
  std::vector<double> usual;
  for (const Bone& bone : Bones()) {
    std::vector<double> lengths;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!is_lost[k]) lengths.push_back(LengthOf(points[k], bone));
    }
    usual.push_back(Quantile(lengths, 0.5));
  }
  return usual;
}

/// Median over the bones of the mean relative deviation of their lengths.
double SpreadOfBones(const std::vector<HandPoints>& points, const std::vector<bool>& is_lost,
                     const std::vector<double>& usual) {
  std::vector<double> spreads;
  for (std::size_t b = 0; b < usual.size(); ++b) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (is_lost[k]) continue;
      sum += std::abs(LengthOf(points[k], Bones()[b]) / usual[b] - 1.0);
      count += 1.0;
    }
    spreads.push_back(usual[b] > 0.0 ? sum / count : 1.0);
  }
  return Quantile(spreads, 0.5);
}

struct Unit {
  std::string_view name;
  double unit_m;
};
constexpr std::array<Unit, 3> kUnits = {{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}}};

bool IsHandLong(double length_m) { return length_m >= kShortest_m && length_m <= kLongest_m; }

/// The unit in which the length is that of a hand.
std::optional<Unit> UnitOf(double length, double unit_m) {
  for (const Unit& unit : kUnits) {
    if (unit_m != 0.0 && unit_m != unit.unit_m) continue;
    if (IsHandLong(length * unit.unit_m)) return unit;
  }
  return std::nullopt;
}

/// True if the wrist has no depth although it moves in the image.
bool IsOfImage(const std::vector<HandPoints>& points, const std::vector<bool>& is_lost,
               double length) {
  constexpr double kFlat = 1e-4;  // of the length of the hand
  constexpr double kNearlyAll = 0.95;
  double flat = 0.0, all = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (is_lost[k]) continue;
    const Vector3d wrist = points[k].col(kWrist);
    all += 1.0;
    flat += std::abs(wrist.z()) < kFlat * length && wrist.head<2>().norm() > kFlat * length ? 1 : 0;
  }
  return flat > kNearlyAll * all;
}

double MedianLength(const std::vector<HandPoints>& points, const std::vector<bool>& is_lost) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!is_lost[k]) lengths.push_back(LengthOfHand(points[k]));
  }
  return lengths.empty() ? 0.0 : Quantile(lengths, 0.5);
}

/// Turns the points into the frame of the hand, with z = x cross y.
void TurnToHand(HandPoints& points) {
  const Vector3d wrist = points.col(kWrist);
  const Vector3d index = points.col(KeypointOf(kIndex, 0)) - wrist;
  const Vector3d little = points.col(KeypointOf(kLittle, 0)) - wrist;
  const Vector3d x = (index + little).normalized();
  const Vector3d across = index - little;
  const Vector3d y = (across - across.dot(x) * x).normalized();
  Eigen::Matrix3d to_frame;
  to_frame << x.transpose(), y.transpose(), x.cross(y).transpose();
  points = to_frame * (points.colwise() - wrist);
}

/// Mean share of the fingers' lengths by which the tips are below the knuckles.
double LoweredShare(const std::vector<HandPoints>& points, const std::vector<bool>& is_lost) {
  double lowered = 0.0, count = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (is_lost[k]) continue;
    for (int finger = kIndex; finger <= kLittle; ++finger) {
      double length = 0.0;
      for (int joint = 1; joint < kJointsOfDigit; ++joint) {
        length += LengthOf(points[k], {KeypointOf(finger, joint - 1), KeypointOf(finger, joint)});
      }
      if (!(length > 0.0)) continue;
      lowered -=
          (points[k](2, KeypointOf(finger, 3)) - points[k](2, KeypointOf(finger, 0))) / length;
      count += 1.0;
    }
  }
  return count > 0.0 ? lowered / count : 0.0;
}

std::size_t CountImplausible(const std::vector<HandPoints>& points,
                             const std::vector<bool>& is_lost, const std::vector<double>& usual) {
  constexpr double kMostDeviation = 0.25;
  std::size_t implausible = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (is_lost[k]) continue;
    bool is_plausible = true;
    for (std::size_t b = 0; b < usual.size(); ++b) {
      const double length = LengthOf(points[k], Bones()[b]);
      is_plausible = is_plausible && std::abs(length - usual[b]) <= kMostDeviation * usual[b];
    }
    implausible += is_plausible ? 0 : 1;
  }
  return implausible;
}

/// Angle of `from` to `to`, both of any length.
double AngleBetween(const Vector3d& from, const Vector3d& to) {
  return std::atan2(from.cross(to).norm(), from.dot(to));
}

/// Values of frames in which they are not known: those of the last frame in which they are, at the
/// beginning those of the first. 0 if they are never known.
void Hold(std::vector<double>& values, const std::vector<bool>& is_lost) {
  const auto known =
      std::ranges::find_if(values, [](double value) { return std::isfinite(value); });
  double last = known == values.end() ? 0.0 : *known;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (is_lost[k]) continue;
    if (std::isfinite(values[k])) last = values[k];
    values[k] = last;
  }
}

Vector3d BoneOf(const HandPoints& points, int digit, int joint) {
  return (points.col(KeypointOf(digit, joint + 1)) - points.col(KeypointOf(digit, joint)))
      .normalized();
}

/// Spread [rad] of a finger per frame; held where the finger points out of the palm.
std::vector<double> Spread(const PlacedHand& hand, int finger) {
  const double least = std::cos(70.0 * kRadPerDeg);
  std::vector<double> spread_rad(hand.points_m.size(), kMissing);
  for (std::size_t k = 0; k < spread_rad.size(); ++k) {
    if (hand.is_lost[k]) continue;
    const Vector3d d1 = BoneOf(hand.points_m[k], finger, 0);
    if (d1.head<2>().norm() < least) continue;
    const double side = d1.x() < 0.0 ? -1.0 : 1.0;
    spread_rad[k] = std::atan2(side * d1.y(), side * d1.x());
  }
  Hold(spread_rad, hand.is_lost);
  return spread_rad;
}

/// Angles [rad] of one digit, frames x joints, and of the residual its square and its points.
struct DigitAngles {
  Eigen::MatrixX3d angle_rad;
  double residual_m2 = 0.0;
  double points = 0.0;
};

DigitAngles AnglesOfFinger(const PlacedHand& hand, int finger,
                           const std::vector<double>& spread_rad,
                           const std::vector<double>& usual_m) {
  const std::size_t first_bone = static_cast<std::size_t>(kJointsOfDigit * finger) + 1;
  DigitAngles angles{.angle_rad = Eigen::MatrixX3d::Constant(std::ssize(spread_rad), 3, kMissing)};
  for (std::size_t k = 0; k < spread_rad.size(); ++k) {
    if (hand.is_lost[k]) continue;
    const HandPoints& points = hand.points_m[k];
    const Vector3d d1 = BoneOf(points, finger, 0);
    const Vector3d d2 = BoneOf(points, finger, 1);
    const Vector3d d3 = BoneOf(points, finger, 2);
    const double a = spread_rad[k];
    const Vector3d u(std::cos(a), std::sin(a), 0.0);
    const Vector3d h(-std::sin(a), std::cos(a), 0.0);
    const double pip = std::atan2(d1.cross(d2).dot(h), d1.dot(d2));
    const double dip = std::atan2(d2.cross(d3).dot(h), d2.dot(d3));
    angles.angle_rad.row(static_cast<Eigen::Index>(k)) << std::atan2(-d1.z(), d1.dot(u)), pip, dip;
    Vector3d along = d1;
    Vector3d place = points.col(KeypointOf(finger, 0));
    const std::array<double, 3> bends = {0.0, pip, dip};
    for (std::size_t joint = 0; joint < bends.size(); ++joint) {
      along = Eigen::AngleAxisd(bends[joint], h) * along;
      place += usual_m[first_bone + joint] * along;
      const int keypoint = KeypointOf(finger, static_cast<int>(joint) + 1);
      angles.residual_m2 += (place - points.col(keypoint)).squaredNorm();
      angles.points += 1.0;
    }
  }
  return angles;
}

/// Axes that turn with the rotation of the thumb: along its metacarpal, and its hinge in the model.
Eigen::Matrix3d AxesOfThumb(const Vector3d& t, double rotation_rad) {
  const Vector3d model(0.0, -std::sin(rotation_rad), -std::cos(rotation_rad));
  const Vector3d hinge = (model - model.dot(t) * t).normalized();
  Eigen::Matrix3d axes;
  axes << t, hinge.cross(t), hinge;
  return axes;
}

/// Rotation, abduction, MCP and IP of the thumb [rad], frames x 4.
Eigen::MatrixX4d AnglesOfThumb(const PlacedHand& hand) {
  const double least = std::sin(10.0 * kRadPerDeg);
  const std::size_t frames = hand.points_m.size();
  std::vector<double> rotation_rad(frames, kMissing);
  for (std::size_t k = 0; k < frames; ++k) {
    if (hand.is_lost[k]) continue;
    const Vector3d t = BoneOf(hand.points_m[k], kThumb, 0);
    if (std::hypot(t.y(), t.z()) >= least) rotation_rad[k] = std::atan2(-t.z(), t.y());
  }
  Hold(rotation_rad, hand.is_lost);
  Eigen::MatrixX4d angle_rad = Eigen::MatrixX4d::Constant(std::ssize(rotation_rad), 4, kMissing);
  Eigen::MatrixX3d of_mcp(angle_rad.rows(), 3);  // axes of rotation, in those of the thumb
  Eigen::MatrixX3d of_ip(angle_rad.rows(), 3);
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 0; k < frames; ++k) {
    if (hand.is_lost[k]) continue;
    const auto row = static_cast<Eigen::Index>(k);
    const Vector3d t = BoneOf(hand.points_m[k], kThumb, 0);
    const Vector3d proximal = BoneOf(hand.points_m[k], kThumb, 1);
    const Vector3d distal = BoneOf(hand.points_m[k], kThumb, 2);
    const Eigen::Matrix3d axes = AxesOfThumb(t, rotation_rad[k]);
    of_mcp.row(row) = t.cross(proximal).transpose() * axes;
    of_ip.row(row) = proximal.cross(distal).transpose() * axes;
    sum += (of_mcp.row(row) + of_ip.row(row)).transpose();
    angle_rad.row(row) << rotation_rad[k], std::acos(std::clamp(t.x(), -1.0, 1.0)),
        AngleBetween(t, proximal), AngleBetween(proximal, distal);
  }
  constexpr double kLeastBend = 0.1;  // mean sine; less does not show the hinge
  sum.x() = 0.0;
  const bool is_known =
      sum.norm() > kLeastBend * static_cast<double>(frames - hand.lost) && sum.z() > 0.0;
  const Vector3d hinge = is_known ? Vector3d(sum.normalized()) : Vector3d::UnitZ();
  for (Eigen::Index row = 0; row < angle_rad.rows(); ++row) {
    if (hand.is_lost[static_cast<std::size_t>(row)]) continue;
    if (of_mcp.row(row).dot(hinge) < 0.0) angle_rad(row, 2) *= -1.0;
    if (of_ip.row(row).dot(hinge) < 0.0) angle_rad(row, 3) *= -1.0;
  }
  return angle_rad;
}

}  // namespace

void MarkRepeats(const std::function<bool(std::size_t)>& has_same, std::vector<bool>& is_lost) {
  constexpr std::size_t kMostRepeats = 5;  // a slow tracker that is polled repeats some
  std::size_t first = 0;                   // of equal frames
  for (std::size_t k = 1; k < is_lost.size(); ++k) {
    if (!has_same(k)) first = k;
    if (k - first < kMostRepeats) continue;
    for (std::size_t i = k - first > kMostRepeats ? k : first + 1; i <= k; ++i) is_lost[i] = true;
  }
}

PlacedHand PlaceHand(std::vector<HandPoints> points, double unit_m) {
  PlacedHand hand;
  hand.is_lost = LostFrames(points);
  hand.lost = static_cast<std::size_t>(std::ranges::count(hand.is_lost, true));
  if (hand.lost == points.size()) throw UserError("no row has all keypoints");
  const double length = MedianLength(points, hand.is_lost);
  if (IsOfImage(points, hand.is_lost, length)) {
    throw UserError(
        "the wrist has no depth: these are landmarks in an image, which have no angles; record "
        "world landmarks [m] (of MediaPipe: hand_world_landmarks in place of hand_landmarks)");
  }
  const std::optional<Unit> unit = UnitOf(length, unit_m);
  if (!unit) {
    throw UserError(fmt::format(
        "from the wrist to the tip of the middle finger it is {:.4g}{}, must be from {} to {} m, "
        "cm or mm; landmarks in an image have no such unit",
        length,
        unit_m == 1.0    ? " m"
        : unit_m == 1e-2 ? " cm"
        : unit_m == 1e-3 ? " mm"
                         : "",
        kShortest_m, kLongest_m));
  }
  hand.unit = unit->name;
  hand.length_m = unit->unit_m * length;
  const std::vector<double> usual = UsualLengths(points, hand.is_lost);
  hand.bone_spread = SpreadOfBones(points, hand.is_lost, usual);
  constexpr double kMostSpread = 0.25;
  if (hand.bone_spread > kMostSpread) {
    throw UserError(
        fmt::format("the bones change their lengths by {:.0f} %, must be up to {:g} %: the points "
                    "are landmarks in an image, or have another order",
                    100.0 * hand.bone_spread, 100.0 * kMostSpread));
  }
  hand.implausible = CountImplausible(points, hand.is_lost, usual);
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (hand.is_lost[k]) continue;
    points[k] *= unit->unit_m;
    TurnToHand(points[k]);
    if (points[k].allFinite()) continue;
    hand.is_lost[k] = true;  // the knuckles are in one line with the wrist
    ++hand.lost;
  }
  const double lowered = LoweredShare(points, hand.is_lost);
  constexpr double kLeastBend = 0.05;
  if (!(std::abs(lowered) > kLeastBend)) {
    throw UserError(
        "the fingers never bend, so the side of the palm is unknown; record a fist, too");
  }
  hand.is_left = lowered < 0.0;  // fingers bend towards the palm
  if (hand.is_left) {
    for (HandPoints& frame : points) frame.row(2) *= -1.0;
  }
  hand.points_m = std::move(points);
  return hand;
}

bool LooksLikeHand(const std::vector<HandPoints>& points) {
  constexpr double kMostSpread = 0.10;
  const auto is_within = [](double share, double least, double most) {
    return share >= least && share <= most;
  };
  const std::vector<bool> is_lost = LostFrames(points);
  if (std::ranges::count(is_lost, false) < 2) return false;
  const std::vector<double> usual = UsualLengths(points, is_lost);
  for (int finger = kIndex; finger <= kLittle; ++finger) {
    const double* bones = usual.data() + std::ptrdiff_t{kJointsOfDigit} * finger;
    const double whole = bones[0] + bones[1] + bones[2] + bones[3];
    if (!is_within(bones[0] / whole, 0.35, 0.65) || !is_within(bones[1] / whole, 0.15, 0.35) ||
        !is_within(bones[2] / whole, 0.05, 0.25) || !is_within(bones[3] / whole, 0.05, 0.25)) {
      return false;
    }
  }
  return UnitOf(MedianLength(points, is_lost), 0.0) &&
         SpreadOfBones(points, is_lost, usual) < kMostSpread;
}

KeypointAngles AnglesOf(const PlacedHand& hand) {
  constexpr std::array<std::string_view, 4> kThumbChannels = {"thumb_rotation", "thumb_abduction",
                                                              "thumb_mcp", "thumb_ip"};
  constexpr Eigen::Index kFirstOfFingers = kThumbChannels.size();
  KeypointAngles angles;
  angles.channels.assign(kThumbChannels.begin(), kThumbChannels.end());
  const auto frames = std::ssize(hand.points_m);
  angles.angle_deg = Eigen::MatrixXd::Constant(frames, kFirstOfFingers + 13, kMissing);
  angles.angle_deg.leftCols<kFirstOfFingers>() = AnglesOfThumb(hand);
  double residual_m2 = 0.0, points = 0.0;
  const std::vector<double> usual_m = UsualLengths(hand.points_m, hand.is_lost);
  std::vector<std::vector<double>> spread_rad;
  for (int finger = kIndex; finger <= kLittle; ++finger) {
    const auto place = static_cast<std::size_t>(finger - kIndex);
    spread_rad.push_back(Spread(hand, finger));
    const DigitAngles of = AnglesOfFinger(hand, finger, spread_rad.back(), usual_m);
    angles.angle_deg.middleCols<3>(kFirstOfFingers + 3 * (finger - kIndex)) = of.angle_rad;
    angles.channels.insert(angles.channels.end(), kFingerChannels[place].begin(),
                           kFingerChannels[place].end());
    residual_m2 += of.residual_m2;
    points += of.points;
  }
  angles.channels.emplace_back("finger_spread");
  for (Eigen::Index k = 0; k < frames; ++k) {
    const auto row = static_cast<std::size_t>(k);
    angles.angle_deg(k, angles.angle_deg.cols() - 1) =
        0.5 * (spread_rad.front()[row] - spread_rad.back()[row]);
  }
  angles.angle_deg *= kDegPerRad;
  angles.residual_m = std::sqrt(residual_m2 / points);
  return angles;
}

}  // namespace gauntlet::sim
