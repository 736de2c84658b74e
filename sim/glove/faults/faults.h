#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/faults/fault_config.h"

namespace gauntlet::sim {

/// The truth of one fault: what was wrong, where and when.
struct FaultEvent {
  FaultKind kind = FaultKind::kSpikes;
  int channel = 0;
  int begin = 0;  // samples [begin, end)
  int end = 0;

  std::string_view kind_name() const { return FaultKinds()[static_cast<std::size_t>(kind)].name; }
};

/// When and where each fault of the list strikes in a signal of this length. Ordered by the list,
/// then by channel, then by time. Each fault and channel has a random stream of its own; faults of
/// frames strike all their channels at once.
/// Errors: SettingError for an unknown channel, or faults that come again before they can end.
std::vector<FaultEvent> DrawFaults(const std::vector<FaultConfig>& faults, int samples,
                                   double rate_hz, std::uint64_t seed);

/// Faults of the moments of sampling, before there is noise, which no sampling makes smaller: time
/// jitter. `counts` is analog, samples x channels.
void ApplySamplingFaults(const std::vector<FaultConfig>& faults, double rate_hz, std::uint64_t seed,
                         Signal& counts);

/// Faults of the electrical signal, before the converter: spikes, noise bursts, gain change.
/// `counts` is analog.
void ApplyAnalogFaults(const std::vector<FaultConfig>& faults, double full_scale_counts,
                       double rate_hz, std::uint64_t seed, Signal& counts);

/// Faults of the frames, behind the converter: all others. A missing value is NaN.
void ApplyDigitalFaults(const std::vector<FaultConfig>& faults, double full_scale_counts,
                        double rate_hz, std::uint64_t seed, Signal& counts);

}  // namespace gauntlet::sim
