#pragma once

#include <optional>
#include <string_view>

namespace gauntlet::sim {

/// Seconds that a date, a clock or both say; nothing for any other text, a plain number included.
///
/// Dates: `2024-05-31`, `2024/5/31`, `31.5.2024`, `5/31/2024`; where the year stands last, the
/// first number is the day if dots are between them or it is above 12, else the month (assumption:
/// only a recording over midnight can tell). Clocks: `13:05`, `13:05:07.25`, `1:05:07 PM`,
/// `05:07.25` (minutes, as it has a fraction). Between both: a blank, `T` or `_`, or `/` as in
/// `2025/05/23/15:03:53.88`. Behind: `Z` or a
/// shift as `+02:00`.
/// Units: s, of a date since 1970-01-01 (UTC, without a shift the clock as it is), of a clock alone
/// since midnight.
std::optional<double> SecondsOfText(std::string_view text);

}  // namespace gauntlet::sim
