#include "sim/fit/retarget/retargeting.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/fit/least_squares.h"
#include "sim/fit/retarget/frame_problem.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNoLimit_rad = 1e3;

/// All frames as one problem; angles are rows x joints.
class MotionProblem {
 public:
  MotionProblem(FrameProblem& problem, const std::vector<const FingertipFrame*>& frames,
                const std::vector<double>& time_s, double weight, Index joints)
      : problem_(problem), frames_(frames), time_s_(time_s), weight_(weight), joints_(joints) {}

  double Cost(const MatrixXd& angles) {
    double cost = 0.0;
    for (Index k = 0; k < angles.rows(); ++k) {
      BeginFrame(k, angles);
      cost += problem_.Residual(angles.row(k)).squaredNorm();
    }
    for (Index k = 1; k + 1 < angles.rows(); ++k) {
      cost += weight_ * Acceleration(k, angles).squaredNorm();
    }
    return cost;
  }

  /// Normal equations at `angles`: matrix (lower part) and right side, half the falling gradient.
  void Linearise(const MatrixXd& angles) {
    entries_.clear();
    fall_ = VectorXd::Zero(angles.size());
    for (Index k = 0; k < angles.rows(); ++k) {
      BeginFrame(k, angles);
      const FrameProblem::Rows& rows = problem_.RowsAt(angles.row(k), true);
      fall_.segment(k * joints_, joints_) = rows.derivatives.transpose() * rows.residual;
      AddBlock(k, k, rows.derivatives.transpose() * rows.derivatives);
    }
    for (Index k = 1; k + 1 < angles.rows(); ++k) AddAcceleration(k, angles);
  }

  /// The next angles by the damped equations, within bounds.
  MatrixXd Next(const MatrixXd& angles, double damping) {
    constexpr double kHold = 1e9;
    std::vector<Eigen::Triplet<double>> entries = entries_;
    for (Index i = 0; i < fall_.size(); ++i) {
      const HandJoint& joint = problem_.joint(i % joints_);
      const double angle = angles(i / joints_, i % joints_);
      const bool is_held =
          (angle <= joint.min_rad && fall_[i] < 0.0) || (angle >= joint.max_rad && fall_[i] > 0.0);
      entries.emplace_back(i, i, is_held ? kHold : damping);
    }
    Eigen::SparseMatrix<double> matrix(fall_.size(), fall_.size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower,
                               Eigen::NaturalOrdering<int>>
        factor(matrix);
    const VectorXd step = factor.solve(fall_);
    MatrixXd next = angles;
    for (Index i = 0; i < step.size(); ++i) {
      const HandJoint& joint = problem_.joint(i % joints_);
      double& angle = next(i / joints_, i % joints_);
      angle = std::clamp(angle + step[i], joint.min_rad, joint.max_rad);
    }
    return next;
  }

 private:
  void BeginFrame(Index k, const MatrixXd& angles) {
    problem_.Begin(*frames_[static_cast<std::size_t>(k)], angles.row(k), kNoLimit_rad);
  }

  /// q''_k = sum of c_i q_(k-1+i).
  std::array<double, 3> Coefficients(Index k) const {
    const double before_s = time_s_[k] - time_s_[k - 1];
    const double after_s = time_s_[k + 1] - time_s_[k];
    const double first = 2.0 / (before_s * (before_s + after_s));
    const double last = 2.0 / (after_s * (before_s + after_s));
    return {first, -first - last, last};
  }

  Eigen::RowVectorXd Acceleration(Index k, const MatrixXd& angles) const {
    const auto c = Coefficients(k);
    return c[0] * angles.row(k - 1) + c[1] * angles.row(k) + c[2] * angles.row(k + 1);
  }

  void AddAcceleration(Index k, const MatrixXd& angles) {
    const auto c = Coefficients(k);
    const VectorXd acceleration = Acceleration(k, angles);
    for (Index i = 0; i < 3; ++i) {
      fall_.segment((k - 1 + i) * joints_, joints_) -= weight_ * c[i] * acceleration;
      for (Index j = 0; j <= i; ++j) {
        for (Index joint = 0; joint < joints_; ++joint) {
          entries_.emplace_back((k - 1 + i) * joints_ + joint, (k - 1 + j) * joints_ + joint,
                                weight_ * c[i] * c[j]);
        }
      }
    }
  }

  void AddBlock(Index row, Index column, const MatrixXd& block) {
    for (Index i = 0; i < joints_; ++i) {
      for (Index j = 0; j <= i; ++j) {
        entries_.emplace_back(row * joints_ + i, column * joints_ + j, block(i, j));
      }
    }
  }

  FrameProblem& problem_;
  const std::vector<const FingertipFrame*>& frames_;
  const std::vector<double>& time_s_;
  double weight_;
  Index joints_;
  std::vector<Eigen::Triplet<double>> entries_;
  VectorXd fall_;
};

/// Angles with the least sum of the costs of all frames and of S |q''|^2, q'' the second difference
/// over time, from `angles_rad` to the next minimum.
///
/// Gauss-Newton with Levenberg's damping on all frames at once; the equations are banded, since
/// three neighbouring frames share a term. Bounds hold a joint as in FrameProblem.
/// Shapes: a row per frame, times rise. Units: S in m^2 s^4/rad^2.
MatrixXd SmoothMotion(FrameProblem& problem, const std::vector<const FingertipFrame*>& frames,
                      const std::vector<double>& time_s, double acceleration_weight,
                      MatrixXd angles) {
  constexpr int kMostSteps = 15;
  constexpr double kEnough = 1e-5;  // relative gain of a step
  MotionProblem motion(problem, frames, time_s, acceleration_weight, angles.cols());
  double cost = motion.Cost(angles);
  double damping = 1e-6;
  bool is_new = true;
  for (int step = 0; step < kMostSteps && damping < 1.0; ++step) {
    if (is_new) motion.Linearise(angles);
    MatrixXd next = motion.Next(angles, damping);
    const double next_cost = motion.Cost(next);
    is_new = next_cost < cost;
    if (!is_new) {
      damping *= 10.0;
      continue;
    }
    const bool is_done = cost - next_cost < kEnough * cost;
    angles = std::move(next);
    cost = next_cost;
    damping = std::max(damping / 10.0, 1e-8);
    if (is_done) break;
  }
  return angles;
}

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
