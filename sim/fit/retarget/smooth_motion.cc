#include "sim/fit/retarget/smooth_motion.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <utility>

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

}  // namespace

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

}  // namespace gauntlet::sim
