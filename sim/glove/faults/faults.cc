#include "sim/glove/faults/faults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sim/base/channels.h"
#include "sim/base/random.h"
#include "sim/glove/motions/motion.h"
#include "sim/glove/noise/box_muller.h"

namespace gauntlet::sim {
namespace {

// Noise and spikes are given in counts of a 10-bit converter.
constexpr double kFaultFullScaleCounts = 1023.0;

/// In place of a channel: that of all channels together.
constexpr int kFrame = -1;

bool IsOfFrames(FaultKind kind) {
  return kind == FaultKind::kDuplicatedFrames || kind == FaultKind::kLateFrames;
}

/// Of a fault's place in the list and a channel.
std::uint64_t StreamIndex(std::size_t fault, int channel) {
  return fault * 1000 + static_cast<std::uint64_t>(channel + 1);
}

double Exponential(RandomStream& random, double mean) {
  return -mean * std::log(random.UniformAboveZero());
}

/// Of one channel, which the stream belongs to. From one to the next there is a gap, so that both
/// the rate and the duration are as stated.
void AddEvents(const FaultConfig& fault, RandomStream random, int channel, int samples,
               double rate_hz, std::vector<FaultEvent>& events) {
  const double last = samples;
  const double mean_length = 1e-3 * fault.duration_ms * rate_hz;
  const double mean_gap = rate_hz / fault.rate_per_s - mean_length;
  const auto gap = [&] { return fault.rate_per_s > 0.0 ? Exponential(random, mean_gap) : last; };
  double begin = fault.start_s < 0.0 ? gap() : std::round(fault.start_s * rate_hz);
  while (begin < last) {
    const double length = mean_length > 0.0 ? Exponential(random, mean_length) : last;
    const double end = std::clamp(begin + length, std::floor(begin) + 1.0, last);
    events.push_back({fault.kind, channel, static_cast<int>(begin), static_cast<int>(end)});
    begin = end + gap();
  }
}

void CheckRate(const FaultConfig& fault) {
  const double share = 1e-3 * fault.duration_ms * fault.rate_per_s;
  if (share < 1.0) return;
  throw controller::SettingError("rate_per_s", "times duration_ms is " +
                                                   controller::NumberText(1000.0 * share) +
                                                   " ms in a second, must be below 1000");
}

std::vector<FaultEvent> EventsOf(const FaultConfig& fault, std::size_t number, int samples,
                                 double rate_hz, std::uint64_t seed) {
  const std::vector<bool> selected =
      controller::WithinSetting("faults[" + std::to_string(number) + "]", [&fault] {
        CheckRate(fault);
        return SelectChannels(fault.channels);
      });
  std::vector<FaultEvent> events;
  for (int channel = 0; channel < static_cast<int>(selected.size()); ++channel) {
    if (!selected[static_cast<std::size_t>(channel)]) continue;
    const int stream = IsOfFrames(fault.kind) ? kFrame : channel;
    AddEvents(fault, RandomStream(seed, "fault/when", StreamIndex(number, stream)), channel,
              samples, rate_hz, events);
  }
  return events;
}

/// The samples of [event.begin, event.end), each taken a little off its time: linear interpolation
/// between what lies beside.
void JitterTime(const FaultConfig& fault, const FaultEvent& event, double rate_hz,
                RandomStream& random, Eigen::Ref<Eigen::VectorXd> column) {
  const double deviation = 1e-3 * fault.deviation_ms * rate_hz;
  const auto reach = static_cast<Eigen::Index>(6.0 * deviation) + 1;  // beyond: twice in 10^9
  const Eigen::Index first = std::max<Eigen::Index>(event.begin - reach, 0);
  const Eigen::Index last = std::min(event.end + reach, column.size()) - 1;
  const Eigen::VectorXd exact = column.segment(first, last - first + 1);
  for (Eigen::Index i = event.begin; i < event.end; ++i) {
    const double off = deviation * BoxMuller(random).first;
    const double place = std::clamp(static_cast<double>(i - first) + off, 0.0,
                                    static_cast<double>(exact.size() - 1));
    const auto before = static_cast<Eigen::Index>(place);
    const auto after = std::min(before + 1, exact.size() - 1);
    const double share = place - static_cast<double>(before);
    column[i] = exact[before] + share * (exact[after] - exact[before]);
  }
}

void ApplyAnalog(const FaultConfig& fault, const FaultEvent& event, double full_scale,
                 RandomStream& random, Signal& counts) {
  auto stretch = counts.col(event.channel).segment(event.begin, event.end - event.begin);
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
    default:
      return;
  }
}

void ApplyDigital(const FaultConfig& fault, const FaultEvent& event, double full_scale,
                  double rate_hz, RandomStream& random, Signal& counts) {
  auto column = counts.col(event.channel);
  auto stretch = column.segment(event.begin, event.end - event.begin);
  switch (fault.kind) {
    case FaultKind::kSaturated:
      stretch.setConstant(random.Bits() >> 63 ? full_scale : 0.0);
      return;
    case FaultKind::kStuck:
    case FaultKind::kDuplicatedFrames: {
      const double before = column[std::max(event.begin - 1, 0)];
      stretch.setConstant(before);
      return;
    }
    case FaultKind::kDisconnected:
    case FaultKind::kDropouts:
      stretch.setConstant(std::numeric_limits<double>::quiet_NaN());
      return;
    case FaultKind::kLateFrames: {
      const auto late = std::max<Eigen::Index>(1, std::lround(1e-3 * fault.delay_ms * rate_hz));
      for (Eigen::Index i = event.end - 1; i >= event.begin; --i) {
        column[i] = column[std::max<Eigen::Index>(i - late, 0)];
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

void ApplySamplingFaults(const std::vector<FaultConfig>& faults, double rate_hz, std::uint64_t seed,
                         Signal& counts) {
  ForEachEvent(faults, rate_hz, seed, counts,
               [&](const FaultConfig& fault, const FaultEvent& event, RandomStream& random) {
                 if (fault.kind != FaultKind::kTimeJitter) return;
                 JitterTime(fault, event, rate_hz, random, counts.col(event.channel));
               });
}

void ApplyAnalogFaults(const std::vector<FaultConfig>& faults, double full_scale_counts,
                       double rate_hz, std::uint64_t seed, Signal& counts) {
  ForEachEvent(faults, rate_hz, seed, counts,
               [&](const FaultConfig& fault, const FaultEvent& event, RandomStream& random) {
                 ApplyAnalog(fault, event, full_scale_counts, random, counts);
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
