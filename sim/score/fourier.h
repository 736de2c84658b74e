#pragma once

#include <complex>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace gauntlet::sim {

/// The discrete Fourier transform of complex values of any length, in place.
///
/// Eigen's own transform (kissfft) and not FFTW: three times slower, yet fast enough by far, the
/// same code on every processor (FFTW chooses its own by the processor), no planner that threads
/// share, and nothing more to install. Measured in tests/benchmarks/README.md.
///
/// Twiddle factors are kept per length, unless it is great; use one object per thread.
class Fourier {
 public:
  using Values = std::vector<std::complex<double>>;

  /// X_k = sum_n x_n exp(-2 pi i k n / N).
  void Forward(Values& values);
  /// x_n = 1/N sum_k X_k exp(+2 pi i k n / N).
  void Inverse(Values& values);
  /// The lower half, k = 0 .. N/2, of the transform of real values, in half the time.
  void Forward(const std::vector<double>& values, Values& lower_half);
  /// The other way; what lies above the lower half does not matter.
  void Inverse(Values lower_half, std::vector<double>& values);

 private:
  void ForgetLong(std::size_t size);

  Eigen::FFT<double> transform_{{}, Eigen::FFT<double>::HalfSpectrum};
  Values result_;
};

/// The smallest length >= `size` that is a product of 4, 3 and 5 only: those are fast.
int FastTransformSize(int size);

}  // namespace gauntlet::sim
