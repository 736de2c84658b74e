#include "sim/fit/retarget/frame_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kFrameDigits = HandKinematics::kFingers;
constexpr int kFrameThumb = HandKinematics::kThumb;

}  // namespace

double WantedGap(double gap_m, double scale, double clearance_m) {
  return std::max(gap_m + (scale - 1.0) * std::max(gap_m - kContactGap_m, 0.0), clearance_m);
}

FrameProblem::FrameProblem(const FingertipMotion& motion, HandKinematics& hand,
                           const RetargetingConfig& config, std::vector<Index> moved,
                           const Digits5& digits)
    : hand_(hand),
      config_(config),
      moved_(std::move(moved)),
      digits_(digits),
      angles_(hand.NeutralAngles()) {
  double own = 0.0;
  double recorded = 0.0;
  for (int digit = 0; digit < kFrameDigits; ++digit) {
    if (!digits_[digit]) continue;
    scale_[digit] = hand.digits()[digit].length_m / motion.length_m[digit];
    own += hand.digits()[digit].length_m;
    recorded += motion.length_m[digit];
  }
  pinch_scale_ = own / recorded;
}

void FrameProblem::Begin(const FingertipFrame& frame, const VectorXd& before, double reach_rad) {
  frame_ = &frame;
  before_ = before;
  low_.resize(before.size());
  high_.resize(before.size());
  for (Index i = 0; i < before.size(); ++i) {
    const HandJoint& joint = hand_.joints()[moved_[i]];
    low_[i] = std::max(joint.min_rad, std::min(before[i] - reach_rad, joint.max_rad));
    high_[i] = std::min(joint.max_rad, std::max(before[i] + reach_rad, joint.min_rad));
  }
  blend_.fill(0.0);
  for (int digit = kFrameThumb + 1; digit < kFrameDigits; ++digit) {
    if (!digits_[digit] || !digits_[kFrameThumb]) continue;
    const double share =
        (config_.pinch_far_m - frame.gap_m[digit]) / (config_.pinch_far_m - config_.pinch_near_m);
    blend_[digit] = std::clamp(share, 0.0, 1.0) * config_.pinch_most;
    blend_[kFrameThumb] = std::max(blend_[kFrameThumb], blend_[digit]);
  }
}

VectorXd FrameProblem::Residual(const VectorXd& parameters) {
  return RowsAt(parameters, false).residual;
}

MatrixXd FrameProblem::Derivatives(const VectorXd& parameters) {
  Rows rows = RowsAt(parameters, true);
  const VectorXd push = rows.derivatives.transpose() * rows.residual;
  for (Index i = 0; i < push.size(); ++i) {
    const bool is_held =
        (parameters[i] <= low_[i] && push[i] < 0.0) || (parameters[i] >= high_[i] && push[i] > 0.0);
    if (is_held) rows.derivatives.col(i).setZero();
  }
  return rows.derivatives;
}

void FrameProblem::KeepWithinBounds(VectorXd& parameters) const {
  parameters = parameters.cwiseMax(low_).cwiseMin(high_);
}

void FrameProblem::SetAngles(const VectorXd& parameters) {
  for (Index i = 0; i < parameters.size(); ++i) angles_[moved_[i]] = parameters[i];
  hand_.SetAngles(angles_);
}

Vector3d FrameProblem::WayToTip(int digit) const {
  return hand_.digits()[digit].base_m + scale_[digit] * frame_->reach_m[digit] - hand_.Tip(digit);
}

template <class Derivative>
void FrameProblem::Add(double weight, const VectorXd& residual, const Derivative& derivative,
                       bool derive) {
  const double root = std::sqrt(weight);
  const Index row = rows_.residual.size();
  rows_.residual.conservativeResize(row + residual.size());
  rows_.residual.tail(residual.size()) = root * residual;
  if (!derive) return;
  const MatrixXd all = derivative();
  rows_.derivatives.conservativeResize(row + residual.size(), std::ssize(moved_));
  rows_.derivatives.bottomRows(residual.size()) = root * all(Eigen::all, moved_);
}

const FrameProblem::Rows& FrameProblem::RowsAt(const VectorXd& parameters, bool derive) {
  rows_.residual.resize(0);
  rows_.derivatives.resize(0, std::ssize(moved_));
  SetAngles(parameters);
  for (int digit = 0; digit < kFrameDigits; ++digit) {
    if (!digits_[digit]) continue;
    AddReach(digit, derive);
    if (digit != kFrameThumb && blend_[digit] > 0.0) AddPinch(digit, derive);
  }
  hand_.FindGaps(config_.clearance_m, gaps_);
  for (const Digits::Gap& gap : gaps_) {
    Add(
        config_.overlap_weight, VectorXd::Constant(1, config_.clearance_m - gap.gap_m),
        [&] { return hand_.GapDerivative(gap); }, derive);
  }
  AddDamping(parameters, derive);
  return rows_;
}

void FrameProblem::AddReach(int digit, bool derive) {
  const double weight = 1.0 - blend_[digit];
  Add(
      weight, WayToTip(digit), [&] { return hand_.TipDerivative(digit); }, derive);
  Add(
      weight * config_.direction_length_m * config_.direction_length_m,
      frame_->direction[digit] - hand_.TipDirection(digit),
      [&] { return hand_.TipDirectionDerivative(digit); }, derive);
}

void FrameProblem::AddPinch(int digit, bool derive) {
  const Vector3d from_thumb = hand_.Tip(digit) - hand_.Tip(kFrameThumb);
  const auto apart = [&]() -> Eigen::Matrix3Xd {
    return hand_.TipDerivative(digit) - hand_.TipDerivative(kFrameThumb);
  };
  Add(blend_[digit], pinch_scale_ * frame_->from_thumb_m[digit] - from_thumb, apart, derive);
  const double wanted_m = WantedGap(frame_->gap_m[digit], pinch_scale_, config_.clearance_m);
  const double weight = blend_[digit] * config_.pinch_weight;
  if (const auto gap = hand_.PinchGap(digit)) {
    Add(
        weight, VectorXd::Constant(1, wanted_m - gap->gap_m),
        [&] { return hand_.GapDerivative(*gap); }, derive);
    return;
  }
  const double touch_m = frame_->from_thumb_m[digit].norm() - frame_->gap_m[digit];
  Add(
      weight, VectorXd::Constant(1, wanted_m + touch_m - from_thumb.norm()),
      [&]() -> Eigen::RowVectorXd { return from_thumb.normalized().transpose() * apart(); },
      derive);
}

void FrameProblem::AddDamping(const VectorXd& parameters, bool derive) {
  const Index count = parameters.size();
  const Index row = rows_.residual.size();
  const double root = std::sqrt(config_.damping_m2);
  rows_.residual.conservativeResize(row + count);
  rows_.residual.tail(count) = root * (before_ - parameters);
  if (!derive) return;
  rows_.derivatives.conservativeResize(row + count, count);
  rows_.derivatives.bottomRows(count) = root * MatrixXd::Identity(count, count);
}

}  // namespace gauntlet::sim
