#include "controller/linear_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include "controller/assert.h"

namespace gauntlet::controller {

using Eigen::MatrixXd;

Eigen::VectorXd EigenvaluesOf(const MatrixXd& symmetric) {
  GAUNTLET_ASSERT(symmetric.rows() == symmetric.cols());
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

std::optional<MatrixXd> InverseOf(const MatrixXd& square) {
  GAUNTLET_ASSERT(square.rows() == square.cols());
  const Eigen::FullPivLU<MatrixXd> decomposition(square);
  if (!decomposition.isInvertible()) return std::nullopt;
  return decomposition.inverse();
}

MatrixXd PseudoInverseOf(const MatrixXd& matrix) {
  return matrix.completeOrthogonalDecomposition().pseudoInverse();
}

}  // namespace gauntlet::controller
