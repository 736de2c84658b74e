#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/quantile.h"
#include "sim/base/signal.h"
#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Space = RotationColumns::Space;

constexpr int kThumb = 0;
constexpr int kIndex = 1;
constexpr int kLittle = 4;
constexpr int kMetacarpal = 0;
constexpr int kProximal = 1;
constexpr int kMiddle = 2;
constexpr int kDistal = 3;

/// The bones that a file has, as they are read.
class TurnedHand {
 public:
  TurnedHand(const std::vector<HandRotations>& frames, const RotationColumns& columns)
      : frames_(frames), columns_(columns) {}

  bool Has(int bone) const { return columns_.bone[static_cast<std::size_t>(bone)].has_value(); }
  /// True if the parents of all bones are there, so the hand.
  bool HasParents() const { return IsLocal() || Has(0); }
  bool IsLocal() const { return columns_.space == Space::kLocal; }

  /// Rotation relative to the parent.
  Quaterniond Relative(std::size_t frame, int digit, int bone) const {
    Quaterniond r = At(frame, TurnedBone(digit, bone));
    if (!IsLocal()) r = At(frame, ParentOf(digit, bone)).conjugate() * r;
    if (r.w() < 0.0) r.coeffs() *= -1.0;
    return r;
  }

 private:
  Quaterniond At(std::size_t frame, int bone) const {
    const auto values = frames_[frame].col(bone);
    return Quaterniond(values[0], values[1], values[2], values[3]).normalized();
  }
  int ParentOf(int digit, int bone) const {
    if (bone == kMetacarpal) return 0;
    if (bone == kProximal) {
      const int metacarpal = TurnedBone(digit, kMetacarpal);
      return Has(metacarpal) ? metacarpal : 0;
    }
    return TurnedBone(digit, digit == kThumb ? kProximal : bone - 1);
  }

  const std::vector<HandRotations>& frames_;
  const RotationColumns& columns_;
};

Vector3d RotationVector(const Quaterniond& q) {
  const double sine = q.vec().norm();
  if (sine == 0.0) return Vector3d::Zero();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

double Twist(const Quaterniond& q, const Vector3d& axis) {
  return 2.0 * std::atan2(q.vec().dot(axis), q.w());
}

/// The axis about which a digit bends, and the share of its rotation about other axes.
struct Hinge {
  Vector3d axis = Vector3d::UnitX();
  double other_share = 0.0;
  double rms_rad = 0.0;
};

Hinge HingeOf(const TurnedHand& hand, const std::vector<std::size_t>& frames, int digit) {
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  Vector3d sum = Vector3d::Zero();
  const int first = digit == kThumb ? kProximal : kMiddle;
  for (const std::size_t frame : frames) {
    for (const int bone : {first, kDistal}) {
      const Vector3d rho = RotationVector(hand.Relative(frame, digit, bone));
      moment += rho * rho.transpose();
      sum += rho;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment);
  Hinge hinge;
  hinge.axis = solver.eigenvectors().col(2);
  if (hinge.axis.dot(sum) < 0.0) hinge.axis *= -1.0;
  const double whole = moment.trace();
  hinge.other_share = whole > 0.0 ? 1.0 - solver.eigenvalues()[2] / whole : 1.0;
  hinge.rms_rad = std::sqrt(whole / (2.0 * static_cast<double>(frames.size())));
  return hinge;
}

/// Flexion [rad] of one joint over the frames.
std::vector<double> Flexion(const TurnedHand& hand, const std::vector<std::size_t>& frames,
                            const Hinge& hinge, int digit, int bone) {
  std::vector<double> angle_rad;
  for (const std::size_t frame : frames) {
    angle_rad.push_back(Twist(hand.Relative(frame, digit, bone), hinge.axis));
  }
  return angle_rad;
}

/// True if nearly all values are between the two.
bool IsWithin(const std::vector<double>& angle_rad, double low_deg, double high_deg) {
  constexpr double kTail = 0.02;
  return Quantile(angle_rad, kTail) >= low_deg * kRadPerDeg &&
         Quantile(angle_rad, 1.0 - kTail) <= high_deg * kRadPerDeg;
}

double MeanDeg(const std::vector<double>& angle_rad) {
  double sum = 0.0;
  for (const double angle : angle_rad) sum += angle;
  return sum / static_cast<double>(angle_rad.size()) * kDegPerRad;
}

/// True if the fingers bend as those of a hand.
bool IsPlausible(const TurnedHand& hand, const std::vector<std::size_t>& frames) {
  constexpr double kMostOther = 0.1;
  constexpr double kLeastAlike = 0.5;  // cosine between the axes of fingers
  std::optional<Vector3d> first;
  double mcp_deg = 0.0, pip_deg = 0.0, dip_deg = 0.0;
  for (int finger = kIndex; finger <= kLittle; ++finger) {
    const Hinge hinge = HingeOf(hand, frames, finger);
    if (hinge.other_share > kMostOther) return false;
    if (!first) first = hinge.axis;
    if (hinge.axis.dot(*first) < kLeastAlike) return false;
    const auto mcp = Flexion(hand, frames, hinge, finger, kProximal);
    const auto pip = Flexion(hand, frames, hinge, finger, kMiddle);
    const auto dip = Flexion(hand, frames, hinge, finger, kDistal);
    if (!IsWithin(mcp, -75.0, 120.0) || !IsWithin(pip, -40.0, 130.0) ||
        !IsWithin(dip, -40.0, 110.0)) {
      return false;
    }
    mcp_deg += 0.25 * MeanDeg(mcp);
    pip_deg += 0.25 * MeanDeg(pip);
    dip_deg += 0.25 * MeanDeg(dip);
  }
  return mcp_deg > -20.0 && pip_deg > 3.0 && dip_deg > -5.0;
}

bool IsUnit(const HandRotations& frame, Eigen::Index bone, double most) {
  return std::abs(frame.col(bone).norm() - 1.0) <= most;
}

std::vector<bool> FramesWithoutRotations(const std::vector<HandRotations>& frames,
                                         const RotationColumns& columns) {
  constexpr double kMostOff = 0.05;
  std::vector<bool> is_lost(frames.size());
  const auto has_same = [&](std::size_t k) {
    return (frames[k].array() == frames[k - 1].array() || !frames[k].array().isFinite()).all();
  };
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (int bone = 0; bone < kTurnedBones; ++bone) {
      const bool is_there = columns.bone[static_cast<std::size_t>(bone)].has_value();
      is_lost[k] = is_lost[k] || (is_there && !IsUnit(frames[k], bone, kMostOff));
    }
  }
  MarkRepeats(has_same, is_lost);
  return is_lost;
}

/// Errors: UserError without a place if the fingers do not bend as those of a hand.
void CheckBending(const TurnedHand& hand, const std::vector<std::size_t>& measured) {
  constexpr double kLeastBend_rad = 5.0 * kRadPerDeg;
  constexpr std::size_t kMostFrames = 2000;
  std::vector<std::size_t> some;
  const std::size_t step = 1 + (measured.size() - 1) / kMostFrames;
  for (std::size_t i = 0; i < measured.size(); i += step) some.push_back(measured[i]);
  if (!hand.HasParents()) {
    throw UserError("the rotations are relative to the world, and that of the wrist is missing");
  }
  for (int finger = kIndex; finger <= kLittle; ++finger) {
    if (HingeOf(hand, some, finger).rms_rad > kLeastBend_rad) continue;
    throw UserError(
        "the fingers hardly bend, so the direction of flexion is unknown; record a fist, too");
  }
  if (IsPlausible(hand, some)) return;
  throw UserError(fmt::format(
      "the fingers do not bend about one axis each: the rotations are not those of a hand's bones, "
      "or not relative to the {}; write local or world into the names of the columns",
      hand.IsLocal() ? "bone before" : "world"));
}

/// Axes of the bones as OpenXR has them.
struct BoneAxes {
  Vector3d along;    // to the tip
  Vector3d back;     // out of the back of the hand
  Vector3d lateral;  // to the thumb's side
};

/// Direction of the thumb's metacarpal in the frame of the hand.
Vector3d ThumbDirection(const TurnedHand& hand, std::size_t frame, const Vector3d& along) {
  return hand.Relative(frame, kThumb, kMetacarpal) * along;
}

/// None if the names or the axis of bending are not those of OpenXR, or the thumb is on no side.
std::optional<BoneAxes> AxesOf(const TurnedHand& hand, const RotationColumns& columns,
                               const std::vector<std::size_t>& measured, const Hinge& index) {
  constexpr double kLeastAlong = 0.966;  // cosine of 15 deg
  constexpr double kLeastLateral = 0.1;
  if (!columns.has_openxr_names || std::abs(index.axis.x()) < kLeastAlong) return std::nullopt;
  BoneAxes axes;
  axes.along = Vector3d(0.0, 0.0, index.axis.x() > 0.0 ? 1.0 : -1.0);
  axes.back = Vector3d::UnitY();
  axes.lateral = axes.back.cross(axes.along);
  double lateral = 0.0;
  for (const std::size_t frame : measured) {
    lateral += ThumbDirection(hand, frame, axes.along).dot(axes.lateral);
  }
  lateral /= static_cast<double>(measured.size());
  if (std::abs(lateral) < kLeastLateral) return std::nullopt;
  if (lateral < 0.0) axes.lateral *= -1.0;
  return axes;
}

/// Spread [rad] towards the thumb.
double SpreadOf(const Quaterniond& r, const Vector3d& hinge, const BoneAxes& axes) {
  const double half = 0.5 * Twist(r, hinge);
  Quaterniond twist;
  twist.w() = std::cos(half);
  twist.vec() = std::sin(half) * hinge;
  Quaterniond swing = r * twist.conjugate();
  if (swing.w() < 0.0) swing.coeffs() *= -1.0;
  const double side = axes.back.cross(axes.along).dot(axes.lateral);  // about y, along turns to it
  return side * Twist(swing, axes.back);
}

}  // namespace

bool AreUnitQuaternions(const std::vector<HandRotations>& frames) {
  constexpr double kMostOff = 0.02;
  constexpr double kNearlyAll = 0.95;
  double all = 0.0, unit = 0.0;
  for (const HandRotations& frame : frames) {
    for (Eigen::Index bone = 0; bone < frame.cols(); ++bone) {
      const double norm = frame.col(bone).norm();
      if (!(norm > 0.0)) continue;  // lost, or not there
      all += 1.0;
      unit += IsUnit(frame, bone, kMostOff) ? 1.0 : 0.0;
    }
  }
  return all > 0.0 && unit >= kNearlyAll * all;
}

AnglesOfBones AnglesOf(const std::vector<HandRotations>& frames, const KeypointColumns& columns) {
  constexpr std::array<std::string_view, 2> kThumbChannels = {"thumb_mcp", "thumb_ip"};
  RotationColumns rotations = columns.rotations.value();
  const bool is_by_name = rotations.space != Space::kUnknown;
  if (!is_by_name && !rotations.has_openxr_names) {
    throw UserError(
        "has rotations of bones, relative to the bone before or to the world; write local or world "
        "into the names of the columns, as index_proximal_local_qw");
  }
  if (!is_by_name) rotations.space = Space::kWorld;
  AnglesOfBones result;
  result.is_lost = FramesWithoutRotations(frames, rotations);
  std::vector<std::size_t> measured;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!result.is_lost[k]) measured.push_back(k);
  }
  if (measured.empty()) throw UserError("no row has the rotations of all bones");
  const TurnedHand hand(frames, rotations);
  CheckBending(hand, measured);
  std::vector<Hinge> hinges;
  for (int digit = kThumb; digit <= kLittle; ++digit) {
    hinges.push_back(HingeOf(hand, measured, digit));
  }
  const std::optional<BoneAxes> axes = AxesOf(hand, rotations, measured, hinges[kIndex]);

  std::vector<std::vector<double>> columns_rad;
  const auto add = [&](std::string_view channel, std::vector<double> angle_rad) {
    result.angles.channels.push_back(channel);
    columns_rad.push_back(std::move(angle_rad));
  };
  if (axes) {
    std::vector<double> rotation_rad, abduction_rad;
    for (const std::size_t frame : measured) {
      const Vector3d t = ThumbDirection(hand, frame, axes->along);
      rotation_rad.push_back(std::atan2(-t.dot(axes->back), t.dot(axes->lateral)));
      abduction_rad.push_back(std::acos(std::clamp(t.dot(axes->along), -1.0, 1.0)));
    }
    add("thumb_rotation", std::move(rotation_rad));
    add("thumb_abduction", std::move(abduction_rad));
  }
  add(kThumbChannels[0], Flexion(hand, measured, hinges[kThumb], kThumb, kProximal));
  add(kThumbChannels[1], Flexion(hand, measured, hinges[kThumb], kThumb, kDistal));
  for (int finger = kIndex; finger <= kLittle; ++finger) {
    for (const int bone : {kProximal, kMiddle, kDistal}) {
      const auto place = static_cast<std::size_t>(finger);
      add(kFingerChannels[place - 1][static_cast<std::size_t>(bone - 1)],
          Flexion(hand, measured, hinges[place], finger, bone));
    }
  }
  if (axes) {
    std::vector<double> spread_rad;
    for (const std::size_t frame : measured) {
      const double index =
          SpreadOf(hand.Relative(frame, kIndex, kProximal), hinges[kIndex].axis, *axes);
      const double little =
          SpreadOf(hand.Relative(frame, kLittle, kProximal), hinges[kLittle].axis, *axes);
      spread_rad.push_back(0.5 * (index - little));
    }
    add("finger_spread", std::move(spread_rad));
  }
  result.angles.angle_deg =
      Eigen::MatrixXd::Constant(std::ssize(frames), std::ssize(columns_rad), kMissing);
  for (std::size_t c = 0; c < columns_rad.size(); ++c) {
    for (std::size_t i = 0; i < measured.size(); ++i) {
      result.angles.angle_deg(static_cast<Eigen::Index>(measured[i]),
                              static_cast<Eigen::Index>(c)) = kDegPerRad * columns_rad[c][i];
    }
  }
  double other_share = 0.0;
  for (const Hinge& hinge : hinges) other_share = std::max(other_share, hinge.other_share);
  const Vector3d& axis = hinges[kIndex].axis;
  const double lost = static_cast<double>(frames.size() - measured.size());
  const std::string of = columns.hand.empty() ? "" : columns.hand + " hand: ";
  result.remarks.push_back(fmt::format(
      "rotations of the bones of a{} hand, {}, relative to the {} ({}); {:.2g} % of the frames "
      "lost",
      columns.hand.empty() ? "" : " " + columns.hand, columns.skeleton,
      hand.IsLocal() ? "bone before" : "world", is_by_name ? "by the names" : "as OpenXR has them",
      100.0 * lost / static_cast<double>(frames.size())));
  result.remarks.push_back(fmt::format(
      "{}fingers bend about ({:.2f}, {:.2f}, {:.2f}), digits rotate up to {:.1f} % about other "
      "axes; {}",
      of, axis.x(), axis.y(), axis.z(), 100.0 * std::sqrt(other_share),
      axes ? "axes of OpenXR, by the names"
           : "the axes along the bones are unknown, so finger_spread, thumb_rotation and "
             "thumb_abduction are left out"));
  return result;
}

}  // namespace gauntlet::sim
