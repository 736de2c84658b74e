#include "sim/score/low_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gauntlet::sim {
namespace {

constexpr double kAttenuation_db = 80.0;

/// The filter's transform, which is real because the weights are symmetric.
std::vector<double> Response(const LowPass& low_pass, int size, Fourier& fourier) {
  Fourier::Values values(size);
  values[0] = low_pass.weights[0];
  for (int n = 1; n <= low_pass.reach(); ++n) {
    values[n] += low_pass.weights[n];
    values[size - n] += low_pass.weights[n];
  }
  fourier.Forward(values);
  std::vector<double> response(size);
  for (int k = 0; k < size; ++k) response[k] = values[k].real();
  return response;
}

}  // namespace

LowPass DesignLowPass(double cutoff_hz, double transition_hz, double rate_hz) {
  // Kaiser's rules for the length and for the shape of the window.
  const double transition_rad = 2.0 * std::numbers::pi * transition_hz / rate_hz;
  const int reach =
      static_cast<int>(std::ceil(0.5 * (kAttenuation_db - 7.95) / (2.285 * transition_rad)));
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

  // The transform may wrap around: it spoils only rows that the filter's reach takes away anyhow.
  const int size = FastTransformSize(samples);
  std::vector<double> response = Response(low_pass, size, fourier);
  if (band == Band::kAbove) {
    for (double& gain : response) gain = 1.0 - gain;
  }
  Fourier::Values values;
  for (int a = 0; a < channels; a += 2) {  // two real channels in one complex transform
    const int b = std::min(a + 1, channels - 1);
    values.assign(size, 0.0);
    // A value that is not finite spoils its own channel, not the one that shares the transform.
    const bool good_a = signal.col(a).allFinite();
    const bool good_b = signal.col(b).allFinite();
    for (int n = 0; n < samples; ++n) {
      values[n] = {good_a ? signal(n, a) : 0.0, good_b ? signal(n, b) : 0.0};
    }
    fourier.Forward(values);
    for (int k = 0; k < size; ++k) values[k] *= response[k];
    fourier.Inverse(values);
    for (int n = 0; n < rows; ++n) {
      result.values(n, a) = values[n + reach].real();
      result.values(n, b) = values[n + reach].imag();
    }
    if (!good_a) result.values.col(a).setConstant(std::numeric_limits<double>::quiet_NaN());
    if (!good_b) result.values.col(b).setConstant(std::numeric_limits<double>::quiet_NaN());
    TrimSignals();
  }
  return result;
}

}  // namespace gauntlet::sim
