#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace gauntlet::sim {

/// What a fit is asked of: residuals that depend on parameters, which have bounds.
class LeastSquaresProblem {
 public:
  virtual ~LeastSquaresProblem() = default;
  /// What the model leaves of each row.
  virtual Eigen::VectorXd Residual(const Eigen::VectorXd& parameters) = 0;
  /// By how much the model's rows rise per parameter: rows x parameters.
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
  double squares = 0.0;  // of the residual
};

/// Levenberg and Marquardt, with the scales of Marquardt, from where it starts to the next minimum.
LeastSquaresFit Minimise(LeastSquaresProblem& problem, Eigen::VectorXd start);

/// How sure a fit is comes from this many stretches of its rows, in a row: what disturbs one row
/// also disturbs the next, and stretches hardly.
inline constexpr int kBlocks = 20;

/// A fit as it would be without one of the blocks.
struct WithoutBlock {
  Eigen::VectorXd parameters;
  /// Covariance of what the block does to the parameters, of white noise of variance 1.
  Eigen::MatrixXd pull;
};

/// All parameters but `held` as they would be without each of the blocks, by one step of Gauss and
/// Newton, which is exact where the model is linear. None where the rows do not tell the
/// parameters apart.
std::optional<std::vector<WithoutBlock>> WithoutEachBlock(const LeastSquaresFit& fit,
                                                          std::optional<Eigen::Index> held = {});

/// Jackknife (Quenouille, Tukey) of a value that `value_of` makes of the parameters.
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

/// How well that standard error is known, in degrees of freedom: kBlocks - 1 if each block tells as
/// much of the value, fewer where few blocks tell most of it, as few turns do of lost motion.
///
///     v_b  = gradient' pull_b gradient,     (sum v_b)^2 / sum v_b^2 - 1
///
/// Source: Satterthwaite, Biometrics Bulletin 2, 110-114 (1946), of blocks as Bell, McCaffrey,
/// Survey Methodology 28, 169-181 (2002), take it: as of white noise.
template <class ValueOf>
double DegreesOfFreedomOf(const LeastSquaresFit& fit, const std::vector<WithoutBlock>& without,
                          const ValueOf& value_of) {
  constexpr double kStep = 1e-4;  // of a parameter
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

/// Of 95 %, as wide to both sides as Student's t says.
double HalfWidthOf(double standard_error, double degrees_of_freedom);

/// Student's t of what a fit leaves less of the squares of the last rows than another, from block
/// to block.
double StudentOfGain(const LeastSquaresFit& better, const LeastSquaresFit& other);

/// Whether so large a t is met by chance, at 5 %, in one or more of so many questions (Bonferroni).
bool IsByChance(double t, int questions);

}  // namespace gauntlet::sim
