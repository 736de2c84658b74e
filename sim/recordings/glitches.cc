#include "sim/recordings/glitches.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/quantile.h"

namespace gauntlet::sim {
namespace {

constexpr double kJump = 0.25;              // of the joint's range, at least
constexpr double kReturn = 0.10;            // of the joint's range
constexpr double kFastestPerSecond = 12.5;  // joint's ranges
constexpr std::size_t kLongestRun = 2;      // values
constexpr std::size_t kCalmRun = 3;         // values beside a run at the end of a file

// Excursions that are smaller or last longer.
constexpr double kSmallestExcursion = 0.14;  // of the joint's range
constexpr double kStart = 0.02;              // likewise: less is not the begin of one
constexpr double kHandPerSecond = 14.0;      // joint's ranges: no movement is as fast
constexpr double kReturnShare = 0.35;        // of the excursion: so far it may end from its begin
constexpr double kUsualShare = 0.95;         // of rows
constexpr double kOfOwnMotion = 4.0;
constexpr double kOfOwnNoise = 8.0;
constexpr std::size_t kFewest = 30;  // values, to know a channel's own motion and noise
constexpr std::size_t kLongestExcursion = 12;
constexpr double kLongestExcursion_s = 0.12;

/// A good value, in shares of the joint's range.
struct Sample {
  std::size_t place = 0;
  double time_s = 0.0;
  double value = 0.0;
};

bool Agree(std::span<const Sample> samples) {
  const auto [low, high] = std::ranges::minmax_element(samples, {}, &Sample::value);
  return high->value - low->value < kReturn;
}

/// True if the run lies far from a neighbour, and farther than a hand gets from it to `nearest`.
bool JumpsFrom(const Sample& neighbour, std::span<const Sample> run, const Sample& nearest,
               double least_jump) {
  const double seconds = std::abs(nearest.time_s - neighbour.time_s);
  return std::abs(nearest.value - neighbour.value) > kFastestPerSecond * seconds &&
         std::ranges::all_of(run, [&](const Sample& sample) {
           return std::abs(sample.value - neighbour.value) > least_jump;
         });
}

/// Usual steps of the channel from one value to the next, in shares of the joint's range.
struct OwnMotion {
  double step = 0.0;   // of motion that goes on: the smaller of two steps in one direction
  double noise = 0.0;  // standard deviation

  double largest() const {
    return std::max({kSmallestExcursion, kOfOwnMotion * step, kOfOwnNoise * noise});
  }
};

OwnMotion MotionOf(std::span<const Sample> samples) {
  if (samples.size() < kFewest) return {};
  std::vector<double> steps;
  std::vector<double> bends;
  for (std::size_t i = 2; i < samples.size(); ++i) {
    const double first = samples[i - 1].value - samples[i - 2].value;
    const double second = samples[i].value - samples[i - 1].value;
    steps.push_back(first * second > 0.0 ? std::min(std::abs(first), std::abs(second)) : 0.0);
    bends.push_back(std::abs(second - first));
  }
  // White noise of deviation s bends three rows by s sqrt(1 + 4 + 1); half of it by 0.6745 of that.
  return {.step = Quantile(std::move(steps), kUsualShare),
          .noise = Quantile(std::move(bends), 0.5) / (0.6745 * std::sqrt(6.0))};
}

/// True if the run between two good values leaves the line between them and comes back, farther and
/// faster than this hand does.
bool IsExcursion(const Sample& before, std::span<const Sample> run, const Sample& behind,
                 const OwnMotion& own) {
  const double seconds = behind.time_s - before.time_s;
  const double way = behind.value - before.value;
  const double side = run.front().value > before.value ? 1.0 : -1.0;
  double peak = 0.0;
  for (const Sample& sample : run) {
    const double line = before.value + way * (sample.time_s - before.time_s) / seconds;
    const double beyond = side * (sample.value - line);
    if (beyond <= 0.0) return false;
    peak = std::max(peak, beyond);
  }
  if (peak <= own.largest()) return false;
  const double drift = 3.0 * own.noise + own.step * static_cast<double>(run.size() + 1);
  if (std::abs(way) > std::max(kReturnShare * peak, drift)) return false;
  const auto jumps = [&](const Sample& good, const Sample& wild) {
    const double jump = side * (wild.value - good.value);
    return jump > own.largest() && jump > kHandPerSecond * std::abs(wild.time_s - good.time_s);
  };
  return (jumps(before, run.front()) && jumps(behind, run.back())) ||
         peak > kHandPerSecond * 0.5 * seconds;
}

/// How many values from here on are one excursion; 0: none. It is no longer than what is good
/// before it.
std::size_t LengthOfExcursion(std::span<const Sample> good, std::span<const Sample> from_here,
                              const OwnMotion& own) {
  if (good.empty()) return 0;
  const Sample& before = good.back();
  const std::size_t longest = std::min(kLongestExcursion, good.size());
  const double first = std::abs(from_here.front().value - before.value);
  if (first <= std::max(kStart, 3.0 * own.noise)) return 0;
  for (std::size_t length = 1; length <= longest && length < from_here.size(); ++length) {
    const Sample& behind = from_here[length];
    const double lasts_s = from_here[length - 1].time_s - from_here.front().time_s;
    if (length > kLongestRun && lasts_s > kLongestExcursion_s) return 0;
    if (IsExcursion(before, from_here.first(length), behind, own)) return length;
  }
  return 0;
}

/// `before` are the good values before the run, `behind` those that follow it.
bool IsGlitch(std::span<const Sample> before, std::span<const Sample> run,
              std::span<const Sample> behind, double least_jump, StretchEnds ends) {
  if (!before.empty() && !JumpsFrom(before.back(), run, run.front(), least_jump)) return false;
  if (!behind.empty() && !JumpsFrom(behind.front(), run, run.back(), least_jump)) return false;
  if (before.empty()) {
    return ends.at_first_row && behind.size() >= kCalmRun && Agree(behind.first(kCalmRun));
  }
  if (behind.empty()) {
    return ends.at_last_row && before.size() >= kCalmRun && Agree(before.last(kCalmRun));
  }
  return std::abs(before.back().value - behind.front().value) < kReturn;
}

}  // namespace

std::vector<std::size_t> FindGlitches(std::span<const double> time_s, std::span<const double> value,
                                      double range, StretchEnds ends) {
  std::vector<Sample> samples;
  samples.reserve(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (std::isfinite(value[i])) samples.push_back({i, time_s[i], value[i] / range});
  }
  std::vector<std::size_t> places;
  const std::span<Sample> all(samples);
  const OwnMotion own = MotionOf(all);
  const double least_jump = std::max(kJump, own.largest());
  std::size_t kept = 0;  // so many of the first samples are the good ones found so far
  for (std::size_t i = 0; i < all.size();) {
    std::size_t wild = LengthOfExcursion(all.first(kept), all.subspan(i), own);
    for (std::size_t length = 1; wild == 0 && length <= kLongestRun; ++length) {
      if (i + length > all.size()) break;
      if (IsGlitch(all.first(kept), all.subspan(i, length), all.subspan(i + length), least_jump,
                   ends)) {
        wild = length;
      }
    }
    if (wild == 0) {
      all[kept++] = all[i++];
      continue;
    }
    for (const Sample& sample : all.subspan(i, wild)) places.push_back(sample.place);
    i += wild;
  }
  return places;
}

}  // namespace gauntlet::sim
