#include <Eigen/QR>

#include "controller/assert.h"
#include "controller/filters/end_point_fit.h"

namespace gauntlet::controller {

Eigen::ArrayXd EndPointWeights(int window, int order, int derivative) {
  GAUNTLET_ASSERT(0 <= derivative && derivative <= order && order < window);
  // Polynomials in t = -age / (window - 1), so that powers stay within 1.
  using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const long double scale = window > 1 ? window - 1 : 1;
  Matrix powers(window, order + 1);
  for (int age = 0; age < window; ++age) {
    long double power = 1;
    for (int degree = 0; degree <= order; ++degree) {
      powers(age, degree) = power;
      power *= -age / scale;
    }
  }
  // With powers = Q R the fit's coefficients are R^-1 Q' z; at t = 0 only one of them counts, and
  // the weights are Q R^-T e.
  const Eigen::HouseholderQR<Matrix> decomposition(powers);
  Matrix functional = Matrix::Zero(order + 1, 1);
  long double factor = 1;
  for (int i = 1; i <= derivative; ++i) factor *= i / scale;
  functional(derivative) = factor;
  const Matrix r = decomposition.matrixQR().topRows(order + 1);
  const Matrix solved = r.triangularView<Eigen::Upper>().transpose().solve(functional);
  Matrix padded = Matrix::Zero(window, 1);
  padded.topRows(order + 1) = solved;
  const Matrix weights = decomposition.householderQ() * padded;
  return weights.col(0).cast<double>().array();
}

}  // namespace gauntlet::controller
