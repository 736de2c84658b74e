#include "controller/filters/riccati.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "controller/assert.h"

namespace gauntlet::controller {

Eigen::MatrixXd SolveRiccati(const Eigen::MatrixXd& a, const Eigen::MatrixXd& h,
                             const Eigen::MatrixXd& q, const Eigen::MatrixXd& r) {
  GAUNTLET_ASSERT(a.rows() == a.cols() && q.rows() == a.rows() && q.cols() == a.rows());
  GAUNTLET_ASSERT(h.cols() == a.rows() && r.rows() == h.rows() && r.cols() == h.rows());
  // Extended precision: the gains of slow filters are small differences of large covariances.
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Matrix h_long = h.cast<long double>();
  Matrix transition = a.cast<long double>().transpose();
  Matrix information = h_long.transpose() * r.cast<long double>().llt().solve(h_long);
  Matrix covariance = q.cast<long double>();
  constexpr int kMostDoublings = 60;
  for (int i = 0; i < kMostDoublings; ++i) {
    const Matrix identity = Matrix::Identity(a.rows(), a.cols());
    const Eigen::PartialPivLU<Matrix> w(identity + information * covariance);
    const Matrix v1 = w.solve(transition);
    const Matrix v2 = w.solve(information);
    const Matrix growth = transition.transpose() * covariance * v1;
    information += transition * v2 * transition.transpose();
    transition = transition * v1;
    covariance += growth;
    covariance = 0.5L * (covariance + covariance.transpose()).eval();
    if (growth.norm() <= 1e-18L * covariance.norm()) break;
  }
  return covariance.cast<double>();
}

}  // namespace gauntlet::controller
