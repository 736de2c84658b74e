#pragma once

#include <Eigen/Core>

namespace gauntlet::controller {

/// The a-priori covariance P to which a Kalman filter settles:
///
///     P = A (P - P H' (H P H' + R)^-1 H P) A' + Q
///
/// by the structure-preserving doubling algorithm, which squares the error at each of a few steps.
/// Source: Chu, Fan, Lin, Wang, International Journal of Control 77 (2004).
/// Shapes: A and Q are m x m, H is n x m, R is n x n. R positive definite.
Eigen::MatrixXd SolveRiccati(const Eigen::MatrixXd& a, const Eigen::MatrixXd& h,
                             const Eigen::MatrixXd& q, const Eigen::MatrixXd& r);

}  // namespace gauntlet::controller
