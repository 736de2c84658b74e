#include "sim/score/wearer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "controller/assert.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

constexpr double kRestSpeed_rad_s = 5.0 * kRadPerDeg;
constexpr double kFastSpeed_rad_s = 60.0 * kRadPerDeg;
constexpr double kShortestRest_s = 0.3;
constexpr double kSettling_s = 0.5;
constexpr double kOnset_s = 0.3;
constexpr double kReversal_s = 0.15;  // to either side
constexpr double kSpeedReach_s = 0.005;
constexpr double kSmallestMovement_rad = 5.0 * kRadPerDeg;

enum Class : std::uint8_t { kRestClass, kSlowClass, kFastClass };

/// Rest, slow or fast, sample by sample. Long slowness is rest, short slowness is not.
std::vector<Class> ClassifyBySpeed(std::span<const double> angle, double rate_hz) {
  const int samples = static_cast<int>(angle.size());
  const int reach = std::max(1, static_cast<int>(std::lround(kSpeedReach_s * rate_hz)));
  const int shortest_rest = static_cast<int>(std::lround(kShortestRest_s * rate_hz));
  std::vector<Class> classes(angle.size());
  int still_since = 0;
  for (int n = 0; n <= samples; ++n) {
    if (n < samples) {
      const int before = std::max(0, n - reach);
      const int after = std::min(samples - 1, n + reach);
      const double time_s = std::max(1, after - before) / rate_hz;
      const double speed = std::abs(angle[after] - angle[before]) / time_s;
      classes[n] = speed < kRestSpeed_rad_s    ? kRestClass
                   : speed >= kFastSpeed_rad_s ? kFastClass
                                               : kSlowClass;
      if (classes[n] == kRestClass) continue;
    }
    if (n - still_since < shortest_rest) {
      std::fill(classes.begin() + still_since, classes.begin() + n, kSlowClass);
    }
    still_since = n + 1;
  }
  return classes;
}

/// Stretches of one class.
std::vector<TickRange> Stretches(const std::vector<Class>& classes, Class wanted) {
  std::vector<TickRange> ranges;
  const int samples = static_cast<int>(classes.size());
  for (int n = 0; n < samples; ++n) {
    if (classes[n] != wanted) continue;
    if (ranges.empty() || ranges.back().end != n) ranges.push_back({n, n});
    ranges.back().end = n + 1;
  }
  return ranges;
}

/// Ticks at which the direction changes for good: by more than the smallest movement. With both
/// ends.
std::vector<int> TurningPoints(std::span<const double> angle, TickRange range) {
  std::vector<int> points{range.begin};
  int lowest = range.begin;
  int highest = range.begin;
  int direction = 0;
  for (int n = range.begin; n < range.end; ++n) {
    if (angle[n] < angle[lowest]) lowest = n;
    if (angle[n] > angle[highest]) highest = n;
    if (direction >= 0 && angle[n] < angle[highest] - kSmallestMovement_rad) {
      if (highest > points.back()) points.push_back(highest);
      direction = -1;
      lowest = n;
    } else if (direction <= 0 && angle[n] > angle[lowest] + kSmallestMovement_rad) {
      if (lowest > points.back()) points.push_back(lowest);
      direction = 1;
      highest = n;
    }
  }
  points.push_back(direction > 0 ? highest : direction < 0 ? lowest : range.end - 1);
  return points;
}

/// All that is not rest.
std::vector<TickRange> Moving(const std::vector<Class>& classes) {
  std::vector<TickRange> ranges;
  int begin = 0;
  for (const TickRange& rest : Stretches(classes, kRestClass)) {
    if (rest.begin > begin) ranges.push_back({begin, rest.begin});
    begin = rest.end;
  }
  const int samples = static_cast<int>(classes.size());
  if (begin < samples) ranges.push_back({begin, samples});
  return ranges;
}

std::vector<Movement> FindMovements(std::span<const double> angle,
                                    const std::vector<Class>& classes) {
  std::vector<Movement> movements;
  for (const TickRange& range : Moving(classes)) {
    const std::vector<int> points = TurningPoints(angle, range);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Movement movement{.begin = points[i],
                              .end = points[i + 1],
                              .from_rad = angle[points[i]],
                              .to_rad = angle[points[i + 1]],
                              .from_rest = i == 0 && range.begin > 0};
      if (movement.amplitude_rad() >= kSmallestMovement_rad) movements.push_back(movement);
    }
  }
  return movements;
}

/// Labels win over the speed for the samples they cover.
void ApplyLabels(std::span<const Segment> segments, std::vector<Class>& classes) {
  const int samples = static_cast<int>(classes.size());
  for (const Segment& segment : segments) {
    const Class label = segment.label == "rest"   ? kRestClass
                        : segment.label == "slow" ? kSlowClass
                                                  : kFastClass;
    if (label == kFastClass && segment.label != "fast") continue;
    const int begin = std::clamp(segment.begin, 0, samples);
    const int end = std::clamp(segment.end, begin, samples);
    std::fill(classes.begin() + begin, classes.begin() + end, label);
  }
}

std::vector<TickRange> Labelled(std::span<const Segment> segments, std::string_view label,
                                int samples) {
  std::vector<TickRange> ranges;
  for (const Segment& segment : segments) {
    if (segment.label != label) continue;
    const int begin = std::clamp(segment.begin, 0, samples);
    const int end = std::clamp(segment.end, begin, samples);
    if (end > begin) ranges.push_back({begin, end});
  }
  return ranges;
}

std::vector<TickRange> Onsets(const std::vector<Movement>& movements, int length, int samples) {
  std::vector<TickRange> ranges;
  for (const Movement& movement : movements) {
    if (!movement.from_rest) continue;
    ranges.push_back({movement.begin, std::min(samples, movement.begin + length)});
  }
  return ranges;
}

std::vector<TickRange> Reversals(const std::vector<Movement>& movements, int reach, int samples) {
  std::vector<TickRange> ranges;
  for (std::size_t i = 1; i < movements.size(); ++i) {
    if (movements[i].begin != movements[i - 1].end) continue;  // a rest or a pause lies between
    int begin = std::max(0, movements[i].begin - reach);
    if (!ranges.empty()) begin = std::max(begin, ranges.back().end);  // count no sample twice
    ranges.push_back({begin, std::min(samples, movements[i].begin + reach)});
  }
  return ranges;
}

}  // namespace

WearerMotion AnalyseWearer(std::span<const double> angle_rad, double rate_hz,
                           std::span<const Segment> segments) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  const int samples = static_cast<int>(angle_rad.size());
  const auto in_samples = [&](double time_s) {
    return static_cast<int>(std::lround(time_s * rate_hz));
  };
  WearerMotion motion;
  const auto of = [&](Regime regime) -> std::vector<TickRange>& {
    return motion.regimes[static_cast<int>(regime)];
  };

  std::vector<Class> classes = ClassifyBySpeed(angle_rad, rate_hz);
  motion.movements = FindMovements(angle_rad, classes);
  for (Movement& movement : motion.movements) movement.within = {0, samples};

  ApplyLabels(segments, classes);
  for (TickRange rest : Stretches(classes, kRestClass)) {
    rest.begin += in_samples(kSettling_s);
    if (rest.begin < rest.end) of(Regime::kRest).push_back(rest);
  }
  of(Regime::kSlow) = Stretches(classes, kSlowClass);
  of(Regime::kFast) = Stretches(classes, kFastClass);
  of(Regime::kOnset) = Labelled(segments, "onset", samples);
  if (of(Regime::kOnset).empty()) {
    of(Regime::kOnset) = Onsets(motion.movements, in_samples(kOnset_s), samples);
  }
  of(Regime::kReversal) = Labelled(segments, "reversal", samples);
  if (of(Regime::kReversal).empty()) {
    of(Regime::kReversal) = Reversals(motion.movements, in_samples(kReversal_s), samples);
  }
  return motion;
}

WearerMotion AnalyseWearer(std::span<const double> angle_rad, double rate_hz,
                           std::span<const Segment> segments, const CountedTicks& counted) {
  GAUNTLET_ASSERT(AreWithin(counted, std::ssize(angle_rad)));
  WearerMotion all;
  for (const TickRange& range : counted) {
    std::vector<Segment> labels(segments.begin(), segments.end());
    for (Segment& label : labels) {
      label.begin -= range.begin;
      label.end -= range.begin;
    }
    WearerMotion part =
        AnalyseWearer(angle_rad.subspan(range.begin, range.end - range.begin), rate_hz, labels);
    for (Movement& movement : part.movements) {
      movement.begin += range.begin;
      movement.end += range.begin;
      movement.within = range;
      all.movements.push_back(movement);
    }
    for (int regime = 0; regime < kRegimeCount; ++regime) {
      for (const TickRange& found : part.regimes[regime]) {
        all.regimes[regime].push_back({found.begin + range.begin, found.end + range.begin});
      }
    }
  }
  return all;
}

}  // namespace gauntlet::sim
