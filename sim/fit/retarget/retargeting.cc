#include "sim/fit/retarget/retargeting.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/fit/least_squares.h"
#include "sim/fit/retarget/frame_problem.h"
#include "sim/fit/retarget/smooth_motion.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDigitCount = HandKinematics::kFingers;
constexpr int kThumbDigit = HandKinematics::kThumb;

/// The best of the minima from many postures, `rest` one of them.
LeastSquaresFit FromManyPostures(FrameProblem& problem, const FingertipFrame& frame,
                                 const HandKinematics& hand, const std::vector<Index>& moved,
                                 const VectorXd& rest) {
  constexpr int kPostures = 100;
  constexpr double kAnywhere = 1e3;
  RandomStream random(1, "retargeting");
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

/// Joints that move some of the digits.
std::vector<Index> MovedJointsOf(const HandKinematics& hand,
                                 const std::array<bool, kDigitCount>& digits) {
  std::vector<Index> moved;
  for (std::size_t joint = 0; joint < hand.joints().size(); ++joint) {
    for (int digit = 0; digit < kDigitCount; ++digit) {
      if (!digits[digit] || !hand.Moves(joint, digit)) continue;
      moved.push_back(static_cast<Index>(joint));
      break;
    }
  }
  return moved;
}

/// Holds back joints that move faster than allowed; returns the frames with one.
std::size_t LimitSpeed(const std::vector<double>& time_s, double most_speed_rad_s,
                       MatrixXd& angle_rad) {
  std::size_t limited = 0;
  for (Index k = 1; k < angle_rad.rows(); ++k) {
    const double reach_rad = most_speed_rad_s * (time_s[k] - time_s[k - 1]);
    const auto before = angle_rad.row(k - 1).array();
    const Eigen::RowVectorXd wanted = angle_rad.row(k);
    angle_rad.row(k) = wanted.array().max(before - reach_rad).min(before + reach_rad);
    limited += angle_rad.row(k) != wanted ? 1 : 0;
  }
  return limited;
}

/// Angles frame by frame, each from the frame before. The first one, and any after a long time,
/// from many postures.
MatrixXd FollowFrames(FrameProblem& problem, const std::vector<const FingertipFrame*>& frames,
                      const std::vector<double>& time_s, const RetargetingConfig& config,
                      const HandKinematics& hand, const std::vector<Index>& moved) {
  constexpr double kLongTime_s = 1.0;
  const std::vector<double> neutral = hand.NeutralAngles();
  VectorXd angles(std::ssize(moved));
  for (Index i = 0; i < angles.size(); ++i) angles[i] = neutral[moved[i]];
  MatrixXd all(std::ssize(frames), angles.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const double step_s = k > 0 ? time_s[k] - time_s[k - 1] : 0.0;
    if (k == 0 || step_s > kLongTime_s) {
      angles = FromManyPostures(problem, *frames[k], hand, moved, angles).parameters;
    } else {
      problem.Begin(*frames[k], angles, config.most_speed_rad_s * step_s);
      angles = Minimise(problem, angles).parameters;
    }
    all.row(static_cast<Index>(k)) = angles;
  }
  return all;
}

/// Looks at the hand at the angles of a frame.
void Measure(FrameProblem& problem, const FingertipFrame& frame, const VectorXd& angles,
             const HandKinematics& hand, const std::array<bool, kDigitCount>& digits,
             RetargetedMotion& result) {
  problem.Begin(frame, angles, 0.0);
  result.cost_m2.push_back(problem.Residual(angles).squaredNorm());
  for (int digit = 0; digit < kDigitCount; ++digit) {
    if (!digits[digit]) continue;
    result.tip_error_m[digit].push_back(problem.TipError(digit));
    if (digit == kThumbDigit || !digits[kThumbDigit]) continue;
    if (frame.gap_m[digit] > kContactGap_m) continue;
    const double touch_m = frame.from_thumb_m[digit].norm() - frame.gap_m[digit];
    result.pinch_gap_m[digit].push_back(GapOfPinch(hand, digit, touch_m));
  }
  result.overlap_m.push_back(hand.Overlap());
  for (Index i = 0; i < angles.size(); ++i) {
    const HandJoint& joint = problem.joint(i);
    if (angles[i] <= joint.min_rad || angles[i] >= joint.max_rad) result.share_at_limit[i] += 1.0;
  }
}

}  // namespace

RetargetedMotion Retarget(const FingertipMotion& motion, HandKinematics& hand,
                          const RetargetingConfig& config) {
  const std::array<bool, kDigitCount> digits = CommonDigits(motion, hand);
  const std::vector<Index> moved = MovedJointsOf(hand, digits);
  std::vector<const FingertipFrame*> frames;
  std::vector<double> time_s;
  std::vector<Index> rows;
  for (std::size_t k = 0; k < motion.frames.size(); ++k) {
    if (motion.is_missing[k]) continue;
    frames.push_back(&motion.frames[k]);
    time_s.push_back(motion.time_s[k]);
    rows.push_back(static_cast<Index>(k));
  }
  if (frames.empty()) {
    throw UserError({.place = motion.file, .problem = "every row has a missing value"});
  }
  FrameProblem problem(motion, hand, config, moved, digits);
  RetargetedMotion result;
  result.frames = frames.size();
  result.scale = problem.scale();
  result.pinch_scale = problem.pinch_scale();
  for (const Index joint : moved) result.joints.push_back(hand.joints()[joint].name);
  MatrixXd angle_rad = FollowFrames(problem, frames, time_s, config, hand, moved);
  angle_rad = SmoothMotion(problem, frames, time_s, config.acceleration_weight, angle_rad);
  result.frames_at_most_speed = LimitSpeed(time_s, config.most_speed_rad_s, angle_rad);
  result.share_at_limit.assign(moved.size(), 0.0);
  result.angle_rad.setConstant(std::ssize(motion.frames), std::ssize(moved), kNaN);
  for (Index k = 0; k < angle_rad.rows(); ++k) {
    Measure(problem, *frames[k], angle_rad.row(k), hand, digits, result);
    result.angle_rad.row(rows[k]) = angle_rad.row(k);
    if (k == 0) continue;
    const double most_rad = (angle_rad.row(k) - angle_rad.row(k - 1)).cwiseAbs().maxCoeff();
    result.fastest_rad_s = std::max(result.fastest_rad_s, most_rad / (time_s[k] - time_s[k - 1]));
  }
  for (double& share : result.share_at_limit) share /= static_cast<double>(result.frames);
  return result;
}

}  // namespace gauntlet::sim
