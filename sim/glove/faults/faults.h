#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/faults/fault_config.h"

namespace gauntlet::sim {

/// The truth of one fault: what was wrong, where and when.
struct FaultEvent {
  std::string_view kind;  // one of the names of FaultKinds()
  int channel = 0;
  int begin = 0;  // samples [begin, end)
  int end = 0;
};

/// When and where each fault of the list strikes in a signal of this length. Ordered by the list,
/// then by channel, then by time. Each fault and channel has a random stream of its own; faults of
/// frames strike all their channels at once.
/// Errors: SettingError for an unknown channel, or faults that come again before they can end.
std::vector<FaultEvent> DrawFaults(const std::vector<FaultConfig>& faults, int samples,
                                   double rate_hz, std::uint64_t seed);

/// Applies the faults of one stage, each where DrawFaults says, to `counts`, samples x channels.
/// `converters`: one per channel.
/// Errors: those of DrawFaults.
void ApplyFaults(FaultStage stage, const std::vector<FaultConfig>& faults,
                 std::span<const controller::ConverterRange> converters, double rate_hz,
                 std::uint64_t seed, Signal& counts);

}  // namespace gauntlet::sim
