#include "sim/calibrate/least_squares.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <numeric>
#include <utility>

#include "controller/assert.h"
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
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(normal, Eigen::EigenvaluesOnly);
  if (!(eigen.eigenvalues()[0] > kLeastEigenvalue)) return std::nullopt;
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

double HalfWidthOf(double standard_error, double degrees_of_freedom) {
  return StudentHalfWidth(0.95, degrees_of_freedom) * standard_error;
}

double StudentOfGain(const LeastSquaresFit& better, const LeastSquaresFit& other) {
  GAUNTLET_ASSERT(other.residual.size() >= better.residual.size());
  const Index rows = better.residual.size();
  const VectorXd gain = other.residual.tail(rows).cwiseAbs2() - better.residual.cwiseAbs2();
  Eigen::Vector<double, kBlocks> of_block;
  for (Index block = 0; block < kBlocks; ++block) {
    const Index begin = rows * block / kBlocks;
    of_block[block] = gain.segment(begin, rows * (block + 1) / kBlocks - begin).sum();
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
