#pragma once

#include <complex>
#include <memory>
#include <vector>

namespace gauntlet::sim {

/// The discrete Fourier transform of complex values of any length, in place; fast where the length
/// has no prime factors but 2, 3 and 5. By Eigen (kissfft), whose bits do not depend on the
/// processor, as those of FFTW do.
///
/// Roots of 1 are kept per length; use one object per thread.
class Fourier {
 public:
  using Values = std::vector<std::complex<double>>;

  Fourier();
  ~Fourier();

  /// X_k = sum_n x_n exp(-2 pi i k n / N).
  void Forward(Values& values);
  /// x_n = 1/N sum_k X_k exp(+2 pi i k n / N).
  void Inverse(Values& values);
  /// The lower half, k = 0 .. N/2, of the transform of real values, in half the time where N is a
  /// multiple of 4.
  void Forward(const std::vector<double>& values, Values& lower_half);
  /// The other way, to as many values as there is room for; what lies above the lower half does not
  /// matter.
  void Inverse(const Values& lower_half, std::vector<double>& values);

 private:
  struct Plans;
  std::unique_ptr<Plans> plans_;
  Values other_;  // where a transform puts its values
};

/// The smallest length >= `size` that is a product of 4, 3 and 5 only: those are fast.
int FastTransformSize(int size);

}  // namespace gauntlet::sim
