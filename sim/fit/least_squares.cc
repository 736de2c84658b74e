#include "sim/fit/least_squares.h"

#include <Eigen/Cholesky>
#include <numeric>
#include <utility>

#include "controller/assert.h"
#include "controller/linear_algebra.h"
#include "sim/base/student.h"

namespace gauntlet::sim {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

LeastSquaresFit Minimise(LeastSquaresProblem& problem, VectorXd start) {
  constexpr int kMostSteps = 60;
  constexpr double kEnough = 1e-9;  // relative gain of a step
  problem.KeepWithinBounds(start);
  LeastSquaresFit best{.parameters = start, .residual = problem.Residual(start), .derivatives = {}};
  best.squares = best.residual.squaredNorm();
  best.derivatives = problem.Derivatives(best.parameters);
  double damping = 1e-3;
  int small_gains = 0;
  for (int step = 0; step < kMostSteps && small_gains < 2 && damping < 1e10; ++step) {
    MatrixXd normal = best.derivatives.transpose() * best.derivatives;
    const VectorXd gradient = best.derivatives.transpose() * best.residual;
    const VectorXd scale = normal.diagonal().cwiseMax(1e-300);
    normal.diagonal() += damping * scale;
    VectorXd next = best.parameters + normal.ldlt().solve(gradient);
    problem.KeepWithinBounds(next);
    VectorXd residual = problem.Residual(next);
    const double squares = residual.squaredNorm();
    if (!(squares < best.squares)) {
      damping *= 8.0;
      continue;
    }
    small_gains = best.squares - squares < kEnough * best.squares ? small_gains + 1 : 0;
    best.parameters = std::move(next);
    best.residual = std::move(residual);
    best.squares = squares;
    best.derivatives = problem.Derivatives(best.parameters);
    damping = std::max(damping / 5.0, 1e-12);
  }
  return best;
}

std::optional<std::vector<WithoutBlock>> WithoutEachBlock(const LeastSquaresFit& fit,
                                                          std::optional<Index> held) {
  GAUNTLET_ASSERT(fit.derivatives.rows() == fit.residual.size());
  GAUNTLET_ASSERT(fit.derivatives.cols() == fit.parameters.size());
  GAUNTLET_ASSERT(!held || (0 <= *held && *held < fit.parameters.size()));
  constexpr double kLeastEigenvalue = 1e-7;  // of the normal matrix, scaled to a unit diagonal
  std::vector<Index> told(static_cast<std::size_t>(fit.parameters.size()));
  std::iota(told.begin(), told.end(), Index{0});
  if (held) told.erase(told.begin() + *held);
  const MatrixXd derivatives = fit.derivatives(Eigen::all, told);
  const VectorXd norm = derivatives.colwise().norm().cwiseMax(1e-300);
  const MatrixXd scaled = derivatives * norm.cwiseInverse().asDiagonal();
  const MatrixXd normal = scaled.transpose() * scaled;
  if (!(controller::EigenvaluesOf(normal)[0] > kLeastEigenvalue)) return std::nullopt;
  const MatrixXd unscaled = norm.cwiseInverse().asDiagonal();
  std::vector<WithoutBlock> result;
  for (Index block = 0; block < kBlocks; ++block) {
    const Index begin = scaled.rows() * block / kBlocks;
    const Index rows = scaled.rows() * (block + 1) / kBlocks - begin;
    const auto part = scaled.middleRows(begin, rows);
    const MatrixXd own = part.transpose() * part;
    const Eigen::LDLT<MatrixXd> rest(normal - own);
    const VectorXd gradient = part.transpose() * fit.residual.segment(begin, rows);
    WithoutBlock without{.parameters = fit.parameters, .pull = {}};
    without.parameters(told) -= rest.solve(gradient).cwiseQuotient(norm);
    without.pull = MatrixXd::Zero(fit.parameters.size(), fit.parameters.size());
    without.pull(told, told) = unscaled * rest.solve(rest.solve(own).transpose()) * unscaled;
    result.push_back(std::move(without));
  }
  return result;
}

Reweighted Reweigh(const LeastSquaresFit& fit, const MatrixXd& weighted,
                   std::optional<Index> held) {
  GAUNTLET_ASSERT(weighted.cols() == fit.parameters.size() + 1);
  const Index count = fit.parameters.size();
  std::vector<MatrixXd> normal;  // of each block: derivatives' [derivatives, residual]
  MatrixXd sum = MatrixXd::Zero(count, count + 1);
  for (Index block = 0; block < kBlocks; ++block) {
    const Index begin = weighted.rows() * block / kBlocks;
    const auto part = weighted.middleRows(begin, weighted.rows() * (block + 1) / kBlocks - begin);
    MatrixXd own(count, count + 1);
    own << part.rightCols(count).transpose() * part.rightCols(count),
        part.rightCols(count).transpose() * part.col(0);
    sum += own;
    normal.push_back(std::move(own));
  }
  const auto solve = [&](MatrixXd equations) {
    constexpr double kRidge = 1e-7;  // parameters that these weights do not determine stay
    if (held) equations.row(*held).setZero(), equations.col(*held).setZero();
    const VectorXd scale = equations.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    MatrixXd scaled = scale.asDiagonal() * equations.leftCols(count) * scale.asDiagonal();
    scaled.diagonal().array() += kRidge;
    const VectorXd step = scaled.ldlt().solve(scale.cwiseProduct(equations.col(count)));
    return VectorXd(fit.parameters + scale.cwiseProduct(step));
  };
  Reweighted result{.parameters = solve(sum), .without = {}};
  for (const MatrixXd& own : normal) result.without.push_back(solve(sum - own));
  return result;
}

double HalfWidthOf(double standard_error, double degrees_of_freedom) {
  return StudentHalfWidth(0.95, degrees_of_freedom) * standard_error;
}

double StudentOfGain(const VectorXd& better, const VectorXd& other) {
  GAUNTLET_ASSERT(other.size() == better.size());
  const Index rows = better.size();
  Eigen::Vector<double, kBlocks> of_block;
  for (Index block = 0; block < kBlocks; ++block) {
    const Index begin = rows * block / kBlocks;
    const Index count = rows * (block + 1) / kBlocks - begin;
    const auto squares = [&](const VectorXd& residual) {
      return std::max(residual.segment(begin, count).squaredNorm(), 1e-300);
    };
    of_block[block] = std::log(squares(other) / squares(better));
  }
  const double spread = (of_block.array() - of_block.mean()).matrix().norm();
  return of_block.mean() / std::max(spread / std::sqrt(kBlocks * (kBlocks - 1.0)), 1e-300);
}

bool IsByChance(double t, int questions) {
  GAUNTLET_ASSERT(questions > 0);
  constexpr double kChance = 0.05;
  return t <= 0.0 || 0.5 * StudentProbability(t, kBlocks - 1) * questions > kChance;
}

}  // namespace gauntlet::sim
