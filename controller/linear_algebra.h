#pragma once

#include <Eigen/Core>
#include <optional>

namespace gauntlet::controller {

// Decompositions of Eigen, which take seconds to compile, for parts that need one when they are
// made. All of them allocate.

/// Eigenvalues of a symmetric matrix in ascending order; its upper triangle is not read.
Eigen::VectorXd EigenvaluesOf(const Eigen::MatrixXd& symmetric);

/// Inverse of a square matrix; nothing if its rank is lower than its size.
std::optional<Eigen::MatrixXd> InverseOf(const Eigen::MatrixXd& square);

/// Moore-Penrose inverse: columns x rows.
Eigen::MatrixXd PseudoInverseOf(const Eigen::MatrixXd& matrix);

}  // namespace gauntlet::controller
