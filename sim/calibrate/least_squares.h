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

/// All parameters but `held` as they would be without each of the blocks, by one step of Gauss and
/// Newton, which is exact where the model is linear. None where the rows do not tell the
/// parameters apart.
std::optional<std::vector<Eigen::VectorXd>> WithoutEachBlock(const LeastSquaresFit& fit,
                                                             std::optional<Eigen::Index> held = {});

/// Jackknife (Quenouille, Tukey) of a value that `value_of` makes of the parameters.
template <class ValueOf>
double StandardErrorOf(const LeastSquaresFit& fit, const std::vector<Eigen::VectorXd>& without,
                       const ValueOf& value_of) {
  const double value = value_of(fit.parameters);
  double squares = 0.0;
  for (const Eigen::VectorXd& parameters : without) {
    squares += std::pow(value_of(parameters) - value, 2);
  }
  return std::sqrt(squares * (kBlocks - 1.0) / kBlocks);
}

/// Of 95 %, as wide to both sides as Student's t of so many blocks says.
double HalfWidthOf(double standard_error);

/// Student's t of what a fit leaves less of the squares of the last rows than another, from block
/// to block.
double StudentOfGain(const LeastSquaresFit& better, const LeastSquaresFit& other);

/// Whether so large a t is met by chance, at 5 %, in one or more of so many questions (Bonferroni).
bool IsByChance(double t, int questions);

}  // namespace gauntlet::sim
