#include "controller/model_predictive/plan_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/assert.h"

namespace gauntlet::controller {
namespace {

// Of a limit, in the unit of a command (rad): far below what any motor resolves.
constexpr double kMissed = 1e-11;
// A limit whose change costs less than this share of its own is implied by those that are active.
constexpr double kDependent = 1e-9;

}  // namespace

PlanSolver::PlanSolver(const Eigen::MatrixXd& hessian) {
  GAUNTLET_ASSERT(hessian.cols() == hessian.rows());
  GAUNTLET_ASSERT(1 <= hessian.rows() && hessian.rows() <= kMostPlanSteps);
  const Eigen::Index n = hessian.rows();
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n - 1, n);
  a.topRows(n).setIdentity();
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    a(n + k, k) = -1.0;
    a(n + k, k + 1) = 1.0;
  }
  const Eigen::MatrixXd inverse = hessian.llt().solve(Eigen::MatrixXd::Identity(n, n));
  inverse_ = inverse;
  limits_to_plan_ = a * inverse;
  limits_to_limits_ = limits_to_plan_ * a.transpose();
  unlimited_.setZero(2 * n - 1);
}

void PlanSolver::Drop(int i) noexcept {
  std::move(active_.begin() + i + 1, active_.begin() + active_count_, active_.begin() + i);
  --active_count_;
}

PlanVector PlanSolver::SolveActive(const PlanVector& right) const noexcept {
  PlanMatrix gram(active_count_, active_count_);
  for (int i = 0; i < active_count_; ++i) {
    for (int k = 0; k < active_count_; ++k) {
      gram(i, k) = Side(i) * Side(k) * limits_to_limits_(Index(i), Index(k));
    }
  }
  PlanVector result = right;
  Eigen::LLT<Eigen::Ref<PlanMatrix>>(gram).solveInPlace(result);
  return result;
}

/// Limits whose multiplier is negative do not bound: they are dropped until none is.
void PlanSolver::StartFromLast(const PlanLimits& low, const PlanLimits& high) noexcept {
  const int n = step_count();
  int kept = 0;
  for (int i = 0; i < active_count_; ++i) {
    Active active = active_[static_cast<std::size_t>(i)];
    if (active.limit == 0 || active.limit == n) continue;  // those of the command that was sent
    --active.limit;
    active_[static_cast<std::size_t>(kept++)] = active;
  }
  active_count_ = kept;
  bool all_bound = false;
  while (!all_bound && active_count_ > 0) {
    PlanVector missed(active_count_);
    for (int i = 0; i < active_count_; ++i) {
      const double bound = Side(i) > 0.0 ? high[Index(i)] : low[Index(i)];
      missed[i] = Side(i) * (unlimited_[Index(i)] - bound);
    }
    const PlanVector multipliers = SolveActive(missed);
    all_bound = true;
    for (int i = active_count_; i-- > 0;) {
      Multiplier(i) = multipliers[i];
      if (multipliers[i] > 0.0) continue;
      Drop(i);
      all_bound = false;
    }
  }
}

bool PlanSolver::Add(int limit, double side, double missed, int most_iterations) noexcept {
  double multiplier = 0.0;
  while (iterations_ < most_iterations) {
    ++iterations_;
    PlanVector shared(active_count_);
    for (int i = 0; i < active_count_; ++i) {
      shared[i] = side * Side(i) * limits_to_limits_(Index(i), limit);
    }
    const PlanVector taken = SolveActive(shared);  // from the others, per unit of this multiplier
    const double own = limits_to_limits_(limit, limit);
    const double gained = own - shared.dot(taken);
    const double infinity = std::numeric_limits<double>::infinity();
    const double whole_step = gained > kDependent * own ? missed / gained : infinity;
    double step = whole_step;
    int dropped = -1;
    for (int i = 0; i < active_count_; ++i) {
      if (!(taken[i] > 0.0) || !(Multiplier(i) / taken[i] < step)) continue;
      step = Multiplier(i) / taken[i];
      dropped = i;
    }
    if (!std::isfinite(step)) return false;  // no plan keeps all limits
    for (int i = 0; i < active_count_; ++i) Multiplier(i) -= step * taken[i];
    multiplier += step;
    if (dropped < 0) {
      GAUNTLET_ASSERT(active_count_ < std::ssize(active_));
      active_[static_cast<std::size_t>(active_count_++)] = {limit, side, multiplier};
      return true;
    }
    if (std::isfinite(whole_step)) missed -= step * gained;
    Drop(dropped);
  }
  return false;
}

bool PlanSolver::Solve(const PlanVector& g, const PlanLimits& low, const PlanLimits& high,
                       int most_iterations, PlanVector& plan) noexcept {
  GAUNTLET_ASSERT(g.size() == step_count());
  GAUNTLET_ASSERT(low.size() == limit_count() && high.size() == limit_count());
  const int limits = limit_count();
  iterations_ = 0;
  unlimited_.noalias() = limits_to_plan_ * g;
  StartFromLast(low, high);
  bool solved = false;
  while (!solved) {
    int worst = -1;
    double side = 1.0;
    double missed = kMissed;
    for (int j = 0; j < limits; ++j) {
      double value = unlimited_[j];
      for (int i = 0; i < active_count_; ++i) {
        value -= limits_to_limits_(j, Index(i)) * Side(i) * Multiplier(i);
      }
      const bool above = value - high[j] > low[j] - value;
      const double by = above ? value - high[j] : low[j] - value;
      if (by > missed) {
        worst = j;
        side = above ? 1.0 : -1.0;
        missed = by;
      }
    }
    solved = worst < 0;
    if (!solved && !Add(worst, side, missed, most_iterations)) {
      Reset();
      return false;
    }
  }
  PlanVector solution(step_count());
  solution.noalias() = inverse_ * g;
  for (int i = 0; i < active_count_; ++i) {
    solution -= Side(i) * Multiplier(i) * limits_to_plan_.row(Index(i)).transpose();
  }
  if (!solution.allFinite()) {
    Reset();
    return false;
  }
  plan = solution;
  return true;
}

}  // namespace gauntlet::controller
