#include "controller/tendon_map.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "controller/assert.h"
#include "controller/linear_algebra.h"
#include "controller/number.h"

namespace gauntlet::controller {
namespace {

template <class Value>
Eigen::VectorXd ToVector(const std::vector<Value>& values) {
  Eigen::VectorXd vector(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

void CheckShapes(const TendonTransmission& hand) {
  const std::size_t joints = hand.reference_angle_rad.size();
  const std::size_t motors = hand.counts_per_rad.size();
  const auto check = [&](const char* key, std::size_t size, std::size_t expected) {
    if (size == expected) return;
    throw SettingError(std::string("transmission.") + key,
                       "has " + std::to_string(size) + " values, must have " +
                           std::to_string(expected) + " for " + std::to_string(joints) +
                           " joints and " + std::to_string(motors) + " motors");
  };
  if (joints == 0 || motors == 0) {
    throw SettingError(joints == 0 ? "transmission.joint_names" : "transmission.motor_names",
                       "is empty, must name at least one");
  }
  check("joint_names", hand.joint_names.size(), joints);
  check("motor_names", hand.motor_names.size(), motors);
  check("coupling", hand.coupling.size(), motors * joints);
  check("joint_min_rad", hand.joint_min_rad.size(), joints);
  check("joint_max_rad", hand.joint_max_rad.size(), joints);
  check("center_counts", hand.center_counts.size(), motors);
  check("min_counts", hand.min_counts.size(), motors);
  check("max_counts", hand.max_counts.size(), motors);
  if (!hand.motor_of_joint.empty()) {
    check("motor_of_joint", hand.motor_of_joint.size(), joints);
  } else if (joints != motors) {
    throw SettingError("transmission.motor_of_joint", "is missing: there are " +
                                                          std::to_string(joints) + " joints and " +
                                                          std::to_string(motors) + " motors");
  }
}

void CheckValues(const TendonTransmission& hand) {
  CheckNames("transmission.joint_names", hand.joint_names);
  CheckNames("transmission.motor_names", hand.motor_names);
  for (std::size_t i = 0; i < hand.joint_names.size(); ++i) {
    const bool finite = std::isfinite(hand.reference_angle_rad[i]) &&
                        std::isfinite(hand.joint_min_rad[i]) &&
                        std::isfinite(hand.joint_max_rad[i]);
    if (!finite || !(hand.joint_min_rad[i] <= hand.joint_max_rad[i])) {
      throw SettingError(
          "transmission.joint_min_rad",
          "joint " + hand.joint_names[i] + ": must be finite and at most joint_max_rad");
    }
    constexpr double kRounding = 1e-9;  // of degrees to radians and back
    if (hand.reference_angle_rad[i] < hand.joint_min_rad[i] - kRounding ||
        hand.reference_angle_rad[i] > hand.joint_max_rad[i] + kRounding) {
      throw SettingError(
          "transmission.reference_angle_rad",
          "joint " + hand.joint_names[i] + ": is " + NumberText(hand.reference_angle_rad[i]) +
              ", must be within the joint's range, " + NumberText(hand.joint_min_rad[i]) + " to " +
              NumberText(hand.joint_max_rad[i]));
    }
  }
  for (std::size_t i = 0; i < hand.motor_names.size(); ++i) {
    const double per_rad = std::abs(hand.counts_per_rad[i]);
    if (!(per_rad >= 1e-9 && per_rad <= 1e9)) {
      throw SettingError("transmission.counts_per_rad",
                         "motor " + hand.motor_names[i] + ": is " +
                             NumberText(hand.counts_per_rad[i]) +
                             ", must be from 1e-09 to 1e+09, or as much below 0");
    }
    if (hand.center_counts[i] < hand.min_counts[i] || hand.center_counts[i] > hand.max_counts[i]) {
      throw SettingError("transmission.center_counts", "motor " + hand.motor_names[i] +
                                                           ": must be from min_counts to "
                                                           "max_counts");
    }
  }
}

/// Like std::clamp, but a value that is not a number becomes `otherwise`.
double ClampOr(double value, double low, double high, double otherwise) {
  if (value >= low) return value <= high ? value : high;
  return value < low ? low : otherwise;
}

/// Motors x joints: 1 if a motor's cables are meant to move a joint, not only to pass it; else 0.
Eigen::MatrixXd MeantToMove(const TendonTransmission& hand) {
  const auto motors = static_cast<Eigen::Index>(hand.motor_names.size());
  const auto joints = static_cast<Eigen::Index>(hand.joint_names.size());
  if (hand.motor_of_joint.empty()) return Eigen::MatrixXd::Identity(motors, joints);
  Eigen::MatrixXd meant = Eigen::MatrixXd::Zero(motors, joints);
  for (Eigen::Index joint = 0; joint < joints; ++joint) {
    const std::string& motor = hand.motor_of_joint[static_cast<std::size_t>(joint)];
    if (motor.empty()) {
      meant.col(joint).setOnes();
      continue;
    }
    const auto found = std::find(hand.motor_names.begin(), hand.motor_names.end(), motor);
    if (found == hand.motor_names.end()) {
      throw SettingError("transmission.motor_of_joint", motor + " is not a motor of the hand");
    }
    meant(found - hand.motor_names.begin(), joint) = 1.0;
  }
  return meant;
}

/// C^+, with rows of NaN for the joints whose angle the spools do not decide. Joints and spools are
/// of one order of size, so that plain tolerances do.
Eigen::MatrixXd InverseOfCoupling(const Eigen::MatrixXd& coupling) {
  constexpr double kTolerance = 1e-9;
  if (coupling.rows() == coupling.cols()) {
    if (auto inverse = InverseOf(coupling)) return *std::move(inverse);
  }
  Eigen::MatrixXd inverse = PseudoInverseOf(coupling);
  const Eigen::MatrixXd decided = inverse * coupling;  // the identity where spools decide
  for (Eigen::Index joint = 0; joint < inverse.rows(); ++joint) {
    Eigen::RowVectorXd off = decided.row(joint);
    off[joint] -= 1.0;
    if (!(off.cwiseAbs().maxCoeff() < kTolerance)) {
      inverse.row(joint).setConstant(kNaN);
    }
  }
  return inverse;
}

}  // namespace

TendonMap::TendonMap(const TendonTransmission& hand, bool coupling_compensation) {
  CheckShapes(hand);
  CheckValues(hand);
  reference_rad_ = ToVector(hand.reference_angle_rad);
  joint_min_rad_ = ToVector(hand.joint_min_rad);
  joint_max_rad_ = ToVector(hand.joint_max_rad);
  counts_per_rad_ = ToVector(hand.counts_per_rad);
  center_counts_ = ToVector(hand.center_counts);
  min_counts_ = ToVector(hand.min_counts);
  max_counts_ = ToVector(hand.max_counts);
  const auto motors = counts_per_rad_.size();
  const auto joints = reference_rad_.size();
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      coupling(hand.coupling.data(), motors, joints);
  const Eigen::MatrixXd meant = MeantToMove(hand).cwiseProduct(coupling);
  for (Eigen::Index motor = 0; motor < motors; ++motor) {
    if (coupling.allFinite() && !meant.row(motor).isZero(0.0)) continue;
    throw SettingError("transmission.coupling",
                       "of motor " + hand.motor_names[static_cast<std::size_t>(motor)] +
                           ": must be finite and move a joint that the motor is made for");
  }
  coupling_ = coupling;
  forward_ = coupling_compensation ? coupling_ : meant;
  inverse_ = InverseOfCoupling(coupling_);
  joint_.setZero(joints);
  spool_.setZero(motors);
}

void TendonMap::ToExactMotorCounts(std::span<const double> joint_angle_rad,
                                   std::span<double> motor_counts) noexcept {
  GAUNTLET_ASSERT(std::ssize(joint_angle_rad) == joint_count());
  GAUNTLET_ASSERT(std::ssize(motor_counts) == motor_count());
  for (Eigen::Index i = 0; i < joint_.size(); ++i) {
    const double angle = ClampOr(joint_angle_rad[static_cast<std::size_t>(i)], joint_min_rad_[i],
                                 joint_max_rad_[i], reference_rad_[i]);
    joint_[i] = angle - reference_rad_[i];
  }
  spool_.noalias() = forward_ * joint_;
  for (Eigen::Index i = 0; i < spool_.size(); ++i) {
    motor_counts[static_cast<std::size_t>(i)] =
        ClampOr(center_counts_[i] + counts_per_rad_[i] * spool_[i], min_counts_[i], max_counts_[i],
                center_counts_[i]);
  }
}

void TendonMap::ToMotorCounts(std::span<const double> joint_angle_rad,
                              std::span<std::int32_t> motor_counts) noexcept {
  ToExactMotorCounts(joint_angle_rad, {spool_.data(), motor_counts.size()});
  for (Eigen::Index i = 0; i < spool_.size(); ++i) {
    motor_counts[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(std::round(spool_[i]));
  }
}

void TendonMap::ToJointAngles(std::span<const std::int32_t> motor_counts,
                              std::span<double> joint_angle_rad) noexcept {
  GAUNTLET_ASSERT(std::ssize(motor_counts) == motor_count());
  std::copy(motor_counts.begin(), motor_counts.end(), spool_.begin());
  SolveJointAngles(joint_angle_rad);
}

void TendonMap::ToJointAngles(std::span<const double> motor_counts,
                              std::span<double> joint_angle_rad) noexcept {
  GAUNTLET_ASSERT(std::ssize(motor_counts) == motor_count());
  std::copy(motor_counts.begin(), motor_counts.end(), spool_.begin());
  SolveJointAngles(joint_angle_rad);
}

void TendonMap::SolveJointAngles(std::span<double> joint_angle_rad) noexcept {
  GAUNTLET_ASSERT(std::ssize(joint_angle_rad) == joint_count());
  spool_ = (spool_ - center_counts_).cwiseQuotient(counts_per_rad_);
  joint_.noalias() = inverse_ * spool_;
  joint_ += reference_rad_;
  std::copy(joint_.begin(), joint_.end(), joint_angle_rad.begin());
}

Eigen::MatrixXd TendonMap::AnglePerCount() const {
  return inverse_ * counts_per_rad_.cwiseInverse().asDiagonal();
}

void TendonMap::ToSpoolAngles(std::span<const double> joint_angle_rad,
                              std::span<double> spool_angle_rad) noexcept {
  GAUNTLET_ASSERT(std::ssize(joint_angle_rad) == joint_count());
  GAUNTLET_ASSERT(std::ssize(spool_angle_rad) == motor_count());
  std::copy(joint_angle_rad.begin(), joint_angle_rad.end(), joint_.begin());
  joint_ -= reference_rad_;
  spool_.noalias() = coupling_ * joint_;
  std::copy(spool_.begin(), spool_.end(), spool_angle_rad.begin());
}

}  // namespace gauntlet::controller
