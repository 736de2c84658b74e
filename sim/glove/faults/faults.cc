#include "sim/glove/faults/faults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sim/base/random.h"
#include "sim/glove/channels.h"
#include "sim/glove/motions/motion.h"
#include "sim/glove/noise/box_muller.h"

namespace gauntlet::sim {
namespace {

// Noise and spikes are given in counts of a 10-bit converter.
constexpr double kFaultFullScaleCounts = 1023.0;

bool IsWholeFrame(FaultKind kind) {
  return kind == FaultKind::kDuplicatedFrames || kind == FaultKind::kLateFrames;
}

/// Of a fault's place in the list and a channel; -1 is the whole frame.
std::uint64_t StreamIndex(std::size_t fault, int channel) {
  return fault * 1000 + static_cast<std::uint64_t>(channel + 1);
}

double Exponential(RandomStream& random, double mean) {
  return -mean * std::log(random.UniformAboveZero());
}

/// Comes once and stays.
void AddLasting(const FaultConfig& fault, int channel, int samples, double rate_hz,
                std::vector<FaultEvent>& events) {
  const double start =
      fault.kind == FaultKind::kTimeJitter ? 0.0 : std::ceil(fault.start_s * rate_hz);
  if (start < samples) {
    events.push_back({fault.kind, channel, static_cast<int>(start), samples});
  }
}

/// Comes again and again: exponential times between the end of one and the start of the next.
void AddRepeated(const FaultConfig& fault, RandomStream random, int channel, int samples,
                 double rate_hz, std::vector<FaultEvent>& events) {
  if (fault.rate_per_s <= 0.0) return;
  for (double now = 0.0;;) {
    now += Exponential(random, rate_hz / fault.rate_per_s);
    if (now >= samples) return;
    const double length =
        fault.kind == FaultKind::kSpikes
            ? 1.0
            : std::max(1.0, Exponential(random, 1e-3 * fault.duration_ms * rate_hz));
    const double end = std::min(std::floor(now) + std::ceil(length), static_cast<double>(samples));
    events.push_back({fault.kind, channel, static_cast<int>(now), static_cast<int>(end)});
    now = end;
  }
}

void AddEvents(const FaultConfig& fault, std::size_t number, int channel, int samples,
               double rate_hz, std::uint64_t seed, std::vector<FaultEvent>& events) {
  switch (fault.kind) {
    case FaultKind::kGainChange:
    case FaultKind::kTimeJitter:
    case FaultKind::kDisconnected:
      return AddLasting(fault, channel, samples, rate_hz, events);
    default:
      return AddRepeated(fault, RandomStream(seed, "fault/when", StreamIndex(number, channel)),
                         channel, samples, rate_hz, events);
  }
}

std::vector<FaultEvent> EventsOf(const FaultConfig& fault, std::size_t number, int samples,
                                 double rate_hz, std::uint64_t seed) {
  std::vector<FaultEvent> events;
  if (IsWholeFrame(fault.kind)) {
    AddEvents(fault, number, -1, samples, rate_hz, seed, events);
    return events;
  }
  const std::vector<bool> selected = SelectChannels(fault.channels);
  for (std::size_t channel = 0; channel < selected.size(); ++channel) {
    if (!selected[channel]) continue;
    AddEvents(fault, number, static_cast<int>(channel), samples, rate_hz, seed, events);
  }
  return events;
}

/// Samples taken a little off their time: linear interpolation between what lies beside.
void JitterTime(const FaultConfig& fault, double rate_hz, RandomStream random,
                Eigen::Ref<Eigen::VectorXd> column) {
  const Eigen::VectorXd exact = column;
  const double last = static_cast<double>(exact.size() - 1);
  for (Eigen::Index i = 0; i < exact.size(); ++i) {
    const double off = 1e-3 * fault.deviation_ms * rate_hz * BoxMuller(random).first;
    const double place = std::clamp(static_cast<double>(i) + off, 0.0, last);
    const auto before = std::min(static_cast<Eigen::Index>(place), exact.size() - 1);
    const auto after = std::min(before + 1, exact.size() - 1);
    const double share = place - static_cast<double>(before);
    column[i] = exact[before] + share * (exact[after] - exact[before]);
  }
}

void ApplyAnalog(const FaultConfig& fault, const FaultEvent& event, double full_scale,
                 double rate_hz, RandomStream& random, Signal& counts) {
  auto column = counts.col(event.channel);
  auto stretch = column.segment(event.begin, event.end - event.begin);
  const double amplitude = fault.amplitude_counts * full_scale / kFaultFullScaleCounts;
  switch (fault.kind) {
    case FaultKind::kSpikes:
      // Half to all of the amplitude, up or down.
      stretch.array() += (random.Bits() >> 63 ? 1.0 : -1.0) * amplitude * random.Uniform(0.5, 1.0);
      return;
    case FaultKind::kNoiseBursts:
      for (double& value : stretch) value += amplitude * BoxMuller(random).first;
      return;
    case FaultKind::kGainChange:
      stretch = 0.5 * full_scale + fault.gain * (stretch.array() - 0.5 * full_scale);
      return;
    case FaultKind::kTimeJitter:
      return JitterTime(fault, rate_hz, random, column);
    default:
      return;
  }
}

void ApplyDigital(const FaultConfig& fault, const FaultEvent& event, double full_scale,
                  double rate_hz, RandomStream& random, Signal& counts) {
  const Eigen::Index size = event.end - event.begin;
  const Eigen::Index before = std::max(event.begin - 1, 0);
  switch (fault.kind) {
    case FaultKind::kSaturated:
      counts.col(event.channel)
          .segment(event.begin, size)
          .setConstant(random.Bits() >> 63 ? full_scale : 0.0);
      return;
    case FaultKind::kStuck:
      counts.col(event.channel)
          .segment(event.begin, size)
          .setConstant(counts(before, event.channel));
      return;
    case FaultKind::kDisconnected:
    case FaultKind::kDropouts:
      counts.col(event.channel)
          .segment(event.begin, size)
          .setConstant(std::numeric_limits<double>::quiet_NaN());
      return;
    case FaultKind::kDuplicatedFrames:
      counts.middleRows(event.begin, size) = counts.row(before).eval().replicate(size, 1);
      return;
    case FaultKind::kLateFrames: {
      const auto late = std::max<Eigen::Index>(1, std::lround(1e-3 * fault.delay_ms * rate_hz));
      for (Eigen::Index i = event.end - 1; i >= event.begin; --i) {
        counts.row(i) = counts.row(std::max<Eigen::Index>(i - late, 0)).eval();
      }
      return;
    }
    default:
      return;
  }
}

template <class Apply>
void ForEachEvent(const std::vector<FaultConfig>& faults, double rate_hz, std::uint64_t seed,
                  Signal& counts, const Apply& apply) {
  for (std::size_t number = 0; number < faults.size(); ++number) {
    const FaultConfig& fault = faults[number];
    auto events = EventsOf(fault, number, static_cast<int>(counts.rows()), rate_hz, seed);
    // The last first: a late frame shows a frame from before, as it was before it came late itself.
    if (fault.kind == FaultKind::kLateFrames) std::ranges::reverse(events);
    for (const FaultEvent& event : events) {
      const auto moment = static_cast<std::uint64_t>(event.begin) << 32;
      RandomStream random(seed, "fault/how", moment + StreamIndex(number, event.channel));
      apply(fault, event, random);
    }
  }
}

}  // namespace

std::vector<FaultEvent> DrawFaults(const std::vector<FaultConfig>& faults, int samples,
                                   double rate_hz, std::uint64_t seed) {
  std::vector<FaultEvent> all;
  for (std::size_t number = 0; number < faults.size(); ++number) {
    const auto events = EventsOf(faults[number], number, samples, rate_hz, seed);
    all.insert(all.end(), events.begin(), events.end());
  }
  return all;
}

void ApplyAnalogFaults(const std::vector<FaultConfig>& faults, double full_scale_counts,
                       double rate_hz, std::uint64_t seed, Signal& counts) {
  ForEachEvent(faults, rate_hz, seed, counts,
               [&](const FaultConfig& fault, const FaultEvent& event, RandomStream& random) {
                 if (event.channel >= 0) {
                   ApplyAnalog(fault, event, full_scale_counts, rate_hz, random, counts);
                 }
               });
}

void ApplyDigitalFaults(const std::vector<FaultConfig>& faults, double full_scale_counts,
                        double rate_hz, std::uint64_t seed, Signal& counts) {
  ForEachEvent(faults, rate_hz, seed, counts,
               [&](const FaultConfig& fault, const FaultEvent& event, RandomStream& random) {
                 ApplyDigital(fault, event, full_scale_counts, rate_hz, random, counts);
               });
}

}  // namespace gauntlet::sim
