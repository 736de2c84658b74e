#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/fit/least_squares.h"
#include "sim/fit/retarget/fingertip_motion.h"
#include "sim/fit/retarget/retargeting.h"
#include "sim/hand/hand_kinematics.h"

namespace gauntlet::sim {

/// The cost of one frame of Retarget() as a least-squares problem. Parameters are the angles of the
/// joints that are moved. Used for one frame after the other.
class FrameProblem : public LeastSquaresProblem {
 public:
  using Digits5 = std::array<bool, HandKinematics::kFingers>;

  /// `moved`: places in hand.joints(). `digits`: those of hand and motion.
  FrameProblem(const FingertipMotion& motion, HandKinematics& hand, const RetargetingConfig& config,
               std::vector<Eigen::Index> moved, const Digits5& digits);

  /// The next frame: its fingertips, the angles before, and how far a joint may go from there.
  void Begin(const FingertipFrame& frame, const Eigen::VectorXd& before, double reach_rad);

  Eigen::VectorXd Residual(const Eigen::VectorXd& parameters) override;
  /// A joint at its limit that the cost pushes beyond it is held: its column is zero.
  Eigen::MatrixXd Derivatives(const Eigen::VectorXd& parameters) override;
  void KeepWithinBounds(Eigen::VectorXd& parameters) const override;

  /// Rows of the problem, in the order in which they are added.
  struct Rows {
    Eigen::VectorXd residual;     // wanted minus the hand's
    Eigen::MatrixXd derivatives;  // of the hand's
  };
  const Rows& RowsAt(const Eigen::VectorXd& parameters, bool derive);

  void SetAngles(const Eigen::VectorXd& parameters);
  /// Distance of a tip from its wanted place at the angles that are set.
  double TipError(int digit) const { return WayToTip(digit).norm(); }
  const HandJoint& joint(Eigen::Index parameter) const { return hand_.joints()[moved_[parameter]]; }
  const std::array<double, HandKinematics::kFingers>& scale() const { return scale_; }
  double pinch_scale() const { return pinch_scale_; }

 private:
  Eigen::Vector3d WayToTip(int digit) const;
  template <class Derivative>
  void Add(double weight, const Eigen::VectorXd& residual, const Derivative& derivative,
           bool derive);
  void AddReach(int digit, bool derive);
  void AddPinch(int digit, bool derive);
  void AddDamping(const Eigen::VectorXd& parameters, bool derive);

  HandKinematics& hand_;
  RetargetingConfig config_;
  std::vector<Eigen::Index> moved_;
  Digits5 digits_;
  std::vector<double> angles_;
  std::array<double, HandKinematics::kFingers> scale_ = {};
  double pinch_scale_ = 1.0;
  const FingertipFrame* frame_ = nullptr;
  Eigen::VectorXd before_, low_, high_;
  std::array<double, HandKinematics::kFingers> blend_ = {};
  Rows rows_;
  std::vector<Digits::Gap> gaps_;
};

}  // namespace gauntlet::sim
