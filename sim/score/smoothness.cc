#include "sim/score/smoothness.h"

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>

#include "controller/assert.h"
#include "sim/score/low_pass.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

constexpr int kPaddingLevel = 4;
constexpr double kLargestFrequency_hz = 10.0;
constexpr double kAmplitudeThreshold = 0.05;
constexpr double kProfileRate_hz = 100.0;
constexpr double kCutoff_hz = 20.0;
constexpr double kTransition_hz = 20.0;
constexpr double kShortestMovement_s = 0.2;

/// Low pass and derivative in one: v[n] = sum over k of weight_k x[n - reach + k].
Eigen::VectorXd DerivativeWeights(const LowPass& low_pass, double rate_hz) {
  const int reach = low_pass.reach() + 1;
  const auto low = [&](int n) { return std::abs(n) < reach ? low_pass.weights[std::abs(n)] : 0.0; };
  Eigen::VectorXd weights(2 * reach + 1);
  for (int k = -reach; k <= reach; ++k) {
    weights[reach + k] = 0.5 * rate_hz * (low(k - 1) - low(k + 1));
  }
  return weights;
}

/// The hand's velocity in one movement, every `step` ticks from the movement's own begin on: the
/// grid has no phase of its own. Empty where the filter reaches beyond what counts.
std::vector<double> VelocityIn(const Movement& movement, std::span<const double> angle,
                               const Eigen::VectorXd& weights, double delay_ticks, int step) {
  const Eigen::Map<const Eigen::VectorXd> signal(angle.data(),
                                                 static_cast<Eigen::Index>(angle.size()));
  const Eigen::Index reach = weights.size() / 2;
  const Eigen::Index begin = movement.begin + std::lround(delay_ticks) - reach;
  const auto count = static_cast<Eigen::Index>(
      std::lround((movement.end - movement.begin) / static_cast<double>(step)));
  std::vector<double> velocity;
  const TickRange& within = movement.within;
  if (begin < within.begin || begin + (count - 1) * step + weights.size() > within.end) {
    return velocity;
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    velocity.push_back(weights.dot(signal.segment(begin + i * step, weights.size())));
  }
  return velocity;
}

}  // namespace

double SpectralArcLength(std::span<const double> speed, double rate_hz, Fourier& fourier) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  const std::size_t size = std::bit_ceil(speed.size()) << kPaddingLevel;
  std::vector<double> padded(size);
  std::copy(speed.begin(), speed.end(), padded.begin());
  Fourier::Values spectrum;
  fourier.Forward(padded, spectrum);

  double largest_power = 0.0;  // over all frequencies, as in the source
  for (const auto& value : spectrum) largest_power = std::max(largest_power, std::norm(value));
  if (!(largest_power > 0.0)) return kNoScore;
  const double step_hz = rate_hz / static_cast<double>(size);
  std::vector<double> amplitude;
  std::size_t first = size;
  std::size_t last = 0;
  for (std::size_t k = 0; k <= size / 2 && static_cast<double>(k) * step_hz <= kLargestFrequency_hz;
       ++k) {
    amplitude.push_back(std::sqrt(std::norm(spectrum[k]) / largest_power));
    if (amplitude.back() < kAmplitudeThreshold) continue;
    first = std::min(first, k);
    last = k;
  }
  if (first >= last) return kNoScore;
  const double step = 1.0 / static_cast<double>(last - first);
  double length = 0.0;
  for (std::size_t k = first; k < last; ++k) {
    const double rise = amplitude[k + 1] - amplitude[k];
    length += std::sqrt(step * step + rise * rise);
  }
  return -length;
}

double LogDimensionlessJerk(std::span<const double> speed, double rate_hz) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  if (speed.size() < 3) return kNoScore;
  double peak = 0.0;
  for (const double value : speed) peak = std::max(peak, std::abs(value));
  double squares = 0.0;
  for (std::size_t n = 2; n < speed.size(); ++n) {
    const double jerk = (speed[n] - 2.0 * speed[n - 1] + speed[n - 2]) * rate_hz * rate_hz;
    squares += jerk * jerk;
  }
  const double duration_s = static_cast<double>(speed.size()) / rate_hz;
  const double jerk_integral = squares / rate_hz;
  if (!(peak > 0.0) || !(jerk_integral > 0.0)) return kNoScore;
  return -std::log(duration_s * duration_s * duration_s / (peak * peak) * jerk_integral);
}

Smoothness MovementSmoothness(std::span<const double> hand_angle_rad, double rate_hz,
                              std::span<const Movement> movements, double delay_samples,
                              Fourier& fourier) {
  if (rate_hz <= 2.0 * kCutoff_hz + kTransition_hz) return {kNoScore, kNoScore};
  const Eigen::VectorXd weights =
      DerivativeWeights(DesignLowPass(kCutoff_hz, kTransition_hz, rate_hz), rate_hz);
  const int step = std::max(1, static_cast<int>(std::lround(rate_hz / kProfileRate_hz)));
  const double profile_rate_hz = rate_hz / step;
  const auto shortest = static_cast<std::size_t>(kShortestMovement_s * profile_rate_hz);
  double sparc = 0.0;
  double ldlj = 0.0;
  int count = 0;
  for (const Movement& movement : movements) {
    const auto velocity = VelocityIn(movement, hand_angle_rad, weights, delay_samples, step);
    if (velocity.size() < shortest) continue;
    const double arc = SpectralArcLength(velocity, profile_rate_hz, fourier);
    const double jerk = LogDimensionlessJerk(velocity, profile_rate_hz);
    if (!std::isfinite(arc) || !std::isfinite(jerk)) continue;  // the hand stood quite still
    sparc += arc;
    ldlj += jerk;
    ++count;
  }
  if (count == 0) return {kNoScore, kNoScore};
  return {sparc / count, ldlj / count};
}

}  // namespace gauntlet::sim
