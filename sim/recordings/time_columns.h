#pragma once

#include <optional>
#include <string_view>

namespace gauntlet::sim {

/// Seconds per unit of a column of time: `t_s` (of a trace), `time`, `time_s`, `time_ms`,
/// `time_us`, in any case of the letters. Nothing for any other name.
std::optional<double> TimeScaleS(std::string_view name);

/// True for `k`, the number of the sample in the CSV of a trace.
bool IsSampleNumber(std::string_view name);

}  // namespace gauntlet::sim
