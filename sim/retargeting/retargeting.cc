#include "sim/retargeting/retargeting.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/calibrate/least_squares.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kDigitCount = HandKinematics::kFingers;
constexpr int kThumbDigit = HandKinematics::kThumb;

/// Rows of a least-squares problem, in the order in which they are added.
struct CostRows {
  VectorXd residual;     // wanted minus the hand's
  MatrixXd derivatives;  // of the hand's
};

/// Least squares of one frame. Parameters are the angles of the joints that are moved.
class FrameProblem : public LeastSquaresProblem {
 public:
  FrameProblem(const FingertipMotion& motion, HandKinematics& hand, const RetargetingConfig& config,
               std::vector<Index> moved, std::array<bool, kDigitCount> digits)
      : hand_(hand),
        config_(config),
        moved_(std::move(moved)),
        digits_(digits),
        angles_(hand.NeutralAngles()) {
    double own = 0.0;
    double recorded = 0.0;
    for (int digit = 0; digit < kDigitCount; ++digit) {
      if (!digits_[digit]) continue;
      scale_[digit] = hand.digits()[digit].length_m / motion.length_m[digit];
      own += hand.digits()[digit].length_m;
      recorded += motion.length_m[digit];
    }
    pinch_scale_ = own / recorded;
  }

  /// The next frame: its fingertips, the angles before, and how far a joint may go from there.
  void Begin(const FingertipFrame& frame, const VectorXd& before, double reach_rad) {
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
    for (int digit = kThumbDigit + 1; digit < kDigitCount; ++digit) {
      if (!digits_[digit] || !digits_[kThumbDigit]) continue;
      const double share =
          (config_.pinch_far_m - frame.gap_m[digit]) / (config_.pinch_far_m - config_.pinch_near_m);
      blend_[digit] = std::clamp(share, 0.0, 1.0) * config_.pinch_most;
      blend_[kThumbDigit] = std::max(blend_[kThumbDigit], blend_[digit]);
    }
  }

  VectorXd Residual(const VectorXd& parameters) override {
    return Rows(parameters, false).residual;
  }

  /// A joint at its limit that the cost pushes beyond it is held: its column is zero.
  MatrixXd Derivatives(const VectorXd& parameters) override {
    CostRows rows = Rows(parameters, true);
    const VectorXd push = rows.derivatives.transpose() * rows.residual;
    for (Index i = 0; i < push.size(); ++i) {
      const bool is_held = (parameters[i] <= low_[i] && push[i] < 0.0) ||
                           (parameters[i] >= high_[i] && push[i] > 0.0);
      if (is_held) rows.derivatives.col(i).setZero();
    }
    return rows.derivatives;
  }

  void KeepWithinBounds(VectorXd& parameters) const override {
    parameters = parameters.cwiseMax(low_).cwiseMin(high_);
  }

  void SetAngles(const VectorXd& parameters) {
    for (Index i = 0; i < parameters.size(); ++i) angles_[moved_[i]] = parameters[i];
    hand_.SetAngles(angles_);
  }
  /// Distance of a tip from its wanted place at the angles that are set.
  double TipError(int digit) const { return WayToTip(digit).norm(); }
  bool IsAtSpeedLimit(const VectorXd& parameters) const {
    for (Index i = 0; i < parameters.size(); ++i) {
      const HandJoint& joint = hand_.joints()[moved_[i]];
      const bool low = parameters[i] <= low_[i] && low_[i] > joint.min_rad;
      const bool high = parameters[i] >= high_[i] && high_[i] < joint.max_rad;
      if (low || high) return true;
    }
    return false;
  }
  const std::array<double, kDigitCount>& scale() const { return scale_; }
  double pinch_scale() const { return pinch_scale_; }

 private:
  Vector3d WayToTip(int digit) const {
    return hand_.digits()[digit].base_m + scale_[digit] * frame_->reach_m[digit] - hand_.Tip(digit);
  }

  template <class Derivative>
  void Add(double weight, const VectorXd& residual, const Derivative& derivative, bool derive) {
    const double root = std::sqrt(weight);
    const Index row = rows_.residual.size();
    rows_.residual.conservativeResize(row + residual.size());
    rows_.residual.tail(residual.size()) = root * residual;
    if (!derive) return;
    const MatrixXd all = derivative();
    rows_.derivatives.conservativeResize(row + residual.size(), std::ssize(moved_));
    rows_.derivatives.bottomRows(residual.size()) = root * all(Eigen::all, moved_);
  }

  const CostRows& Rows(const VectorXd& parameters, bool derive) {
    rows_.residual.resize(0);
    rows_.derivatives.resize(0, std::ssize(moved_));
    SetAngles(parameters);
    for (int digit = 0; digit < kDigitCount; ++digit) {
      if (!digits_[digit]) continue;
      AddReach(digit, derive);
      if (digit != kThumbDigit && blend_[digit] > 0.0) AddPinch(digit, derive);
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

  void AddReach(int digit, bool derive) {
    const double weight = 1.0 - blend_[digit];
    Add(
        weight, WayToTip(digit), [&] { return hand_.TipDerivative(digit); }, derive);
    Add(
        weight * config_.direction_length_m * config_.direction_length_m,
        frame_->direction[digit] - hand_.TipDirection(digit),
        [&] { return hand_.TipDirectionDerivative(digit); }, derive);
  }

  void AddPinch(int digit, bool derive) {
    const Vector3d from_thumb = hand_.Tip(digit) - hand_.Tip(kThumbDigit);
    const auto apart = [&]() -> Eigen::Matrix3Xd {
      return hand_.TipDerivative(digit) - hand_.TipDerivative(kThumbDigit);
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

  void AddDamping(const VectorXd& parameters, bool derive) {
    const Index count = parameters.size();
    const Index row = rows_.residual.size();
    const double root = std::sqrt(config_.damping_m2);
    rows_.residual.conservativeResize(row + count);
    rows_.residual.tail(count) = root * (before_ - parameters);
    if (!derive) return;
    rows_.derivatives.conservativeResize(row + count, count);
    rows_.derivatives.bottomRows(count) = root * MatrixXd::Identity(count, count);
  }

  HandKinematics& hand_;
  RetargetingConfig config_;
  std::vector<Index> moved_;
  std::array<bool, kDigitCount> digits_;
  std::vector<double> angles_;
  std::array<double, kDigitCount> scale_ = {};
  double pinch_scale_ = 1.0;
  const FingertipFrame* frame_ = nullptr;
  VectorXd before_, low_, high_;
  std::array<double, kDigitCount> blend_ = {};
  CostRows rows_;
  std::vector<Digits::Gap> gaps_;
};

/// The best of the minima from several postures.
LeastSquaresFit FromManyPostures(FrameProblem& problem, const FingertipFrame& frame,
                                 const HandKinematics& hand, const std::vector<Index>& moved) {
  constexpr int kPostures = 100;
  constexpr double kAnywhere = 1e3;
  RandomStream random(1, "retargeting");
  const std::vector<double> neutral = hand.NeutralAngles();
  VectorXd rest(std::ssize(moved));
  for (Index i = 0; i < rest.size(); ++i) rest[i] = neutral[moved[i]];
  std::optional<LeastSquaresFit> best;
  for (int posture = 0; posture < kPostures; ++posture) {
    VectorXd start = rest;
    for (Index i = 0; i < start.size() && posture > 0; ++i) {
      const HandJoint& joint = hand.joints()[moved[i]];
      start[i] = random.Uniform(joint.min_rad, joint.max_rad);
    }
    problem.Begin(frame, start, kAnywhere);
    const LeastSquaresFit once = Minimise(problem, start);
    problem.Begin(frame, once.parameters, kAnywhere);  // no longer drawn to the start
    LeastSquaresFit fit = Minimise(problem, once.parameters);
    if (!best || fit.squares < best->squares) best = std::move(fit);
  }
  return *best;
}

std::array<bool, kDigitCount> CommonDigits(const FingertipMotion& motion,
                                           const HandKinematics& hand) {
  std::array<bool, kDigitCount> common = {};
  for (int digit = 0; digit < kDigitCount; ++digit) {
    common[digit] = motion.has_digit[digit] && hand.digits()[digit].exists;
  }
  if (std::ranges::none_of(common, std::identity())) {
    throw UserError({.place = motion.file,
                     .problem = fmt::format("{} and {} have no fingertip in common", motion.hand,
                                            hand.file())});
  }
  return common;
}

/// Looks at the hand at the angles that are set.
void Measure(const FrameProblem& problem, const FingertipFrame& frame, const HandKinematics& hand,
             const std::array<bool, kDigitCount>& digits, RetargetedMotion& result) {
  for (int digit = 0; digit < kDigitCount; ++digit) {
    if (!digits[digit]) continue;
    result.tip_error_m[digit].push_back(problem.TipError(digit));
    if (digit == kThumbDigit || !digits[kThumbDigit]) continue;
    if (frame.gap_m[digit] > kContactGap_m) continue;
    const double touch_m = frame.from_thumb_m[digit].norm() - frame.gap_m[digit];
    result.pinch_gap_m[digit].push_back(GapOfPinch(hand, digit, touch_m));
  }
  result.overlap_m.push_back(hand.Overlap());
}

}  // namespace

double WantedGap(double gap_m, double scale, double clearance_m) {
  return std::max(gap_m + (scale - 1.0) * std::max(gap_m - kContactGap_m, 0.0), clearance_m);
}

RetargetedMotion Retarget(const FingertipMotion& motion, HandKinematics& hand,
                          const RetargetingConfig& config) {
  const std::array<bool, kDigitCount> digits = CommonDigits(motion, hand);
  std::vector<Index> moved;
  RetargetedMotion result;
  for (std::size_t joint = 0; joint < hand.joints().size(); ++joint) {
    for (int digit = 0; digit < kDigitCount; ++digit) {
      if (!digits[digit] || !hand.Moves(joint, digit)) continue;
      moved.push_back(static_cast<Index>(joint));
      result.joints.push_back(hand.joints()[joint].name);
      break;
    }
  }
  FrameProblem problem(motion, hand, config, moved, digits);
  result.scale = problem.scale();
  result.pinch_scale = problem.pinch_scale();
  result.angle_rad.setConstant(std::ssize(motion.frames), std::ssize(moved), kNaN);
  result.share_at_limit.assign(moved.size(), 0.0);
  VectorXd before;
  double before_s = 0.0;
  for (std::size_t k = 0; k < motion.frames.size(); ++k) {
    if (motion.is_missing[k]) continue;
    const FingertipFrame& frame = motion.frames[k];
    const double step_s = motion.time_s[k] - before_s;
    LeastSquaresFit fit;
    if (result.frames == 0) {
      fit = FromManyPostures(problem, frame, hand, moved);
    } else {
      problem.Begin(frame, before, config.most_speed_rad_s * step_s);
      fit = Minimise(problem, before);
      result.fastest_rad_s = std::max(result.fastest_rad_s,
                                      (fit.parameters - before).lpNorm<Eigen::Infinity>() / step_s);
      result.frames_at_most_speed += problem.IsAtSpeedLimit(fit.parameters) ? 1 : 0;
    }
    before = fit.parameters;
    before_s = motion.time_s[k];
    ++result.frames;
    result.angle_rad.row(static_cast<Index>(k)) = before.transpose();
    result.cost_m2.push_back(fit.squares);
    problem.SetAngles(before);
    Measure(problem, frame, hand, digits, result);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const HandJoint& joint = hand.joints()[moved[i]];
      const double angle = before[static_cast<Index>(i)];
      if (angle <= joint.min_rad || angle >= joint.max_rad) result.share_at_limit[i] += 1.0;
    }
  }
  if (result.frames == 0) {
    throw UserError({.place = motion.file, .problem = "every row has a missing value"});
  }
  for (double& share : result.share_at_limit) share /= static_cast<double>(result.frames);
  return result;
}

}  // namespace gauntlet::sim
