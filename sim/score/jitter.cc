#include "sim/score/jitter.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace gauntlet::sim {
namespace {

constexpr double kCutoff_hz = 10.0;
constexpr double kTransition_hz = 4.0;  // from stop band to pass band, centred on the cutoff
constexpr double kAttenuation_db = 80.0;

/// Weights of the low pass at offsets 0 .. n; symmetric; they sum to 1 over both sides.
std::vector<double> LowPassKernel(double rate_hz) {
  // Kaiser's design rules for the length and the window's shape.
  const double transition_rad = 2.0 * std::numbers::pi * kTransition_hz / rate_hz;
  const int half =
      static_cast<int>(std::ceil(0.5 * (kAttenuation_db - 7.95) / (2.285 * transition_rad)));
  const double beta = 0.1102 * (kAttenuation_db - 8.7);

  std::vector<double> weights(half + 1);
  const double cutoff_rad = 2.0 * std::numbers::pi * kCutoff_hz / rate_hz;
  double sum = 0.0;
  for (int n = 0; n <= half; ++n) {
    const double position = static_cast<double>(n) / half;
    const double window = std::cyl_bessel_i(0.0, beta * std::sqrt(1.0 - position * position));
    const double sinc = n == 0 ? cutoff_rad : std::sin(cutoff_rad * n) / n;
    weights[n] = window * sinc;
    sum += (n == 0 ? 1.0 : 2.0) * weights[n];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// The kernel's transform, which is real because the kernel is symmetric.
std::vector<double> Response(const std::vector<double>& kernel, int size, Fourier& fourier) {
  Fourier::Values values(size);
  values[0] = kernel[0];
  for (int n = 1; n < static_cast<int>(kernel.size()); ++n) {
    values[n] += kernel[n];
    values[size - n] += kernel[n];
  }
  fourier.Forward(values);
  std::vector<double> response(size);
  for (int k = 0; k < size; ++k) response[k] = values[k].real();
  return response;
}

}  // namespace

Trembling HighPass(const Signal& angle_rad, double rate_hz, Fourier& fourier) {
  Trembling result;
  const int samples = static_cast<int>(angle_rad.rows());
  const int channels = static_cast<int>(angle_rad.cols());
  result.angle_rad.resize(0, channels);
  if (rate_hz <= 2.0 * (kCutoff_hz + 0.5 * kTransition_hz)) return result;
  const std::vector<double> kernel = LowPassKernel(rate_hz);
  const int reach = static_cast<int>(kernel.size()) - 1;
  const int rows = samples - 2 * reach;
  if (rows < rate_hz / kCutoff_hz) return result;  // not one period of the slowest trembling

  // The transform may wrap around: it spoils only rows that the kernel's reach takes away anyhow.
  const int size = FastTransformSize(samples);
  const std::vector<double> response = Response(kernel, size, fourier);
  result.first_sample = reach;
  result.angle_rad.resize(rows, channels);
  Fourier::Values values(size);
  for (int a = 0; a < channels; a += 2) {  // two real channels in one complex transform
    const int b = std::min(a + 1, channels - 1);
    values.assign(size, 0.0);
    for (int n = 0; n < samples; ++n) values[n] = {angle_rad(n, a), angle_rad(n, b)};
    fourier.Forward(values);
    for (int k = 0; k < size; ++k) values[k] *= 1.0 - response[k];
    fourier.Inverse(values);
    for (int n = 0; n < rows; ++n) {
      result.angle_rad(n, a) = values[n + reach].real();
      result.angle_rad(n, b) = values[n + reach].imag();
    }
  }
  return result;
}

}  // namespace gauntlet::sim
