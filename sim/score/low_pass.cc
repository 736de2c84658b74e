#include "sim/score/low_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

constexpr double kAttenuation_db = 80.0;
/// Length of a block in lengths of the filter: a seventh of it is then computed twice. Longer ones
/// leave the cache.
constexpr int kBlockLengths = 8;

/// The transform of the filter of this band, which is real because the weights are symmetric.
std::vector<double> Response(const LowPass& low_pass, Band band, int size, Fourier& fourier) {
  Fourier::Values values(size);
  values[0] = low_pass.weights[0];
  for (int n = 1; n <= low_pass.reach(); ++n) {
    values[n] += low_pass.weights[n];
    values[size - n] += low_pass.weights[n];
  }
  fourier.Forward(values);
  std::vector<double> response(size);
  for (int k = 0; k < size; ++k) {
    response[k] = band == Band::kAbove ? 1.0 - values[k].real() : values[k].real();
  }
  return response;
}

}  // namespace

// Kaiser's rules for the length and, below, for the shape of the window.
int LowPassReach(double transition_hz, double rate_hz) {
  const double transition_rad = 2.0 * std::numbers::pi * transition_hz / rate_hz;
  return static_cast<int>(std::ceil(0.5 * (kAttenuation_db - 7.95) / (2.285 * transition_rad)));
}

LowPass DesignLowPass(double cutoff_hz, double transition_hz, double rate_hz) {
  GAUNTLET_ASSERT(cutoff_hz > 0.0 && transition_hz > 0.0 && rate_hz > 0.0);
  const int reach = LowPassReach(transition_hz, rate_hz);
  const double beta = 0.1102 * (kAttenuation_db - 8.7);

  LowPass low_pass;
  low_pass.weights.resize(reach + 1);
  const double cutoff_rad = 2.0 * std::numbers::pi * cutoff_hz / rate_hz;
  double sum = 0.0;
  for (int n = 0; n <= reach; ++n) {
    const double position = static_cast<double>(n) / reach;
    const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - position * position));
    const double sinc = n == 0 ? cutoff_rad : std::sin(cutoff_rad * n) / n;
    low_pass.weights[n] = window * sinc;
    sum += (n == 0 ? 1.0 : 2.0) * low_pass.weights[n];
  }
  for (double& weight : low_pass.weights) weight /= sum;
  return low_pass;
}

FilteredSignal Filter(const LowPass& low_pass, Band band, const Signal& signal, Fourier& fourier) {
  const int samples = static_cast<int>(signal.rows());
  const int channels = static_cast<int>(signal.cols());
  const int reach = low_pass.reach();
  const int rows = std::max(0, samples - 2 * reach);
  FilteredSignal result{reach, Signal(rows, channels)};
  if (rows == 0) return result;

  // A transform wraps around: that spoils only as much of a block as the next one gives anew, and
  // of the last one what the filter's reach takes away anyhow.
  const int size = FastTransformSize(std::min(samples, kBlockLengths * (2 * reach + 1)));
  const int good = size - 2 * reach;  // rows of a block
  const std::vector<double> response = Response(low_pass, band, size, fourier);
  Fourier::Values values;
  for (int a = 0; a < channels; a += 2) {  // two real channels in one complex transform
    const int b = std::min(a + 1, channels - 1);
    // A value that is not finite spoils its own channel, not the one that shares the transform.
    const bool good_a = signal.col(a).allFinite();
    const bool good_b = signal.col(b).allFinite();
    for (int first = 0; first < rows; first += good) {
      values.assign(size, 0.0);
      for (int n = 0; n < std::min(size, samples - first); ++n) {
        values[n] = {good_a ? signal(first + n, a) : 0.0, good_b ? signal(first + n, b) : 0.0};
      }
      fourier.Forward(values);
      for (int k = 0; k < size; ++k) values[k] *= response[k];
      fourier.Inverse(values);
      for (int n = 0; n < std::min(good, rows - first); ++n) {
        result.values(first + n, a) = values[n + reach].real();
        result.values(first + n, b) = values[n + reach].imag();
      }
    }
    if (!good_a) result.values.col(a).setConstant(kNaN);
    if (!good_b) result.values.col(b).setConstant(kNaN);
    TrimSignals();
  }
  return result;
}

}  // namespace gauntlet::sim
