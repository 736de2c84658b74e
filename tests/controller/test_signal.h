#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace gauntlet::controller {

/// Reproducible noise for tests that know only the controller. SplitMix64 (Steele et al. 2014);
/// the sum of twelve uniform numbers stands for a normal one.
class TestNoise {
 public:
  explicit TestNoise(std::uint64_t seed) : state_(seed) {}

  double Uniform() {
    state_ += 0x9e3779b97f4a7c15;
    std::uint64_t bits = state_;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    return static_cast<double>((bits ^ (bits >> 31)) >> 11) * 0x1.0p-53;
  }
  double Normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += Uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
};

/// Row-major so that a row can be handed to Step(): samples x channels, counts of a moving glove,
/// 0.2 to 2 Hz around the middle of a 10-bit converter, with noise of 4 counts.
using TestSignal = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline TestSignal GloveCounts(int samples, int channels, std::uint64_t seed = 1) {
  TestSignal signal(samples, channels);
  TestNoise noise(seed);
  for (int k = 0; k < samples; ++k) {
    for (int i = 0; i < channels; ++i) {
      const double frequency_hz = 0.2 + 1.8 * i / channels;
      const double motion = 512.0 + 200.0 * std::sin(6.283185307 * frequency_hz * k * 1e-3 + i);
      signal(k, i) = std::round(motion + 4.0 * noise.Normal());
    }
  }
  return signal;
}

inline std::span<const double> RowOf(const TestSignal& signal, Eigen::Index row) {
  return {signal.row(row).data(), static_cast<std::size_t>(signal.cols())};
}
inline std::span<double> RowOf(TestSignal& signal, Eigen::Index row) {
  return {signal.row(row).data(), static_cast<std::size_t>(signal.cols())};
}

}  // namespace gauntlet::controller
