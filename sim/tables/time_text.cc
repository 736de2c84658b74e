#include <cctype>
#include <chrono>

#include "sim/base/csv_line.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr double kSecondsPerDay = 86400.0;

/// Takes a text from its beginning; each Take...() leaves it alone where it does not fit.
class TimeScanner {
 public:
  explicit TimeScanner(std::string_view text) : rest_(text) {}

  bool at_end() const { return rest_.empty(); }
  char next() const { return rest_.empty() ? '\0' : rest_.front(); }
  bool TakeAnyOf(std::string_view letters) {
    if (at_end() || letters.find(next()) == std::string_view::npos) return false;
    rest_.remove_prefix(1);
    return true;
  }
  bool TakeWord(std::string_view upper) {
    if (rest_.size() < upper.size()) return false;
    for (std::size_t i = 0; i < upper.size(); ++i) {
      if (std::toupper(static_cast<unsigned char>(rest_[i])) != upper[i]) return false;
    }
    rest_.remove_prefix(upper.size());
    return true;
  }
  /// A number without a sign, of at most `most_digits`.
  std::optional<int> TakeNumber(std::size_t most_digits) {
    std::string_view rest = rest_;
    int number = 0;
    for (; !rest.empty() && std::isdigit(static_cast<unsigned char>(rest[0])) != 0;
         rest.remove_prefix(1)) {
      if (rest_.size() - rest.size() == most_digits) return std::nullopt;
      number = 10 * number + (rest[0] - '0');
    }
    if (rest.size() == rest_.size()) return std::nullopt;
    rest_ = rest;
    return number;
  }
  /// The part behind a decimal point or comma; 0 if there is none.
  double TakeFraction() {
    if (rest_.size() < 2 || (next() != '.' && next() != ',') ||
        std::isdigit(static_cast<unsigned char>(rest_[1])) == 0) {
      return 0.0;
    }
    rest_.remove_prefix(1);
    double fraction = 0.0;
    for (double unit = 0.1; std::isdigit(static_cast<unsigned char>(next())) != 0; unit *= 0.1) {
      fraction += unit * (next() - '0');
      rest_.remove_prefix(1);
    }
    return fraction;
  }

 private:
  std::string_view rest_;
};

std::optional<double> SecondsOfDate(int year, int month, int day) {
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  constexpr int kEarliest = 1000;  // years of four digits; 1.2.3 is a version of something
  if (!date.ok() || year < kEarliest) return std::nullopt;
  return kSecondsPerDay * std::chrono::sys_days(date).time_since_epoch().count();
}

/// The rest of a date whose first number is known and that has `separator` behind it.
std::optional<double> TakeDate(TimeScanner& scanner, int first, char separator) {
  const auto second = scanner.TakeNumber(2);
  if (!second || !scanner.TakeAnyOf({&separator, 1})) return std::nullopt;
  const auto third = scanner.TakeNumber(4);
  if (!third) return std::nullopt;
  if (first > 31) return SecondsOfDate(first, *second, *third);
  const bool day_first = separator == '.' || first > 12;
  return day_first ? SecondsOfDate(*third, *second, first) : SecondsOfDate(*third, first, *second);
}

/// The rest of a clock whose first number is known, behind its colon.
std::optional<double> TakeClock(TimeScanner& scanner, int first) {
  const auto second = scanner.TakeNumber(2);
  if (!second || *second > 59) return std::nullopt;
  double seconds = 0.0;
  if (scanner.TakeAnyOf(":")) {
    const auto third = scanner.TakeNumber(2);
    if (!third || *third > 60 || first > 24) return std::nullopt;
    seconds = 3600.0 * first + 60.0 * *second + *third + scanner.TakeFraction();
  } else if (scanner.next() == '.' || scanner.next() == ',') {
    seconds = 60.0 * first + *second + scanner.TakeFraction();
  } else {
    if (first > 24) return std::nullopt;
    seconds = 3600.0 * first + 60.0 * *second;
  }
  scanner.TakeAnyOf(" ");
  const bool noon = first == 12;
  if (scanner.TakeWord("PM")) return noon ? seconds : seconds + 0.5 * kSecondsPerDay;
  if (scanner.TakeWord("AM")) return noon ? seconds - 0.5 * kSecondsPerDay : seconds;
  return seconds;
}

/// Lead of a clock over UTC [s], read from the text behind the sign.
std::optional<double> TakeShift(TimeScanner& scanner) {
  const auto hours = scanner.TakeNumber(4);
  if (!hours) return std::nullopt;
  constexpr int kTwoDigits = 100;
  if (*hours >= kTwoDigits) {  // +0200
    const int whole_hours = *hours / kTwoDigits;
    return 3600.0 * whole_hours + 60.0 * (*hours % kTwoDigits);
  }
  scanner.TakeAnyOf(":");
  return 3600.0 * *hours + 60.0 * scanner.TakeNumber(2).value_or(0);
}

/// Behind the P of a duration of ISO 8601 of days and less: 1DT2H3M4.5S. The number in front of
/// a letter may have a sign.
std::optional<double> TakeIsoDuration(TimeScanner& scanner) {
  constexpr std::size_t kMostDigits = 9;
  double seconds = 0.0;
  bool is_clock = false;
  bool has_part = false;
  while (!scanner.at_end()) {
    if (!is_clock && scanner.TakeAnyOf("T")) is_clock = true;
    const bool minus = scanner.TakeAnyOf("-");
    const auto whole = scanner.TakeNumber(kMostDigits);
    if (!whole) return std::nullopt;
    const double number = (minus ? -1.0 : 1.0) * (*whole + scanner.TakeFraction());
    if (!is_clock && scanner.TakeAnyOf("D")) {
      seconds += kSecondsPerDay * number;
    } else if (is_clock && scanner.TakeAnyOf("H")) {
      seconds += 3600.0 * number;
    } else if (is_clock && scanner.TakeAnyOf("M")) {
      seconds += 60.0 * number;
    } else if (is_clock && scanner.TakeAnyOf("S")) {
      seconds += number;
    } else {
      return std::nullopt;
    }
    has_part = true;
  }
  return has_part ? std::optional(seconds) : std::nullopt;
}

/// A duration: `PT0.01S` (of polars), `P0DT0H0M0.010S` and `-1 days +23:59:59.99` (of pandas),
/// `1 day, 0:00:01` (of Python).
std::optional<double> SecondsOfDuration(std::string_view text) {
  TimeScanner scanner(text);
  const bool minus = scanner.TakeAnyOf("-");
  if (scanner.TakeAnyOf("P")) {
    const auto seconds = TakeIsoDuration(scanner);
    return seconds && minus ? -*seconds : seconds;
  }
  constexpr std::size_t kMostDigits = 6;
  const auto days = scanner.TakeNumber(kMostDigits);
  if (!days || !scanner.TakeWord(" DAY")) return std::nullopt;
  scanner.TakeAnyOf("s");
  const double seconds = (minus ? -kSecondsPerDay : kSecondsPerDay) * *days;
  if (scanner.at_end()) return seconds;
  scanner.TakeAnyOf(",");
  if (!scanner.TakeAnyOf(" ")) return std::nullopt;
  scanner.TakeAnyOf("+");
  const auto hours = scanner.TakeNumber(2);
  if (!hours || !scanner.TakeAnyOf(":")) return std::nullopt;
  const auto clock_s = TakeClock(scanner, *hours);
  return clock_s && scanner.at_end() ? std::optional(seconds + *clock_s) : std::nullopt;
}

}  // namespace

std::optional<double> SecondsOfText(std::string_view text) {
  if (const auto duration_s = SecondsOfDuration(Unquoted(text))) return duration_s;
  TimeScanner scanner(Unquoted(text));
  auto first = scanner.TakeNumber(4);
  if (!first) return std::nullopt;
  double seconds = 0.0;
  for (const char separator : {'-', '/', '.'}) {
    if (!scanner.TakeAnyOf({&separator, 1})) continue;
    const auto date_s = TakeDate(scanner, *first, separator);
    if (!date_s) return std::nullopt;
    if (scanner.at_end()) return date_s;
    if (!scanner.TakeAnyOf(separator == '/' ? " Tt_/" : " Tt_")) return std::nullopt;
    seconds = *date_s;
    first = scanner.TakeNumber(2);
    break;
  }
  if (!first || !scanner.TakeAnyOf(":")) return std::nullopt;
  const auto clock_s = TakeClock(scanner, *first);
  if (!clock_s) return std::nullopt;
  seconds += *clock_s;
  const bool minus = scanner.next() == '-';
  if (scanner.TakeAnyOf("+-")) {
    const auto shift_s = TakeShift(scanner);
    if (!shift_s) return std::nullopt;
    seconds += minus ? *shift_s : -*shift_s;
  } else {
    scanner.TakeAnyOf("Zz");
  }
  return scanner.at_end() ? std::optional(seconds) : std::nullopt;
}

}  // namespace gauntlet::sim
