#pragma once

#include <complex>
#include <cstddef>
#include <map>
#include <vector>

namespace gauntlet::sim {

/// The discrete Fourier transform of complex values of any length, in place; fast where the length
/// has no prime factors but 2, 3 and 5.
///
/// One pass per factor, which also sorts (Stockham's), so that each goes through memory in order;
/// two real numbers at a time, as every 64-bit processor can. Not FFTW, which chooses its own code
/// by the processor and so gives no same bits, and not Eigen's own transform (kissfft), which takes
/// 2.4 to 5 times as long. Measured in docs/evidence/benchmarks.md.
/// Source: Cochran et al. 1967, What is the fast Fourier transform?, for the sorting of Stockham.
///
/// Roots of 1 are kept per length, until they are too many; use one object per thread.
class Fourier {
 public:
  using Values = std::vector<std::complex<double>>;

  /// X_k = sum_n x_n exp(-2 pi i k n / N).
  void Forward(Values& values);
  /// x_n = 1/N sum_k X_k exp(+2 pi i k n / N).
  void Inverse(Values& values);
  /// The lower half, k = 0 .. N/2, of the transform of real values, in half the time where N is
  /// even.
  void Forward(const std::vector<double>& values, Values& lower_half);
  /// The other way, to as many values as there is room for; what lies above the lower half does not
  /// matter.
  void Inverse(Values lower_half, std::vector<double>& values);

 private:
  /// A pass over all values.
  struct Pass {
    std::size_t radix = 1;
    std::size_t groups = 1;  // that are left of this length when it is done
    Values turns;            // of each group, exp(-2 pi i group k / (radix groups)), k = 1 ..
    Values roots;            // of the radix, where it has no pass of its own
  };
  using Plan = std::vector<Pass>;

  const Plan& PlanOf(std::size_t size);
  const Values& RootsOf(std::size_t size);
  template <bool kInverse>
  void Transform(std::size_t size, Values& values);
  void ForgetTooMany();

  std::map<std::size_t, Plan> plans_;
  std::map<std::size_t, Values> roots_;
  std::size_t kept_ = 0;  // values of both
  Values other_;          // where a pass puts its values
};

/// The smallest length >= `size` that is a product of 4, 3 and 5 only: those are fast.
int FastTransformSize(int size);

}  // namespace gauntlet::sim
