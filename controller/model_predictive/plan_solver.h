#pragma once

#include <Eigen/Core>
#include <array>

namespace gauntlet::controller {

/// The longest plan, in commands.
inline constexpr int kMostPlanSteps = 16;

/// A value for each command of a plan, and for each of its limits.
using PlanVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostPlanSteps, 1>;
using PlanMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostPlanSteps, kMostPlanSteps>;
using PlanLimits = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * kMostPlanSteps - 1, 1>;

/// The plan of n commands u that costs least, under limits of each and of each change:
///
///     min 1/2 u' H u - g' u,   low <= A u <= high,   A u = (u_1 .. u_n, u_2 - u_1 .. u_n - u_n-1)
///
/// The dual active-set method: from the plan without limits, or from the limits that bound the last
/// plan (shifted by one command), the limit that is missed most is added until none is. It ends
/// exactly at the solution, in few iterations; without a limit in the way in none. All that depends
/// on H alone is computed by the constructor.
///
/// Source: Goldfarb, Idnani, A numerically stable dual method for solving strictly convex quadratic
/// programs, Mathematical Programming 27, 1-33 (1983).
/// Shapes: n commands, 2 n - 1 limits. H is symmetric and positive definite.
class PlanSolver {
 public:
  explicit PlanSolver(const Eigen::MatrixXd& hessian);

  int step_count() const noexcept { return static_cast<int>(inverse_.rows()); }
  int limit_count() const noexcept { return 2 * step_count() - 1; }

  /// True if `plan` is the solution now. It is left as it was if no plan keeps all limits, or none
  /// was found by adding and dropping limits `most_iterations` times. Does not allocate.
  bool Solve(const PlanVector& g, const PlanLimits& low, const PlanLimits& high,
             int most_iterations, PlanVector& plan) noexcept;
  /// Number of iterations of the last call.
  int iterations() const noexcept { return iterations_; }
  /// The next call starts without limits.
  void Reset() noexcept { active_count_ = 0; }

 private:
  struct Active {
    int limit = 0;
    double side = 1.0;  // 1: the high one bounds, -1: the low one
    double multiplier = 0.0;
  };

  int Index(int i) const noexcept { return active_[static_cast<std::size_t>(i)].limit; }
  double Side(int i) const noexcept { return active_[static_cast<std::size_t>(i)].side; }
  double& Multiplier(int i) noexcept { return active_[static_cast<std::size_t>(i)].multiplier; }
  void Drop(int i) noexcept;
  /// Solution of the system of active limits, factorised: x for  N' inv(H) N x = right.
  PlanVector SolveActive(const PlanVector& right) const noexcept;
  void StartFromLast(const PlanLimits& low, const PlanLimits& high) noexcept;
  /// Adds a limit that is missed; false: without an end.
  bool Add(int limit, double side, double missed, int most_iterations) noexcept;

  PlanMatrix inverse_;                                                    // of H
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic> limits_to_plan_;  // A inv(H)
  Eigen::MatrixXd limits_to_limits_;                                      // A inv(H) A'
  PlanLimits unlimited_;                                                  // A u without limits
  std::array<Active, kMostPlanSteps + 1> active_{};
  int active_count_ = 0;
  int iterations_ = 0;
};

}  // namespace gauntlet::controller
