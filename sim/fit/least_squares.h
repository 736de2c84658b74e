#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace gauntlet::sim {

/// Interface of a least-squares fit: residuals as a function of parameters with bounds.
class LeastSquaresProblem {
 public:
  virtual ~LeastSquaresProblem() = default;
  /// Residual: measured minus model, one value per row.
  virtual Eigen::VectorXd Residual(const Eigen::VectorXd& parameters) = 0;
  /// Derivatives of the model's rows: rows x parameters.
  virtual Eigen::MatrixXd Derivatives(const Eigen::VectorXd& parameters) = 0;
  virtual void KeepWithinBounds(Eigen::VectorXd& parameters) const = 0;

 protected:
  LeastSquaresProblem() = default;
  LeastSquaresProblem(const LeastSquaresProblem&) = default;
  LeastSquaresProblem& operator=(const LeastSquaresProblem&) = default;
};

struct LeastSquaresFit {
  Eigen::VectorXd parameters;
  Eigen::VectorXd residual;
  Eigen::MatrixXd derivatives;
  double squares = 0.0;  // sum of squares of the residual
};

/// Levenberg-Marquardt with Marquardt's scaling, from `start` to the next minimum.
LeastSquaresFit Minimise(LeastSquaresProblem& problem, Eigen::VectorXd start);

/// Number of contiguous blocks of rows for the jackknife. Neighbouring rows have correlated errors;
/// blocks are nearly independent.
inline constexpr int kBlocks = 20;

/// Parameters of a fit without one of the blocks.
struct WithoutBlock {
  Eigen::VectorXd parameters;
  /// Covariance of the block's effect on the parameters, for white noise of variance 1.
  Eigen::MatrixXd pull;
};

/// All parameters but `held`, without each of the blocks, by one Gauss-Newton step; exact for a
/// linear model. None if the rows do not distinguish the parameters.
std::optional<std::vector<WithoutBlock>> WithoutEachBlock(const LeastSquaresFit& fit,
                                                          std::optional<Eigen::Index> held = {});

/// Parameters by other weights of the same rows, as a whole and without each of the blocks.
struct Reweighted {
  Eigen::VectorXd parameters;
  std::vector<Eigen::VectorXd> without;
};

/// All parameters but `held` by one Gauss-Newton step from the fit, with `weighted` instead of the
/// fit's rows: its first column is the residual, the others are the derivatives. If the model is
/// right, the parameters do not depend on the weights, beyond chance.
/// Source: Hausman, Econometrica 46, 1251-1271 (1978).
Reweighted Reweigh(const LeastSquaresFit& fit, const Eigen::MatrixXd& weighted,
                   std::optional<Eigen::Index> held = {});

/// Amount by which a function of the parameters depends on the weights, beyond its standard error.
template <class ValueOf>
double DisagreementOf(const LeastSquaresFit& fit, const std::vector<WithoutBlock>& without,
                      const Reweighted& other, const ValueOf& value_of) {
  const double difference = value_of(other.parameters) - value_of(fit.parameters);
  double squares = 0.0;
  for (std::size_t b = 0; b < without.size(); ++b) {
    const double of_block = value_of(other.without[b]) - value_of(without[b].parameters);
    squares += std::pow(of_block - difference, 2);
  }
  const double variance = squares * (kBlocks - 1.0) / kBlocks;
  return std::sqrt(std::max(difference * difference - variance, 0.0));
}

/// Jackknife standard error (Quenouille, Tukey) of a function `value_of` of the parameters.
template <class ValueOf>
double StandardErrorOf(const LeastSquaresFit& fit, const std::vector<WithoutBlock>& without,
                       const ValueOf& value_of) {
  const double value = value_of(fit.parameters);
  double squares = 0.0;
  for (const WithoutBlock& block : without) {
    squares += std::pow(value_of(block.parameters) - value, 2);
  }
  return std::sqrt(squares * (kBlocks - 1.0) / kBlocks);
}

/// Degrees of freedom of that standard error: kBlocks - 1 if all blocks contribute equally, fewer
/// if few blocks determine the value (lost motion: those with reversals).
///
///     v_b  = gradient' pull_b gradient,     (sum v_b)^2 / sum v_b^2 - 1
///
/// Source: Satterthwaite, Biometrics Bulletin 2, 110-114 (1946); for blocks and white noise: Bell,
/// McCaffrey, Survey Methodology 28, 169-181 (2002).
template <class ValueOf>
double DegreesOfFreedomOf(const LeastSquaresFit& fit, const std::vector<WithoutBlock>& without,
                          const ValueOf& value_of) {
  constexpr double kStep = 1e-4;  // relative step of a parameter
  Eigen::VectorXd gradient(fit.parameters.size());
  for (Eigen::Index i = 0; i < gradient.size(); ++i) {
    Eigen::VectorXd below = fit.parameters;
    Eigen::VectorXd above = fit.parameters;
    const double step = kStep * std::max(std::abs(fit.parameters[i]), 1e-6);
    below[i] -= step;
    above[i] += step;
    gradient[i] = (value_of(above) - value_of(below)) / (2.0 * step);
  }
  double sum = 0.0;
  double squares = 0.0;
  for (const WithoutBlock& block : without) {
    const double variance = gradient.dot(block.pull * gradient);
    sum += variance;
    squares += variance * variance;
  }
  return squares > 0.0 ? std::max(sum * sum / squares - 1.0, 1.0) : kBlocks - 1.0;
}

/// Half width of the 95 % interval by Student's t.
double HalfWidthOf(double standard_error, double degrees_of_freedom);

/// Student's t of the reduction of the squares of two residuals of the same rows: of the logarithm
/// of their ratio in each block, so that few blocks with large residuals do not decide.
double StudentOfGain(const Eigen::VectorXd& better, const Eigen::VectorXd& other);

/// True if chance explains a t of this size at 5 %, for this number of tests (Bonferroni).
bool IsByChance(double t, int questions);

}  // namespace gauntlet::sim
