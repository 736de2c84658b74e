#include "sim/live/device/sender_clock.h"

#include <cmath>
#include <string>
#include <vector>

#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {

bool SenderClock::NeedsUnit(std::string_view name) {
  const std::vector<std::string> words = WordsOf(name);
  if (!words.empty() && words.back() == "s") return false;  // t_s, which is no ts
  // With a unit behind it a name is a time in another scale, or still one of seconds.
  const auto in_ms = TimeScaleS(std::string(name) + "_ms");
  return TimeScaleS(name) == 1.0 && in_ms.has_value();
}

std::optional<double> SenderClock::Add(double time, std::int64_t arrival_ns) {
  constexpr double kShortest_s = 0.5;
  constexpr double kLongest_s = 5.0;
  constexpr double kMostWrong = 1.25;
  if (!std::isfinite(time)) return std::nullopt;
  const double passed_s =
      first_arrival_ns_ ? 1e-9 * static_cast<double>(arrival_ns - *first_arrival_ns_) : kLongest_s;
  if (passed_s < kShortest_s) return std::nullopt;
  const double advance = time - first_time_;
  const bool is_first = !first_arrival_ns_;
  first_arrival_ns_ = arrival_ns;
  first_time_ = time;
  if (is_first || passed_s > kLongest_s) return std::nullopt;
  for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    const double ratio = advance * scale_s / passed_s;
    if (ratio > 1.0 / kMostWrong && ratio < kMostWrong) return scale_s;
  }
  return std::nullopt;
}

}  // namespace gauntlet::sim
