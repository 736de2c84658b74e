#include "sim/glove/faults/faults.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "controller/assert.h"
#include "sim/base/random.h"
#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {
namespace {

/// In place of a channel: that of all channels together.
constexpr int kFrame = -1;

/// Index of the random stream for a fault's place in the list and a channel.
std::uint64_t StreamIndex(std::size_t fault, int channel) {
  return fault * 1000 + static_cast<std::uint64_t>(channel + 1);
}

double Exponential(RandomStream& random, double mean) {
  return -mean * std::log(random.UniformAboveZero());
}

/// Adds the faults of one channel, which the stream belongs to. From one to the next there is a
/// gap, so that both the rate and the duration are as stated.
void AddEvents(const FaultConfig& fault, RandomStream random, int channel, int samples,
               double rate_hz, std::vector<FaultEvent>& events) {
  GAUNTLET_ASSERT(rate_hz > 0.0);
  const FaultOccurrence& when = fault.when();
  const double last = samples;
  const double mean_length = 1e-3 * when.duration_ms * rate_hz;
  const double mean_gap = rate_hz / when.rate_per_s - mean_length;
  const auto gap = [&] { return when.rate_per_s > 0.0 ? Exponential(random, mean_gap) : last; };
  double begin = when.start_s < 0.0 ? gap() : std::round(when.start_s * rate_hz);
  while (begin < last) {
    const double length = mean_length > 0.0 ? Exponential(random, mean_length) : last;
    const double end = std::clamp(begin + length, std::floor(begin) + 1.0, last);
    events.push_back({fault.kind(), channel, static_cast<int>(begin), static_cast<int>(end)});
    begin = end + gap();
  }
}

void CheckRate(const FaultOccurrence& when) {
  const double share = 1e-3 * when.duration_ms * when.rate_per_s;
  if (share < 1.0) return;
  throw controller::SettingError("rate_per_s", "times duration_ms is " +
                                                   controller::NumberText(1000.0 * share) +
                                                   " ms in a second, must be below 1000");
}

std::vector<FaultEvent> EventsOf(const FaultConfig& fault, std::size_t number, int samples,
                                 double rate_hz, std::uint64_t seed) {
  const std::vector<bool> selected =
      controller::WithinSetting("faults[" + std::to_string(number) + "]", [&fault] {
        CheckRate(fault.when());
        return SelectChannels(fault.when().channels);
      });
  std::vector<FaultEvent> events;
  for (int channel = 0; channel < static_cast<int>(selected.size()); ++channel) {
    if (!selected[static_cast<std::size_t>(channel)]) continue;
    const int stream = fault.nature().of_frames ? kFrame : channel;
    AddEvents(fault, RandomStream(seed, "fault/when", StreamIndex(number, stream)), channel,
              samples, rate_hz, events);
  }
  return events;
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

void ApplyFaults(FaultStage stage, const std::vector<FaultConfig>& faults,
                 std::span<const controller::ConverterRange> converters, double rate_hz,
                 std::uint64_t seed, Signal& counts) {
  for (std::size_t number = 0; number < faults.size(); ++number) {
    const FaultNature nature = faults[number].nature();
    if (nature.stage != stage) continue;
    auto events = EventsOf(faults[number], number, static_cast<int>(counts.rows()), rate_hz, seed);
    if (nature.last_first) std::ranges::reverse(events);
    int channel = kFrame;
    for (const FaultEvent& event : events) {
      GAUNTLET_ASSERT(0 <= event.begin && event.begin < event.end && event.end <= counts.rows());
      if (std::exchange(channel, event.channel) != event.channel) TrimSignals();
      const auto moment = static_cast<std::uint64_t>(event.begin) << 32;
      RandomStream random(seed, "fault/how", moment + StreamIndex(number, event.channel));
      FaultStrike strike{.column = counts.col(event.channel),
                         .begin = event.begin,
                         .end = event.end,
                         .rate_hz = rate_hz,
                         .converter = converters[static_cast<std::size_t>(event.channel)],
                         .random = random};
      std::visit([&strike](const auto& fault) { fault.Apply(strike); }, faults[number].settings);
    }
  }
}

}  // namespace gauntlet::sim
