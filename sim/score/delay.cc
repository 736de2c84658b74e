#include "sim/score/delay.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "controller/assert.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

using Values = Fourier::Values;

/// Search range for a motion that does not repeat: lags from so long before the earliest to so long
/// after it.
constexpr double kBefore_s = 0.1;
constexpr double kAfter_s = 1.0;
/// The lags of a period begin so long before the earliest, which may be the delay: no end of a
/// range is.
constexpr double kBeforePeriod_s = 0.01;
constexpr double kSideRate_hz = 100.0;  // of the autocorrelation; hands move below 10 Hz
constexpr double kLeastSidePeak = 0.5;
/// The second side peak lies within this share of the period of twice the period.
constexpr double kSecondSidePeakWithin = 0.15;
/// A maximum is flat if correlations so near to it are so far from each other.
constexpr double kFlatWithin = 1e-4;
constexpr double kFlatFrom_s = 0.06;
/// Two maxima so near to each other are not told apart.
constexpr double kSecondWithin = 0.02;
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

/// A counted range of leader and follower.
struct Pair {
  int samples = 0;
  Centred leader;
  Centred follower;
};

Pair WithMoments(Centred leader, Centred follower) {
  GAUNTLET_ASSERT(leader.values.size() == follower.values.size());
  Pair pair{
      .samples = static_cast<int>(leader.values.size()), .leader = leader, .follower = follower};
  for (int n = 0; n < pair.samples; ++n) {
    pair.leader.moments.Add(pair.leader[n]);
    pair.follower.moments.Add(pair.follower[n]);
  }
  return pair;
}

// The common transform is Z = X + i Y of the leader's X and the follower's Y. The spectrum of a
// real signal has X[-k] = conj(X[k]), so that with a = Z[k] and b = Z[-k]
//     X[k] = (a + conj(b)) / 2,  Y[k] = (a - conj(b)) / 2i.

/// conj(X[k]) Y[k] = Im(a b) / 2 - i (|a|^2 - |b|^2) / 4.
std::complex<double> CrossBin(const Values& spectrum, int k) {
  const std::complex<double> a = spectrum[k];
  const std::complex<double> b = spectrum[k == 0 ? 0 : std::ssize(spectrum) - k];
  return {0.5 * (a.real() * b.imag() + a.imag() * b.real()), -0.25 * (std::norm(a) - std::norm(b))};
}

/// Longest block of a range: some 9 minutes. The transform of a whole hour takes 300 MB.
constexpr int kLongestBlock = 1 << 19;

/// Samples of each block of a range. A block has to be longer than the lags, or most of its
/// transform would be its neighbours'.
int BlockOf(int samples, int bound) {
  constexpr int kLeastBounds = 4;
  const int longest = std::max(kLongestBlock, std::min(samples, kLeastBounds * bound));
  const int blocks = std::max(1, (samples + longest - 1) / longest);
  return (samples + blocks - 1) / blocks;
}

/// Sums over n of leader[n] follower[n + lag] for lags -bound .. bound, by transforms of one block
/// of the leader at a time, with what the follower has within its lags.
std::vector<double> CrossProducts(const Pair& pair, int bound, Fourier& fourier) {
  std::vector<double> sums(2 * bound + 1);
  const int block = BlockOf(pair.samples, bound);
  // Lags must not wrap around; a block that has neighbours has lags on both sides.
  const int size = FastTransformSize(block + (block < pair.samples ? 2 : 1) * bound);
  Values spectrum;
  std::vector<double> products(size);
  for (int begin = 0; begin < pair.samples; begin += block) {
    const int end = std::min(begin + block, pair.samples);
    spectrum.assign(size, 0.0);
    for (int n = begin; n < end; ++n) spectrum[n - begin].real(pair.leader[n]);
    for (int n = std::max(0, begin - bound); n < std::min(end + bound, pair.samples); ++n) {
      spectrum[n < begin ? size + n - begin : n - begin].imag(pair.follower[n]);
    }
    fourier.Forward(spectrum);
    for (int k = 0; k <= size / 2; ++k) {  // in its place: its mirror image stays for it
      spectrum[k] = CrossBin(spectrum, k);
    }
    fourier.Inverse(spectrum, products);
    for (int lag = -bound; lag <= bound; ++lag) {
      sums[bound + lag] += products[lag < 0 ? size + lag : lag];
    }
  }
  return sums;
}

/// Overlap at one lag, of all counted ranges together.
struct AtLag {
  int count = 0;
  Moments leader;
  Moments follower;
  double product = 0.0;
};

/// Adds the sums of one range at lags -bound .. bound, of which these are the products.
void AddOverlaps(const Pair& pair, std::span<const double> products, int bound,
                 std::vector<AtLag>& sums) {
  GAUNTLET_ASSERT(std::ssize(products) == 2 * bound + 1 && std::ssize(sums) == 2 * bound + 1);
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
      at.product += products[bound + direction * lag];
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

int Length(const TickRange& range) { return range.end - range.begin; }

const TickRange& LongestOf(const CountedTicks& counted) {
  return *std::ranges::max_element(counted, {}, Length);
}

/// Pearson's coefficient at lags -bound .. bound, of all counted ranges together. Empty if one of
/// the signals is still.
std::vector<double> CorrelationsUpTo(int bound, std::span<const double> leader,
                                     std::span<const double> follower, const CountedTicks& counted,
                                     Fourier& fourier) {
  const double leader_mean = MeanOf(leader, counted);
  const double follower_mean = MeanOf(follower, counted);
  Moments leader_moments;
  Moments follower_moments;
  std::vector<AtLag> sums(2 * bound + 1);
  for (const TickRange& range : counted) {
    const Pair pair = WithMoments({.values = Part(leader, range), .mean = leader_mean},
                                  {.values = Part(follower, range), .mean = follower_mean});
    leader_moments.sum += pair.leader.moments.sum;
    leader_moments.squares += pair.leader.moments.squares;
    follower_moments.sum += pair.follower.moments.sum;
    follower_moments.squares += pair.follower.moments.squares;
    AddOverlaps(pair, CrossProducts(pair, bound, fourier), bound, sums);
  }
  const double still = kStillRms_rad * kStillRms_rad * CountOf(counted);
  if (!(leader_moments.squares > still) || !(follower_moments.squares > still)) return {};
  return Correlations(sums, leader_moments, follower_moments);
}

/// The lags among which a delay is searched.
struct LagWindow {
  int first = 0;
  int last = 0;
};

LagWindow WindowOf(std::span<const double> leader, double rate_hz, double earliest_s,
                   const CountedTicks& counted, Fourier& fourier) {
  const int most = Length(LongestOf(counted)) / 4;
  const std::optional<double> period_s = RepeatPeriod_s(leader, rate_hz, counted, fourier);
  const double first_s = earliest_s - (period_s ? kBeforePeriod_s : kBefore_s);
  const double last_s = period_s ? first_s + *period_s : earliest_s + kAfter_s;
  const auto lag_at = [&](double time_s) {
    return std::clamp(static_cast<int>(std::lround(time_s * rate_hz)), -most, most);
  };
  return {.first = lag_at(first_s), .last = lag_at(last_s)};
}

/// True if values so near to the peak are more than `apart` from each other.
bool IsFlat(std::span<const double> values, std::size_t peak, double within, double apart) {
  const auto is_near = [&](double value) { return value >= values[peak] - within; };
  const auto first = std::ranges::find_if(values, is_near);
  const auto last = std::find_if(values.rbegin(), values.rend(), is_near).base() - 1;
  return static_cast<double>(last - first) > apart;
}

/// True if there is another maximum so near to the peak, with lower values between them.
bool HasSecondPeak(std::span<const double> values, std::size_t peak, double within) {
  const double least = values[peak] - within;
  std::size_t first = peak;
  std::size_t last = peak;
  while (first > 0 && values[first - 1] >= least) --first;
  while (last + 1 < values.size() && values[last + 1] >= least) ++last;
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    if (i >= first && i <= last) continue;
    if (values[i] >= least && values[i] >= values[i - 1] && values[i] > values[i + 1]) return true;
  }
  return false;
}

}  // namespace

double ParabolaPeak(double left, double middle, double right) {
  const double curvature = left - 2.0 * middle + right;
  return curvature < 0.0 ? 0.5 * (left - right) / curvature : 0.0;
}

std::optional<double> RepeatPeriod_s(std::span<const double> motion, double rate_hz,
                                     const CountedTicks& counted, Fourier& fourier) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && AreWithin(counted, std::ssize(motion)));
  if (counted.empty()) return std::nullopt;
  const TickRange& longest = LongestOf(counted);
  const int step = std::max(1, static_cast<int>(std::lround(rate_hz / kSideRate_hz)));
  const int samples = Length(longest) / step;
  const int most = samples / 4;
  if (most < 2) return std::nullopt;
  const Eigen::Map<const Eigen::MatrixXd> blocks(motion.data() + longest.begin, step, samples);
  const Eigen::VectorXd means = blocks.colwise().mean();
  const std::span<const double> values(means.data(), static_cast<std::size_t>(samples));
  const int bound =
      std::min(samples - 1, static_cast<int>((2.0 + kSecondSidePeakWithin) * most) + 1);
  const std::vector<double> both_sides =
      CorrelationsUpTo(bound, values, values, {{0, samples}}, fourier);
  if (both_sides.empty()) return std::nullopt;
  const std::span<const double> both = std::span(both_sides).subspan(bound);
  const std::span<const double> side = both.first(most + 1);
  const auto is_high = [](double r) { return r > kLeastSidePeak; };
  const auto fallen = std::find_if_not(side.begin(), side.end(), is_high);
  const auto begin = std::find_if(fallen, side.end(), is_high);
  const auto end = std::find_if_not(begin, side.end(), is_high);
  const auto peak = std::max_element(begin, end);
  if (peak == side.end() || peak + 1 == side.end()) return std::nullopt;
  const auto period = static_cast<double>(peak - side.begin());
  const auto second_begin = static_cast<int>(std::ceil((2.0 - kSecondSidePeakWithin) * period));
  const auto second_end = static_cast<int>(std::floor((2.0 + kSecondSidePeakWithin) * period)) + 1;
  if (std::ranges::none_of(both.subspan(second_begin, second_end - second_begin), is_high)) {
    return std::nullopt;
  }
  return period * step / rate_hz;
}

std::optional<double> DelaySamples(std::span<const double> leader, std::span<const double> follower,
                                   double rate_hz, double earliest_s, const CountedTicks& counted,
                                   Fourier& fourier) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && follower.size() == leader.size());
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(leader)));
  if (counted.empty()) return std::nullopt;
  const LagWindow window = WindowOf(leader, rate_hz, earliest_s, counted, fourier);
  if (window.last - window.first < 2) return std::nullopt;
  const int bound = std::max(std::abs(window.first), std::abs(window.last));
  const std::vector<double> all = CorrelationsUpTo(bound, leader, follower, counted, fourier);
  if (all.empty()) return std::nullopt;
  const std::span<const double> r = std::span(all).subspan(
      window.first + bound, static_cast<std::size_t>(window.last - window.first + 1));
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(r) - r.begin());
  const bool at_the_edge = peak == 0 || peak + 1 == r.size();
  if (at_the_edge || !(r[peak] >= kLeastDelayCorrelation)) return std::nullopt;
  if (r[peak - 1] == kNothingSaid || r[peak + 1] == kNothingSaid) return std::nullopt;
  if (IsFlat(r, peak, kFlatWithin, kFlatFrom_s * rate_hz)) return std::nullopt;
  if (HasSecondPeak(r, peak, kSecondWithin)) return std::nullopt;
  return window.first + static_cast<double>(peak) + ParabolaPeak(r[peak - 1], r[peak], r[peak + 1]);
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
