#include "sim/score/delay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

using Values = Fourier::Values;

/// Longer than any delay a person could work with, and what a mean over 4 s would cost.
constexpr double kLargestDelay_s = 2.0;
/// An overlap that holds less of a signal's variance than this says nothing about its delay.
constexpr double kSmallestOverlapVariance = 0.1;
/// Stands for the coefficient of such an overlap; below any that there is.
constexpr double kNothingSaid = -2.0;

double Mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Sums over the part of a signal that overlaps.
struct Moments {
  double sum = 0.0;
  double squares = 0.0;

  void Remove(double value) {
    sum -= value;
    squares -= value * value;
  }
  double Variation(int count) const { return squares - sum * sum / count; }
};

/// A signal without its mean.
struct Centred {
  explicit Centred(std::span<const double> signal) : values(signal), mean(Mean(signal)) {}

  std::span<const double> values;
  double mean;
  Moments moments;  // of the whole

  double operator[](int n) const { return values[n] - mean; }
};

/// Leader and follower, and their common transform.
struct Pair {
  int samples = 0;
  int size = 0;  // of the transform
  Centred leader;
  Centred follower;
  Values spectrum;  // of the leader as real, the follower as imaginary part
};

Pair Transform(std::span<const double> leader, std::span<const double> follower, int largest_lag,
               Fourier& fourier) {
  const int samples = static_cast<int>(leader.size());
  Pair pair{.samples = samples,
            .size = FastTransformSize(samples + largest_lag),  // lags must not wrap around
            .leader = Centred(leader),
            .follower = Centred(follower),
            .spectrum = {}};
  pair.spectrum.resize(pair.size);
  for (int n = 0; n < pair.samples; ++n) {
    const double x = pair.leader[n];
    const double y = pair.follower[n];
    pair.spectrum[n] = {x, y};
    pair.leader.moments.sum += x;
    pair.leader.moments.squares += x * x;
    pair.follower.moments.sum += y;
    pair.follower.moments.squares += y * y;
  }
  fourier.Forward(pair.spectrum);
  return pair;
}

/// Splits the common transform: the spectrum of a real signal has X[-k] = conj(X[k]).
std::complex<double> LeaderBin(const Pair& pair, int k) {
  const auto mirrored = std::conj(pair.spectrum[k == 0 ? 0 : pair.size - k]);
  return 0.5 * (pair.spectrum[k] + mirrored);
}
std::complex<double> FollowerBin(const Pair& pair, int k) {
  const auto mirrored = std::conj(pair.spectrum[k == 0 ? 0 : pair.size - k]);
  const auto difference = pair.spectrum[k] - mirrored;
  return {0.5 * difference.imag(), -0.5 * difference.real()};  // times 1/(2i)
}

/// Period of the strongest of the frequencies k / size above 0, in samples.
template <class Bin>
double StrongestPeriod(int size, const Bin& bin) {
  int strongest = 1;
  double power = 0.0;
  for (int k = 1; k <= size / 2; ++k) {
    const double candidate = std::norm(bin(k));
    if (candidate > power) {
      power = candidate;
      strongest = k;
    }
  }
  return static_cast<double>(size) / strongest;
}

/// products[lag] = sum over n of leader[n] follower[n + lag]; negative lags from the end. Takes the
/// place of the pair's spectrum: in a long trial that is large.
Values CrossProducts(Pair& pair, Fourier& fourier) {
  const auto product = [&pair](int k) {
    return std::conj(LeaderBin(pair, k)) * FollowerBin(pair, k);
  };
  pair.spectrum[0] = product(0);
  for (int k = 1; k <= pair.size - k; ++k) {  // a bin needs its mirror image
    const auto lower = product(k);
    pair.spectrum[pair.size - k] = product(pair.size - k);
    pair.spectrum[k] = lower;
  }
  fourier.Inverse(pair.spectrum);
  return std::move(pair.spectrum);
}

/// Pearson's coefficient at lags -bound .. bound; kNothingSaid where the overlap says nothing.
std::vector<double> Correlations(const Pair& pair, const Values& products, int bound) {
  std::vector<double> result(2 * bound + 1, kNothingSaid);
  const int samples = pair.samples;
  for (const int direction : {1, -1}) {
    Moments leader = pair.leader.moments;
    Moments follower = pair.follower.moments;
    for (int lag = 0; lag <= bound; ++lag) {
      if (lag > 0) {  // a late follower loses its first samples, the leader its last
        const int first = lag - 1;
        const int last = samples - lag;
        leader.Remove(pair.leader[direction > 0 ? last : first]);
        follower.Remove(pair.follower[direction > 0 ? first : last]);
      }
      const int count = samples - lag;
      const double x = leader.Variation(count);
      const double y = follower.Variation(count);
      if (x < kSmallestOverlapVariance * pair.leader.moments.squares) continue;
      if (y < kSmallestOverlapVariance * pair.follower.moments.squares) continue;
      const int at = direction > 0 || lag == 0 ? lag : pair.size - lag;
      const double covariation = products[at].real() - leader.sum * follower.sum / count;
      result[bound + direction * lag] = covariation / std::sqrt(x * y);
    }
  }
  return result;
}

}  // namespace

double DominantPeriod(std::span<const double> signal, Fourier& fourier) {
  std::vector<double> padded(FastTransformSize(static_cast<int>(signal.size())));
  std::ranges::copy(signal, padded.begin());
  Values spectrum;
  fourier.Forward(padded, spectrum);
  return StrongestPeriod(static_cast<int>(padded.size()), [&](int k) { return spectrum[k]; });
}

double ParabolaPeak(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
}

std::optional<double> DelaySamples(std::span<const double> leader, std::span<const double> follower,
                                   double rate_hz, Fourier& fourier) {
  const int samples = static_cast<int>(leader.size());
  const int largest_lag = std::min(samples / 4, static_cast<int>(kLargestDelay_s * rate_hz));
  if (largest_lag < 2) return std::nullopt;
  Pair pair = Transform(leader, follower, largest_lag, fourier);
  const double still = kStillRms_rad * kStillRms_rad * samples;
  if (!(pair.leader.moments.squares > still)) return std::nullopt;
  if (!(pair.follower.moments.squares > still)) return std::nullopt;

  const double period = StrongestPeriod(pair.size, [&pair](int k) { return LeaderBin(pair, k); });
  const int bound = std::min(largest_lag, static_cast<int>(0.5 * period));
  const auto correlations = Correlations(pair, CrossProducts(pair, fourier), bound);
  const auto peak = std::max_element(correlations.begin(), correlations.end());
  const bool at_the_bound = peak == correlations.begin() || peak + 1 == correlations.end();
  if (at_the_bound || !(*peak > 0.0)) return std::nullopt;
  // Beside an overlap that says nothing the largest coefficient is an end, too, and no peak.
  if (peak[-1] == kNothingSaid || peak[1] == kNothingSaid) return std::nullopt;
  const double lag = static_cast<double>(peak - correlations.begin()) - bound;
  return lag + ParabolaPeak(peak[-1], peak[0], peak[1]);
}

double AlignedRms(std::span<const double> leader, std::span<const double> follower,
                  double delay_samples) {
  const int samples = static_cast<int>(leader.size());
  const double whole = std::floor(delay_samples);
  const int lag = static_cast<int>(whole);
  const double fraction = delay_samples - whole;
  const int begin = std::max(0, -lag);
  const int end = std::min(samples, samples - lag - 1);
  if (end <= begin) return std::numeric_limits<double>::quiet_NaN();
  double squares = 0.0;
  for (int n = begin; n < end; ++n) {
    const double now = follower[n + lag];
    const double error = now + fraction * (follower[n + lag + 1] - now) - leader[n];
    squares += error * error;
  }
  return std::sqrt(squares / (end - begin));
}

}  // namespace gauntlet::sim
