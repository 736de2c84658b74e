#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace gauntlet::controller {

using Real = long double;
// At most 6 states, so that nothing is allocated.
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

/// The paper's equations as matrices in long double: nothing is shared with the filters but the
/// algebra of section 2.3.2.
struct TextbookKalman {
  RealMatrix a, h, q, r;
  RealVector x;
  RealMatrix p;
  RealVector x_prior = {};
  RealMatrix p_prior = {};
  RealMatrix gain = {};

  RealVector Step(const RealVector& z, const RealVector& input_term) {
    x_prior = a * x + input_term;
    p_prior = a * p * a.transpose() + q;
    gain = p_prior * h.transpose() * (h * p_prior * h.transpose() + r).inverse();
    x = x_prior + gain * (z - h * x_prior);
    p = (RealMatrix::Identity(x.size(), x.size()) - gain * h) * p_prior;
    return h * x;
  }
  RealVector Step(const RealVector& z) { return Step(z, RealVector::Zero(x.size())); }
  Real Step(Real z) { return Step(RealVector::Constant(1, z))[0]; }
};

/// Motion model of `channels` channels with `states` states each: positions, velocities, ...
inline TextbookKalman MakeTextbookKalman(int channels, int states, const RealMatrix& q,
                                         const RealMatrix& r) {
  const int size = channels * states;
  RealMatrix a = RealMatrix::Zero(size, size);
  for (int i = 0; i < states; ++i) {
    Real factor = 1;
    for (int j = i; j < states; ++j) {
      a.block(i * channels, j * channels, channels, channels).diagonal().setConstant(factor);
      factor /= static_cast<Real>(j - i + 1);
    }
  }
  return {.a = a,
          .h = RealMatrix::Identity(channels, size),
          .q = q,
          .r = r,
          .x = RealVector::Zero(size),
          .p = RealMatrix::Identity(size, size)};
}

}  // namespace gauntlet::controller
