#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "controller/controller_config.h"

namespace gauntlet::controller {

/// From joint angles to integer motor commands through the coupling of the cables, and back.
///
///     d     = clamp(joint_angle_rad, joint_min_rad, joint_max_rad) - reference_angle_rad
///     spool = C d          (without compensation a joint turns only the spool made for it)
///     counts = clamp(round(center_counts + counts_per_rad spool), min_counts, max_counts)
///
/// and back, as far as the spools decide the posture:
///
///     d = C^+ spool                   (C^+: pseudo-inverse; NaN for a joint that springs decide)
///
/// Shapes: C is motors x joints. Units: rad and motor counts.
/// Errors: SettingError for shapes that do not fit, names that appear twice, an empty range, a
/// reference outside it, or a motor that moves nothing.
class TendonMap {
 public:
  TendonMap(const TendonTransmission& hand, bool coupling_compensation);

  int joint_count() const noexcept { return static_cast<int>(reference_rad_.size()); }
  int motor_count() const noexcept { return static_cast<int>(counts_per_rad_.size()); }

  /// The command before rounding, within each motor's range. A value that is not a number gives
  /// the motor's center.
  void ToExactMotorCounts(std::span<const double> joint_angle_rad,
                          std::span<double> motor_counts) noexcept;
  /// The command: rounded to the nearest count, halves away from zero.
  void ToMotorCounts(std::span<const double> joint_angle_rad,
                     std::span<std::int32_t> motor_counts) noexcept;
  /// The posture that the hand takes with these spools when cables neither stretch nor go slack,
  /// with the whole C, compensated or not; NaN for a joint that the spools alone do not decide.
  void ToJointAngles(std::span<const std::int32_t> motor_counts,
                     std::span<double> joint_angle_rad) noexcept;
  void ToJointAngles(std::span<const double> motor_counts,
                     std::span<double> joint_angle_rad) noexcept;

  /// Turn of each joint per count of each motor, joints x motors; rows of NaN as above.
  Eigen::MatrixXd AnglePerCount() const;
  /// Spool angles [rad] of a posture: C d, not clamped.
  void ToSpoolAngles(std::span<const double> joint_angle_rad,
                     std::span<double> spool_angle_rad) noexcept;

  /// Turn of each spool that is commanded per turn of each joint, motors x joints.
  const Eigen::MatrixXd& spool_per_joint() const noexcept { return forward_; }
  std::span<const double> joint_min_rad() const noexcept { return AsSpan(joint_min_rad_); }
  std::span<const double> joint_max_rad() const noexcept { return AsSpan(joint_max_rad_); }
  std::span<const double> reference_angle_rad() const noexcept { return AsSpan(reference_rad_); }

 private:
  static std::span<const double> AsSpan(const Eigen::VectorXd& values) {
    return {values.data(), static_cast<std::size_t>(values.size())};
  }
  void SolveJointAngles(std::span<double> joint_angle_rad) noexcept;

  Eigen::MatrixXd coupling_;  // C
  Eigen::MatrixXd forward_;   // C, or without what cables do in passing
  Eigen::MatrixXd inverse_;   // of the whole C, as far as there is one
  Eigen::VectorXd reference_rad_;
  Eigen::VectorXd joint_min_rad_;
  Eigen::VectorXd joint_max_rad_;
  Eigen::VectorXd counts_per_rad_;
  Eigen::VectorXd center_counts_;
  Eigen::VectorXd min_counts_;
  Eigen::VectorXd max_counts_;
  Eigen::VectorXd joint_;  // scratch
  Eigen::VectorXd spool_;  // scratch
};

}  // namespace gauntlet::controller
