#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// Seconds per unit of a column of time: `t`, `time`, `timestamp`, `elapsed`, `elapsed_time` or
/// `X_Value` (of LabVIEW), alone (in s) or with a unit behind it, `s`, `sec`, `ms`, `us`, `ns` and
/// their longer forms; or the longer form of a unit alone. Case, blanks, brackets and punctuation
/// do not matter: `t_s`, `Time (ms)`, `timestampUs`, `seconds`. Nothing for any other name.
std::optional<double> TimeScaleS(std::string_view name);

/// Seconds per unit of time in a column map: s, ms, us, ns, ticks (of 100 ns, as .NET and Windows
/// count them), min, h or day. Nothing for any other.
std::optional<double> SecondsPerUnit(std::string_view unit);

/// The unit of time of a column map that is so many seconds long; must be a value of
/// SecondsPerUnit().
std::string UnitOfSeconds(double seconds);

/// Letters and digits of a name only, small ones.
std::string BareName(std::string_view name);

/// True for one of the words of a list, which has blanks between them.
bool IsWordOf(std::string_view list, std::string_view word);

/// True for the number of a sample or frame: `k` (in the CSV of a trace), `frame`, `sample`, `row`,
/// `seq`, as in `frame_number`.
bool IsSampleNumber(std::string_view name);

/// True for a name that may be a time or a number of samples, but may be a sensor's, too: `index`,
/// `date`, `clock_ticks`.
bool MayBeTime(std::string_view name);

/// Seconds that a date, a clock, both or a duration say; nothing for any other text, a plain number
/// included.
///
/// Dates: `2024-05-31`, `2024/5/31`, `31.5.2024`, `5/31/2024`; where the year stands last, the
/// first number is the day if dots are between them or it is above 12, else the month (assumption:
/// only a recording over midnight can tell). Clocks: `13:05`, `13:05:07.25`, `1:05:07 PM`,
/// `05:07.25` (minutes, as it has a fraction). Between both: a blank, `T` or `_`, or `/` as in
/// `2025/05/23/15:03:53.88`. Behind: `Z` or a shift as `+02:00`. Durations: `0 days
/// 00:00:00.010000`, `PT0.01S` (ISO 8601). Units: s, of a date since 1970-01-01 (UTC, without a
/// shift the clock as it is), of a clock alone since midnight.
std::optional<double> SecondsOfText(std::string_view text);

}  // namespace gauntlet::sim
