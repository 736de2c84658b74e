#include "sim/score/delay.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/assert.h"
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

/// Mean over the counted ranges.
double MeanOf(std::span<const double> values, const CountedTicks& counted) {
  double sum = 0.0;
  for (const TickRange& range : counted) {
    for (int n = range.begin; n < range.end; ++n) sum += values[n];
  }
  return sum / CountOf(counted);
}

std::span<const double> Part(std::span<const double> values, const TickRange& range) {
  return values.subspan(range.begin, range.end - range.begin);
}

/// Sums over the part of a signal that overlaps.
struct Moments {
  double sum = 0.0;
  double squares = 0.0;

  void Remove(double value) {
    sum -= value;
    squares -= value * value;
  }
  void Add(double value) {
    sum += value;
    squares += value * value;
  }
  double Variation(int count) const { return squares - sum * sum / count; }
};

/// A counted range of a signal less the mean of all of them.
struct Centred {
  std::span<const double> values;
  double mean;
  Moments moments = {};

  double operator[](int n) const { return values[n] - mean; }
};

/// A counted range of leader and follower, and their common transform.
struct Pair {
  int samples = 0;
  int size = 0;  // of the transform
  Centred leader;
  Centred follower;
  Values spectrum;  // of the leader as real, the follower as imaginary part
};

Pair Transform(Centred leader, Centred follower, int largest_lag, Fourier& fourier) {
  GAUNTLET_ASSERT(leader.values.size() == follower.values.size());
  const int samples = static_cast<int>(leader.values.size());
  Pair pair{.samples = samples,
            .size = FastTransformSize(samples + largest_lag),  // lags must not wrap around
            .leader = leader,
            .follower = follower,
            .spectrum = {}};
  pair.spectrum.resize(pair.size);
  for (int n = 0; n < pair.samples; ++n) {
    const double x = pair.leader[n];
    const double y = pair.follower[n];
    pair.spectrum[n] = {x, y};
    pair.leader.moments.Add(x);
    pair.follower.moments.Add(y);
  }
  fourier.Forward(pair.spectrum);
  return pair;
}

// The common transform is Z = X + i Y of the leader's X and the follower's Y. The spectrum of a
// real signal has X[-k] = conj(X[k]), so that with a = Z[k] and b = Z[-k]
//     X[k] = (a + conj(b)) / 2,  Y[k] = (a - conj(b)) / 2i.
const std::complex<double>& Mirrored(const Pair& pair, int k) {
  return pair.spectrum[k == 0 ? 0 : pair.size - k];
}
std::complex<double> LeaderBin(const Pair& pair, int k) {
  return 0.5 * (pair.spectrum[k] + std::conj(Mirrored(pair, k)));
}
/// conj(X[k]) Y[k] = Im(a b) / 2 - i (|a|^2 - |b|^2) / 4.
std::complex<double> CrossBin(const Pair& pair, int k) {
  const std::complex<double> a = pair.spectrum[k];
  const std::complex<double> b = Mirrored(pair, k);
  return {0.5 * (a.real() * b.imag() + a.imag() * b.real()), -0.25 * (std::norm(a) - std::norm(b))};
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

/// products[lag] = sum over n of leader[n] follower[n + lag]; negative lags from the end. They take
/// the place of the pair's spectrum: in a long trial that is large.
std::vector<double> CrossProducts(Pair& pair, Fourier& fourier) {
  for (int k = 0; k <= pair.size / 2; ++k) {  // its mirror image stays for it
    pair.spectrum[k] = CrossBin(pair, k);
  }
  std::vector<double> products(pair.size);
  fourier.Inverse(std::move(pair.spectrum), products);
  return products;
}

/// What overlaps at one lag, of all counted ranges together.
struct AtLag {
  int count = 0;
  Moments leader;
  Moments follower;
  double product = 0.0;
};

/// Adds the sums of one range at lags -bound .. bound.
void AddOverlaps(const Pair& pair, std::span<const double> products, int bound,
                 std::vector<AtLag>& sums) {
  GAUNTLET_ASSERT(std::ssize(products) == pair.size && std::ssize(sums) == 2 * bound + 1);
  for (const int direction : {1, -1}) {
    Moments leader = pair.leader.moments;
    Moments follower = pair.follower.moments;
    for (int lag = 0; lag <= std::min(bound, pair.samples - 1); ++lag) {
      if (lag > 0) {  // a late follower loses its first samples, the leader its last
        const int first = lag - 1;
        const int last = pair.samples - lag;
        leader.Remove(pair.leader[direction > 0 ? last : first]);
        follower.Remove(pair.follower[direction > 0 ? first : last]);
      }
      if (direction < 0 && lag == 0) continue;
      AtLag& at = sums[bound + direction * lag];
      at.count += pair.samples - lag;
      at.leader.sum += leader.sum;
      at.leader.squares += leader.squares;
      at.follower.sum += follower.sum;
      at.follower.squares += follower.squares;
      at.product += products[direction > 0 || lag == 0 ? lag : pair.size - lag];
    }
  }
}

/// Pearson's coefficient at these lags; kNothingSaid where the overlap says nothing. The moments
/// are those of all that counts.
std::vector<double> Correlations(const std::vector<AtLag>& sums, const Moments& leader,
                                 const Moments& follower) {
  std::vector<double> result;
  for (const AtLag& at : sums) {
    const double x = at.leader.Variation(at.count);
    const double y = at.follower.Variation(at.count);
    const bool says_something = x >= kSmallestOverlapVariance * leader.squares &&
                                y >= kSmallestOverlapVariance * follower.squares;
    const double covariation = at.product - at.leader.sum * at.follower.sum / at.count;
    result.push_back(says_something ? covariation / std::sqrt(x * y) : kNothingSaid);
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
  return DelaySamples(leader, follower, rate_hz, {{0, samples}}, fourier);
}

std::optional<double> DelaySamples(std::span<const double> leader, std::span<const double> follower,
                                   double rate_hz, const CountedTicks& counted, Fourier& fourier) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && follower.size() == leader.size());
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(leader)));
  if (counted.empty()) return std::nullopt;
  const auto length = [](const TickRange& range) { return range.end - range.begin; };
  const auto longest = std::ranges::max_element(counted, {}, length);
  const int largest_lag =
      std::min(length(*longest) / 4, static_cast<int>(kLargestDelay_s * rate_hz));
  if (largest_lag < 2) return std::nullopt;
  const double leader_mean = MeanOf(leader, counted);
  const double follower_mean = MeanOf(follower, counted);
  const auto transform = [&](const TickRange& range) {
    return Transform({.values = Part(leader, range), .mean = leader_mean},
                     {.values = Part(follower, range), .mean = follower_mean}, largest_lag,
                     fourier);
  };
  Moments leader_moments;
  Moments follower_moments;
  int bound = 0;
  std::vector<AtLag> sums;
  const auto add = [&](Pair pair) {
    leader_moments.sum += pair.leader.moments.sum;
    leader_moments.squares += pair.leader.moments.squares;
    follower_moments.sum += pair.follower.moments.sum;
    follower_moments.squares += pair.follower.moments.squares;
    const std::vector<double> products = CrossProducts(pair, fourier);
    AddOverlaps(pair, products, bound, sums);
  };
  {
    Pair pair = transform(*longest);
    const double period = StrongestPeriod(pair.size, [&pair](int k) { return LeaderBin(pair, k); });
    bound = std::min(largest_lag, static_cast<int>(0.5 * period));
    sums.resize(2 * bound + 1);
    add(std::move(pair));
  }
  for (auto range = counted.begin(); range != counted.end(); ++range) {
    if (range != longest) add(transform(*range));
  }
  const double still = kStillRms_rad * kStillRms_rad * CountOf(counted);
  if (!(leader_moments.squares > still)) return std::nullopt;
  if (!(follower_moments.squares > still)) return std::nullopt;

  const auto correlations = Correlations(sums, leader_moments, follower_moments);
  const auto peak = std::max_element(correlations.begin(), correlations.end());
  const bool at_the_bound = peak == correlations.begin() || peak + 1 == correlations.end();
  if (at_the_bound || !(*peak >= kLeastDelayCorrelation)) return std::nullopt;
  // Beside an overlap that says nothing the largest coefficient is an end, too, and no peak.
  if (peak[-1] == kNothingSaid || peak[1] == kNothingSaid) return std::nullopt;
  const double lag = static_cast<double>(peak - correlations.begin()) - bound;
  return lag + ParabolaPeak(peak[-1], peak[0], peak[1]);
}

double AlignedRms(std::span<const double> leader, std::span<const double> follower,
                  double delay_samples, const CountedTicks& counted) {
  GAUNTLET_ASSERT(follower.size() == leader.size());
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(leader)));
  const double whole = std::floor(delay_samples);
  const int lag = static_cast<int>(whole);
  const double fraction = delay_samples - whole;
  double squares = 0.0;
  int count = 0;
  for (const TickRange& range : counted) {
    const int begin = std::max(range.begin, range.begin - lag);
    const int end = std::min(range.end, range.end - lag - 1);
    for (int n = begin; n < end; ++n) {
      const double now = follower[n + lag];
      const double error = now + fraction * (follower[n + lag + 1] - now) - leader[n];
      squares += error * error;
    }
    count += std::max(0, end - begin);
  }
  return count == 0 ? kNaN : std::sqrt(squares / count);
}

}  // namespace gauntlet::sim
