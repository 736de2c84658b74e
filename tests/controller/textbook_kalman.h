#pragma once

#include <Eigen/Core>

namespace gauntlet::controller {

using Real = long double;
// At most 6 states, so that nothing is allocated.
using RealMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
using RealVector = Eigen::Matrix<Real, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

/// The paper's equations as matrices in long double: nothing is shared with the filters but the
/// algebra of section 2.3.2. Not inline: matrices of this kind take seconds to compile.
struct TextbookKalman {
  RealMatrix a, h, q, r;
  RealVector x;
  RealMatrix p;
  RealVector x_prior = {};
  RealMatrix p_prior = {};
  RealMatrix gain = {};

  RealVector Step(const RealVector& z, const RealVector& input_term);
  RealVector Step(const RealVector& z) { return Step(z, RealVector::Zero(x.size())); }
  Real Step(Real z) { return Step(RealVector::Constant(1, z))[0]; }
  /// The state of this step once that of the next one is known (Rauch, Tung and Striebel).
  RealVector Smoothed(const TextbookKalman& next, const RealVector& next_smoothed) const;
};

/// Motion model of `channels` channels with `states` states each: positions, velocities, ...
TextbookKalman MakeTextbookKalman(int channels, int states, const RealMatrix& q,
                                  const RealMatrix& r);

}  // namespace gauntlet::controller
