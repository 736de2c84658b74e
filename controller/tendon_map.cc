#include "controller/tendon_map.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace gauntlet::controller {
namespace {

template <class Value>
Eigen::VectorXd ToVector(const std::vector<Value>& values) {
  Eigen::VectorXd vector(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

void CheckShapes(const TendonTransmission& hand) {
  const std::size_t n = hand.reference_angle_rad.size();
  const auto check = [n](const char* key, std::size_t size, std::size_t expected) {
    if (size == expected && n > 0) return;
    throw SettingError(std::string("transmission.") + key,
                       "has " + std::to_string(size) + " values, must have " +
                           std::to_string(expected) + " for " + std::to_string(n) + " channels");
  };
  check("reference_angle_rad", n, n);
  check("coupling", hand.coupling.size(), n * n);
  check("joint_min_rad", hand.joint_min_rad.size(), n);
  check("joint_max_rad", hand.joint_max_rad.size(), n);
  check("counts_per_rad", hand.counts_per_rad.size(), n);
  check("center_counts", hand.center_counts.size(), n);
  check("min_counts", hand.min_counts.size(), n);
  check("max_counts", hand.max_counts.size(), n);
}

std::string NameOf(const std::vector<std::string>& names, std::size_t index) {
  return index < names.size() ? names[index] : std::to_string(index);
}

void CheckValues(const TendonTransmission& hand) {
  for (std::size_t i = 0; i < hand.reference_angle_rad.size(); ++i) {
    const bool finite = std::isfinite(hand.reference_angle_rad[i]) &&
                        std::isfinite(hand.joint_min_rad[i]) &&
                        std::isfinite(hand.joint_max_rad[i]);
    if (!finite || !(hand.joint_min_rad[i] <= hand.joint_max_rad[i])) {
      throw SettingError("transmission.joint_min_rad",
                         "channel " + NameOf(hand.channel_names, i) +
                             ": must be finite and at most joint_max_rad");
    }
    if (!std::isfinite(hand.counts_per_rad[i]) || hand.counts_per_rad[i] == 0.0) {
      throw SettingError("transmission.counts_per_rad",
                         "motor " + NameOf(hand.motor_names, i) + ": must be finite and not 0");
    }
    if (hand.center_counts[i] < hand.min_counts[i] || hand.center_counts[i] > hand.max_counts[i]) {
      throw SettingError("transmission.center_counts", "motor " + NameOf(hand.motor_names, i) +
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
  const Eigen::Index n = reference_rad_.size();
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      coupling(hand.coupling.data(), n, n);
  const Eigen::FullPivLU<Eigen::MatrixXd> decomposition(coupling);
  if (!coupling.allFinite() || !decomposition.isInvertible()) {
    throw SettingError("transmission.coupling", "must be finite and have an inverse");
  }
  inverse_ = decomposition.inverse();
  forward_ = coupling_compensation ? Eigen::MatrixXd(coupling)
                                   : Eigen::MatrixXd(coupling.diagonal().asDiagonal());
  joint_.setZero(n);
  spool_.setZero(n);
}

void TendonMap::ToExactMotorCounts(std::span<const double> joint_angle_rad,
                                   std::span<double> motor_counts) noexcept {
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
  std::copy(motor_counts.begin(), motor_counts.end(), spool_.begin());
  SolveJointAngles(joint_angle_rad);
}

void TendonMap::ToJointAngles(std::span<const double> motor_counts,
                              std::span<double> joint_angle_rad) noexcept {
  std::copy(motor_counts.begin(), motor_counts.end(), spool_.begin());
  SolveJointAngles(joint_angle_rad);
}

void TendonMap::SolveJointAngles(std::span<double> joint_angle_rad) noexcept {
  spool_ = (spool_ - center_counts_).cwiseQuotient(counts_per_rad_);
  joint_.noalias() = inverse_ * spool_;
  joint_ += reference_rad_;
  std::copy(joint_.begin(), joint_.end(), joint_angle_rad.begin());
}

}  // namespace gauntlet::controller
