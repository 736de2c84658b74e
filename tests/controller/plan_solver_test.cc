#include "controller/model_predictive/plan_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "tests/support/gram_schmidt.h"

namespace gauntlet::controller {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Problem {
  Eigen::MatrixXd hessian;
  PlanVector g;
  PlanLimits low, high;
};

Eigen::MatrixXd Limits(Eigen::Index n) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n - 1, n);
  a.topRows(n).setIdentity();
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    a(n + k, k) = -1.0;
    a(n + k, k + 1) = 1.0;
  }
  return a;
}

/// Commands of up to +-1 that change by up to `change`; the goal lies far outside for a large
/// `reach`.
Problem RandomProblem(std::mt19937_64& random, int n, double reach, double change) {
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Problem problem;
  Eigen::MatrixXd c = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return uniform(-1.0, 1.0); });
  problem.hessian =
      c.transpose().lazyProduct(c) + uniform(0.01, 1.0) * Eigen::MatrixXd::Identity(n, n);
  problem.g =
      problem.hessian * Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(-reach, reach); });
  problem.low.resize(2 * n - 1);
  problem.high.resize(2 * n - 1);
  for (int j = 0; j < 2 * n - 1; ++j) {
    const double most = j < n ? 1.0 : change;
    problem.low[j] = -most * uniform(0.7, 1.0);  // no two alike: then each has one multiplier
    problem.high[j] = most * uniform(0.7, 1.0);
  }
  return problem;
}

using Long = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// The solution by trying every set of limits that may bound, in long double.
Eigen::VectorXd ByTryingAll(const Problem& problem) {
  const Eigen::Index n = problem.hessian.rows();
  const Long h = problem.hessian.cast<long double>();
  const Long a = Limits(n).cast<long double>();
  const Long g = problem.g.cast<long double>();
  Eigen::VectorXd best;
  long double least = std::numeric_limits<long double>::infinity();
  std::vector<int> bound(static_cast<std::size_t>(a.rows()), 0);  // 0: neither; 1: low; 2: high
  bool more = true;
  while (more) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index j = 0; j < a.rows(); ++j) {
      if (bound[static_cast<std::size_t>(j)] != 0) rows.push_back(j);
    }
    const auto m = static_cast<Eigen::Index>(rows.size());
    if (m <= n) {
      Long both = Long::Zero(n + m, n + m);
      Long right(n + m, 1);
      both.topLeftCorner(n, n) = h;
      right.topRows(n) = g;
      for (Eigen::Index i = 0; i < m; ++i) {
        const Eigen::Index j = rows[static_cast<std::size_t>(i)];
        both.block(n + i, 0, 1, n) = a.row(j);
        both.block(0, n + i, n, 1) = a.row(j).transpose();
        right(n + i, 0) =
            bound[static_cast<std::size_t>(j)] == 1 ? problem.low[j] : problem.high[j];
      }
      if (const std::optional<Long> solution = test::SolveByGramSchmidt(both, right)) {
        const Long u = solution->topRows(n);
        const Long values = a.lazyProduct(u);
        bool kept = true;
        for (Eigen::Index j = 0; j < a.rows(); ++j) {
          kept = kept && values(j, 0) >= problem.low[j] - 1e-12L &&
                 values(j, 0) <= problem.high[j] + 1e-12L;
        }
        const long double cost = u.cwiseProduct(0.5L * h.lazyProduct(u) - g).sum();
        if (kept && cost < least) {
          least = cost;
          best = u.cast<double>();
        }
      }
    }
    more = false;
    for (int& of : bound) {
      of = of == 2 ? 0 : of + 1;
      if (of == 0) continue;
      more = true;
      break;
    }
  }
  return best;
}

TEST(PlanSolver, IsTheLeastSquaresSolutionWhereNoLimitActs) {
  std::mt19937_64 random(1);
  for (int n = 1; n <= kMostPlanSteps; ++n) {
    const Problem problem = RandomProblem(random, n, 0.3, 1.0);
    const Long exact = test::SolveByGramSchmidt<Long>(problem.hessian.cast<long double>(),
                                                      problem.g.cast<long double>())
                           .value();
    PlanSolver solver(problem.hessian);
    PlanVector plan(n);
    ASSERT_TRUE(solver.Solve(problem.g, problem.low, problem.high, 0, plan));
    EXPECT_EQ(solver.iterations(), 0);
    EXPECT_LT((plan.cast<long double>() - exact).cwiseAbs().maxCoeff(), 1e-12L) << n;
  }
}

TEST(PlanSolver, IsTheBestOfAllSetsOfLimitsThatMayBound) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 60; ++i) {
    const int n = 1 + i % 4;
    const Problem problem = RandomProblem(random, n, 3.0, 0.3);
    PlanSolver solver(problem.hessian);
    PlanVector plan(n);
    ASSERT_TRUE(solver.Solve(problem.g, problem.low, problem.high, 100, plan));
    EXPECT_LT((plan - ByTryingAll(problem)).cwiseAbs().maxCoeff(), 1e-9) << i;
  }
}

// Karush, Kuhn, Tucker: what pulls beyond the limits is the sum of what those that are reached push
// back, none of them inwards.
TEST(PlanSolver, IsOptimalUnderAllLimitsOfLongPlans) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 500; ++i) {
    const int n = 5 + i % 12;
    const Problem problem = RandomProblem(random, n, 4.0, 0.37);
    PlanSolver solver(problem.hessian);
    PlanVector plan(n);
    ASSERT_TRUE(solver.Solve(problem.g, problem.low, problem.high, 1000, plan)) << i;
    const Eigen::VectorXd values = Limits(n) * plan;
    EXPECT_LT((problem.low - values).maxCoeff(), 1e-9);
    EXPECT_LT((values - problem.high).maxCoeff(), 1e-9);
    std::vector<Eigen::VectorXd> outward;
    for (Eigen::Index j = 0; j < values.size(); ++j) {
      if (values[j] > problem.high[j] - 1e-9) outward.push_back(Limits(n).row(j).transpose());
      if (values[j] < problem.low[j] + 1e-9) outward.push_back(-Limits(n).row(j).transpose());
    }
    const Eigen::MatrixXd pull = problem.g - problem.hessian * plan;
    if (outward.empty()) {
      EXPECT_LT(pull.cwiseAbs().maxCoeff(), 1e-9);
      continue;
    }
    Eigen::MatrixXd normals(n, static_cast<Eigen::Index>(outward.size()));
    for (std::size_t k = 0; k < outward.size(); ++k) {
      normals.col(static_cast<Eigen::Index>(k)) = outward[k];
    }
    const Eigen::MatrixXd push = test::SolveByGramSchmidt(normals, pull).value();
    EXPECT_LT((normals.lazyProduct(push) - pull).cwiseAbs().maxCoeff(), 1e-8) << i;
    EXPECT_GT(push.minCoeff(), -1e-8) << i;
  }
}

TEST(PlanSolver, StartsFromTheLimitsOfTheLastPlan) {
  std::mt19937_64 random(4);
  Problem problem = RandomProblem(random, 12, 0.1, 0.05);
  problem.high << PlanVector::Ones(12), Eigen::VectorXd::Constant(11, 0.05);  // the same for all
  problem.low = -problem.high;
  PlanSolver warm(problem.hessian);
  int warm_iterations = 0;
  int cold_iterations = 0;
  for (int event = 0; event < 200; ++event) {
    for (int k = 0; k < 12; ++k) problem.g[k] = 2.0 * std::sin(0.05 * (event + k));
    problem.g = problem.hessian * problem.g;
    PlanVector from_last(12), from_nothing(12);
    ASSERT_TRUE(warm.Solve(problem.g, problem.low, problem.high, 1000, from_last));
    warm_iterations += warm.iterations();
    PlanSolver cold(problem.hessian);
    ASSERT_TRUE(cold.Solve(problem.g, problem.low, problem.high, 1000, from_nothing));
    cold_iterations += cold.iterations();
    EXPECT_LT((from_last - from_nothing).cwiseAbs().maxCoeff(), 1e-9) << event;
  }
  EXPECT_GT(cold_iterations, 200);
  EXPECT_LT(2 * warm_iterations, cold_iterations);
}

TEST(PlanSolver, SaysWhereItFoundNoPlanAndLeavesTheOldOne) {
  std::mt19937_64 random(5);
  Problem problem = RandomProblem(random, 6, 5.0, 0.1);
  PlanSolver solver(problem.hessian);
  PlanVector plan = PlanVector::Constant(6, 7.0);
  EXPECT_FALSE(solver.Solve(problem.g, problem.low, problem.high, 1, plan));
  EXPECT_EQ(plan, PlanVector::Constant(6, 7.0));
  EXPECT_TRUE(solver.Solve(problem.g, problem.low, problem.high, 100, plan));
  problem.low[0] = problem.high[0] = -1.0;  // and the second 1, but 0.1 apart at most
  problem.low[1] = problem.high[1] = 1.0;
  const PlanVector before = plan;
  EXPECT_FALSE(solver.Solve(problem.g, problem.low, problem.high, 1000, plan));
  EXPECT_EQ(plan, before);
}

TEST(PlanSolver, TakesLimitsThatAreInfinite) {
  std::mt19937_64 random(6);
  Problem problem = RandomProblem(random, 5, 3.0, kInfinity);
  PlanSolver solver(problem.hessian);
  PlanVector plan(5);
  EXPECT_TRUE(solver.Solve(problem.g, problem.low, problem.high, 100, plan));
  EXPECT_LE(plan.cwiseAbs().maxCoeff(), 1.0 + 1e-9);
}

}  // namespace
}  // namespace gauntlet::controller
