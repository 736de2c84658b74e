#include "sim/recordings/glitches.h"

#include <algorithm>
#include <cmath>

namespace gauntlet::sim {
namespace {

constexpr double kJump = 0.25;              // of the joint's range
constexpr double kReturn = 0.10;            // of the joint's range
constexpr double kFastestPerSecond = 12.5;  // joint's ranges
constexpr std::size_t kLongestRun = 2;      // values
constexpr std::size_t kCalmRun = 3;         // values beside a run at the end of a file

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
bool JumpsFrom(const Sample& neighbour, std::span<const Sample> run, const Sample& nearest) {
  const double seconds = std::abs(nearest.time_s - neighbour.time_s);
  return std::abs(nearest.value - neighbour.value) > kFastestPerSecond * seconds &&
         std::ranges::all_of(run, [&](const Sample& sample) {
           return std::abs(sample.value - neighbour.value) > kJump;
         });
}

/// `before` are the good values before the run, `behind` those that follow it.
bool IsGlitch(std::span<const Sample> before, std::span<const Sample> run,
              std::span<const Sample> behind, StretchEnds ends) {
  if (!before.empty() && !JumpsFrom(before.back(), run, run.front())) return false;
  if (!behind.empty() && !JumpsFrom(behind.front(), run, run.back())) return false;
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
  std::size_t kept = 0;  // so many of the first samples are the good ones found so far
  for (std::size_t i = 0; i < all.size();) {
    std::size_t length = 1;
    const auto is_glitch = [&] {
      return IsGlitch(all.first(kept), all.subspan(i, length), all.subspan(i + length), ends);
    };
    while (length <= kLongestRun && i + length <= all.size() && !is_glitch()) ++length;
    if (length > kLongestRun || i + length > all.size()) {
      all[kept++] = all[i++];
      continue;
    }
    for (const Sample& sample : all.subspan(i, length)) places.push_back(sample.place);
    i += length;
  }
  return places;
}

}  // namespace gauntlet::sim
