#include "sim/recordings/time_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/recordings/quantities.h"
#include "sim/recordings/table_statistics.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

std::vector<double> ValuesOf(const TableLayout& layout, std::size_t column) {
  std::vector<double> values;
  for (const auto& row : layout.rows) {
    const double value = NumberIn(layout, row[column]);
    if (std::isfinite(value)) values.push_back(value);
  }
  return values;
}

constexpr std::string_view kDate = "date";  // a unit of column maps: of dates and clocks
constexpr std::string_view kRowNumbers = "i n id idx nr index sequence counter";

/// True for a name of something that is no time: a finger, a joint, a sensor, a frame's number or
/// another quantity. Such a column is no time even if its values rise.
bool NamesOther(std::string_view name) {
  if (IsSampleNumber(name)) return true;
  const std::vector<std::string> words = WordsOf(name);
  const bool is_hand = std::ranges::any_of(words, [](const std::string& word) {
    return !FingerOf(word).empty() || !JointOf(word).empty() || !ArmPartOf(word).empty() ||
           IsSpread(word) || IsSensorWord(word) || IsJointWord(word);
  });
  return is_hand || HasWordOf(words, kRowNumbers) ||
         HasWordOf(words, "x y z w flexion extension flex elbow img image") ||
         std::ranges::any_of(QuantityRules(), [&words](const QuantityRule& rule) {
           return rule.quantity != Quantity::kTime &&
                  std::ranges::any_of(words, [&rule](const std::string& word) {
                    // us is a microsecond beside a siemens
                    return !SecondsPerUnit(word) && IsWordOf(rule.words, word);
                  });
         });
}

struct Steps {
  double usual = 0.0;
  double rising_share = 0.0;   // share of steps >= 0
  double forward_share = 0.0;  // share of steps > 0
  bool is_count = false;       // nearly all steps are 1
};

Steps StepsOf(const std::vector<double>& values) {
  Steps steps;
  std::vector<double> all;
  double forward = 0.0, ones = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (step >= 0.0) all.push_back(step);
    forward += step > 0.0 ? 1.0 : 0.0;
    ones += step == 1.0 ? 1.0 : 0.0;
  }
  if (all.empty()) return steps;
  constexpr double kNearlyAll = 0.95;
  const double count = static_cast<double>(values.size() - 1);
  steps.usual = UsualInterval(all);
  // A clock of whole seconds steps in few rows.
  if (steps.usual == 0.0) {
    steps.usual = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  }
  steps.rising_share = static_cast<double>(all.size()) / count;
  steps.forward_share = forward / count;
  steps.is_count = ones > kNearlyAll * count;
  return steps;
}

// Rates of gloves; other units of the time are a mistake.
constexpr double kSlowest_hz = 1.0;
constexpr double kFastest_hz = 1e4;

constexpr double kSince1970_s = 5e8;  // from 1985 on

/// Longest interval of rows in s that needs no unit.
constexpr double kLongest_s = 0.4;

bool IsRateOfGlove(double usual_step, std::string_view unit) {
  const double rate_hz = 1.0 / (usual_step * SecondsPer(unit));
  return rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz;
}

/// Days since the year 0 (datenum of MATLAB) or 1900 (spreadsheets), of dates from 1990 to 2100.
bool AreDays(double first, double usual_step) {
  const bool is_datenum = first > 726000.0 && first < 767000.0;
  const bool is_serial = first > 32000.0 && first < 74000.0;
  return (is_datenum || is_serial) && IsRateOfGlove(usual_step, "day");
}

/// Steps of 100 ns since the year 1 (.NET) or 1601 (Windows), of dates from 2000 on. As nanoseconds
/// they would be of before 1992.
bool AreTicks(double first) {
  const bool is_net = first > 6.3e17 && first < 6.9e17;
  const bool is_windows = first > 1.25e17 && first < 1.6e17;
  return is_net || is_windows;
}

/// Unit of numbers that count from a known date; empty for others.
std::string_view UnitOfDate(double first, double usual_step) {
  if (AreDays(first, usual_step)) return "day";
  if (AreTicks(first)) return "ticks";
  constexpr std::array<std::pair<double, std::string_view>, 4> kSince1970 = {
      {{1e17, "ns"}, {1e14, "us"}, {1e11, "ms"}, {kSince1970_s, "s"}}};
  for (const auto& [least, unit] : kSince1970) {
    if (first >= least) return unit;
  }
  return "";
}

/// True for the index of pandas, which reset_index() calls so, if its numbers count from a date.
bool IsIndexOfDates(const std::string& name, double first, double usual_step) {
  const std::string_view unit = UnitOfDate(first, usual_step);
  return BareName(name) == "index" && !unit.empty() && IsRateOfGlove(usual_step, unit);
}

/// Unit in a name such as time_ms or Elapsed Time (milliseconds); empty if there is none.
std::string_view UnitByName(const std::string& name) {
  constexpr std::array<Meaning, 6> kUnits = {
      {{"h", "hour hours"},
       {"min", "min mins minute minutes"},
       {"ms", "ms msec msecs millis millisec millisecond milliseconds"},
       {"us", "us usec usecs micros microsec microsecond microseconds"},
       {"ns", "ns nsec nsecs nanos nanosec nanosecond nanoseconds"},
       {"s", "s sec secs second seconds"}}};
  const std::vector<std::string> words = WordsOf(name);
  for (const auto& [unit, names] : kUnits) {
    const bool is_alone = words.size() == 1 && unit == "s" && words[0] == "s";
    if (!is_alone && HasWordOf(words, names)) return unit;
  }
  const std::optional<double> scale_s = TimeScaleS(name);  // timestampUs, tms
  if (!scale_s || *scale_s == 1.0) return "";
  return *scale_s == 1e-3 ? "ms" : *scale_s == 1e-6 ? "us" : "ns";
}

/// Columns of hour, minute and second, or of seconds and nanoseconds.
std::vector<TimeMapping> NamedParts(const TableLayout& layout) {
  constexpr std::array<Meaning, 6> kParts = {{{"day", "day"},
                                              {"h", "hour hours hh"},
                                              {"min", "minute minutes min mm"},
                                              {"s", "second seconds sec secs ss"},
                                              {"ms", "ms millisecond milliseconds"},
                                              {"ns", "nsec nsecs nanosec"}}};
  std::vector<TimeMapping> parts;
  const auto has = [&parts](std::string_view unit) {
    return std::ranges::find(parts, unit, UnitOfTime) != parts.end();
  };
  for (std::size_t column = 0; column < layout.columns; ++column) {
    const std::vector<std::string> words = WordsOf(layout.names[column]);
    if (words.empty() || KindOf(layout, column) != CellKind::kNumber) continue;
    const std::string_view unit = MeaningOf(kParts, words.back());
    if (!unit.empty() && !has(unit)) parts.push_back(TimeIn(column, unit));
  }
  if ((has("h") && has("min")) || (has("min") && has("s"))) return parts;
  if (has("s") && has("ns")) {
    std::erase_if(parts, [](const TimeMapping& part) {
      return UnitOfTime(part) != "s" && UnitOfTime(part) != "ns";
    });
    return parts;
  }
  return {};
}

/// Columns of dates and clock times: one with both, or one of each.
std::vector<TimeMapping> DateParts(const TableLayout& layout) {
  std::vector<TimeMapping> parts;
  for (std::size_t column = 0; column < layout.columns; ++column) {
    if (KindOf(layout, column) != CellKind::kTime) continue;
    const std::string& cell = layout.rows.front()[column];
    const bool has_clock = cell.find(':') != std::string::npos;
    const bool has_date = cell.find_first_of("-/") != std::string::npos ||
                          std::ranges::count(cell.substr(0, 10), '.') == 2;
    if (has_clock && has_date) return {TimeIn(column, kDate)};
    parts.push_back(TimeIn(column, kDate));
  }
  return parts;
}

/// True if dates and clocks advance in nearly every row.
bool Advance(const std::vector<TimeMapping>& dates, const TableLayout& layout) {
  constexpr double kNearlyAll = 0.9;
  std::vector<double> times;
  for (const auto& row : layout.rows) {
    double sum_s = 0.0;
    for (const TimeMapping& part : dates) {
      sum_s += SecondsOfText(row[part.column]).value_or(controller::kNaN);
    }
    times.push_back(sum_s);
  }
  return StepsOf(times).forward_share > kNearlyAll;
}

std::string QuestionOf(std::size_t column, const std::string& name, double step) {
  const std::string shown = name.empty() ? "" : fmt::format(" '{}'", OneLine(name, 20));
  return fmt::format("column {}{} rises by {:.5g} from row to row", column + 1, shown, step);
}

/// The time is this column, which rises by this step. Its unit is that of its name, that of a date,
/// or s for a name with the word time and a step of a glove. All others are a question.
TimeGuess GuessOf(std::size_t column, const std::string& name, double first, double step) {
  const std::string_view named = UnitByName(name);
  const std::string_view of_date = UnitOfDate(first, step);
  const std::vector<std::string> words = WordsOf(name);
  const bool names_time = TimeScaleS(name) == 1.0 ||
                          HasWordOf(words, "time timestamp timestamps") ||
                          (!words.empty() && words.back() == "t");
  const bool is_s = names_time && step <= kLongest_s && IsRateOfGlove(step, "s");
  const std::string_view unit = !named.empty()     ? named
                                : !of_date.empty() ? of_date
                                : is_s             ? "s"
                                                   : "";
  if (!unit.empty()) {
    return {
        {TimeIn(column, unit)},
        fmt::format("by its name; {} by {}", unit,
                    named.empty() && !is_s ? fmt::format("a date of {:.10g}", first) : "its name")};
  }
  return {.parts = {},
          .why = "its unit is unknown",
          .question = QuestionOf(column, name, step),
          .asked = column,
          .is_named = TimeScaleS(name).has_value()};
}

}  // namespace

MidnightClock::MidnightClock(const std::vector<TimeMapping>& time)
    : has_clock_(std::ranges::any_of(time, &TimeMapping::is_text)) {}

double MidnightClock::Add(double time_s) {
  constexpr double kDay_s = 86400.0;
  constexpr double kNearly_s = 82800.0;
  if (!has_clock_ || !std::isfinite(time_s)) return time_s;
  if (last_s_ < kDay_s && time_s >= 0.0 && last_s_ - time_s > kNearly_s) ++midnights_;
  last_s_ = time_s;
  return time_s + midnights_ * kDay_s;
}

double SecondsPer(std::string_view time_unit) { return SecondsPerUnit(time_unit).value_or(1.0); }

TimeMapping TimeIn(std::size_t column, std::string_view unit) {
  return {.column = column, .scale_s = SecondsPer(unit), .is_text = unit == kDate};
}

std::string UnitOfTime(const TimeMapping& time) {
  return time.is_text ? std::string(kDate) : UnitOfSeconds(time.scale_s);
}

double TimeOfRow(std::span<const TimeMapping> time, std::span<const double> row) {
  double time_s = 0.0;
  for (const TimeMapping& part : time) time_s += part.scale_s * row[part.column];
  return time_s;
}

TimeGuess GuessTime(const TableLayout& layout, const std::string& unit) {
  const auto dates = DateParts(layout);
  TimeGuess of_dates = {dates, dates.size() > 1 ? "date and clock" : "dates or clocks"};
  if (!dates.empty() && Advance(dates, layout)) return of_dates;
  if (const auto parts = NamedParts(layout); parts.size() > 1) {
    return {parts, "by the names of its parts, which add up"};
  }
  constexpr double kNearlyAll = 0.9;
  constexpr double kAll = 0.98;  // except where the clock starts anew
  TimeGuess best = {{}, "no column rises as a time does"};
  if (!dates.empty()) best = std::move(of_dates);
  TimeGuess nameless;
  double nameless_step = 0.0;
  for (std::size_t column = 0; column < layout.columns; ++column) {
    const std::string& name = layout.names[column];
    const std::vector<std::string> words = WordsOf(name);
    const bool is_number = HasWordOf(words, kRowNumbers) && !HasWordOf(words, "time");
    const bool is_named =
        TimeScaleS(name) || (MayBeTime(name) && !IsSampleNumber(name) && !is_number);
    const std::vector<double> values = ValuesOf(layout, column);
    if (KindOf(layout, column) != CellKind::kNumber || values.size() < 3) continue;
    const Steps steps = StepsOf(values);
    // A program may poll faster than the glove samples. Then times repeat. One that goes back
    // beside a clock is a part of it.
    const double least = dates.empty() ? kNearlyAll : 1.0;
    if (steps.rising_share < least || steps.usual <= 0.0) continue;
    const bool has_unit = !unit.empty() || !UnitByName(name).empty();
    if (steps.is_count && !has_unit) {
      if (dates.empty()) best.why = fmt::format("column {} only counts the rows", column + 1);
      if (TimeScaleS(name) && best.question.empty()) {
        best.question = QuestionOf(column, name, 1.0);
        best.asked = column;
      }
    } else if (is_named) {
      if (!unit.empty()) return {{TimeIn(column, unit)}, "in the unit that is given"};
      return GuessOf(column, name, values.front(), steps.usual);
    } else if (dates.empty() && nameless.why.empty() && steps.forward_share >= kAll &&
               (!NamesOther(name) || IsIndexOfDates(name, values.front(), steps.usual))) {
      nameless = GuessOf(column, name, values.front(), steps.usual);
      nameless_step = steps.usual;
      if (!unit.empty()) nameless.parts = {TimeIn(column, unit)};
    }
  }
  if (nameless.why.empty() || !best.question.empty()) return best;
  const std::string& first = layout.names.front();
  const bool is_nameless = first.empty() || first.starts_with("Unnamed: ");  // of pandas
  if (nameless.asked == 0U && is_nameless && unit.empty() && IsRateOfGlove(nameless_step, "s") &&
      nameless_step <= kLongest_s) {
    return {.parts = {TimeIn(0, "s")},
            .why = "the first column, without a name, rises as a time does; s assumed",
            .is_named = false,
            .unit_is_assumed = true};
  }
  nameless.is_named = false;
  if (!nameless.parts.empty()) {
    nameless.why = unit.empty() ? "its values are dates" : "in the unit that is given";
  }
  if (!unit.empty()) nameless.question.clear();
  return nameless;
}

TimeGuess TimeOfMap(const std::vector<TimeMapping>& time) {
  return {time, time.empty() ? "the map names none" : "by the map"};
}

std::vector<TimeMapping> TimeByName(const std::string& file, const TableLayout& layout,
                                    const std::string& unit) {
  std::vector<TimeMapping> time;
  const TimeGuess guess = GuessTime(layout, unit);
  if (guess.is_named && !guess.question.empty()) {
    throw UserError(
        {.place = file,
         .problem = guess.question +
                    "; call it time_s, time_ms, time_us or time_ns, or give --time-unit"});
  }
  if (guess.is_named || !unit.empty()) time = guess.parts;
  for (std::size_t c = 0; time.empty() && c < layout.columns; ++c) {
    const auto scale_s = TimeScaleS(layout.names[c]);
    if (!scale_s) continue;
    const bool is_text = KindOf(layout, c) == CellKind::kTime;
    time.push_back({c, unit.empty() || is_text ? *scale_s : SecondsPer(unit), is_text});
  }
  if (!unit.empty() && time.empty()) {
    throw UserError({.place = "--time-unit", .problem = file + " has no column of time"});
  }
  return time;
}

std::vector<std::size_t> ClocksBeside(const std::vector<TimeMapping>& time,
                                      const TableLayout& layout) {
  constexpr std::size_t kFewestRows = 10;
  constexpr double kSame = 0.02;  // of the duration, besides two intervals
  std::vector<double> times_s;
  for (const auto& row : layout.rows) {
    double sum_s = 0.0;
    for (const TimeMapping& part : time) {
      sum_s += part.is_text ? SecondsOfText(row[part.column]).value_or(controller::kNaN)
                            : part.scale_s * NumberIn(layout, row[part.column]);
    }
    times_s.push_back(sum_s);
  }
  std::vector<std::size_t> clocks;
  if (time.empty() || times_s.size() < kFewestRows) return clocks;
  const double duration_s = times_s.back() - times_s.front();
  const double near_s = kSame * duration_s + 2.0 * duration_s / std::ssize(times_s);
  for (std::size_t c = 0; c < layout.columns; ++c) {
    const std::vector<double> values = ValuesOf(layout, c);
    const bool is_time = std::ranges::find(time, c, &TimeMapping::column) != time.end();
    const bool is_whole =
        std::ranges::all_of(values, [](double value) { return value == std::round(value); });
    if (is_time || values.size() < times_s.size() || StepsOf(values).forward_share < 1.0 ||
        (!is_whole && !MayBeTime(layout.names[c]))) {
      continue;
    }
    const double range = values.back() - values.front();
    for (const double per_s : {1.0, 1e3, 1e6}) {
      if (std::abs(range / per_s - duration_s) <= near_s) clocks.push_back(c);
    }
  }
  return clocks;
}

std::vector<std::size_t> ColumnsAside(const std::vector<TimeMapping>& time,
                                      const TableLayout& layout) {
  TableStatistics statistics(layout.columns);
  std::vector<double> values(layout.columns);
  for (const auto& row : layout.rows) {
    for (std::size_t c = 0; c < layout.columns; ++c) values[c] = NumberIn(layout, row[c]);
    statistics.Add(controller::kNaN, values);
  }
  std::vector<ColumnEvidence> columns;
  for (std::size_t c = 0; c < layout.columns; ++c) {
    columns.push_back({.name = layout.names[c], .statistics = statistics.Column(c)});
    columns.back().statistics.counting_share = 0.0;  // in few rows a signal may count, too
  }
  std::vector<std::size_t> aside = ClocksBeside(time, layout);
  for (const ColumnFamily& family : FindFamilies(columns)) {
    using enum Quantity;
    const bool is_aside =
        family.quantity == kTime || family.quantity == kNumber || family.quantity == kLabel;
    if (!is_aside || !family.rule.ends_with("_by_name")) continue;
    aside.insert(aside.end(), family.columns.begin(), family.columns.end());
  }
  return aside;
}

void ReadOnly(const std::vector<TimeMapping>& time, const std::vector<std::size_t>& used,
              CsvReader& reader) {
  std::vector<bool> is_read(reader.column_count(), false);
  for (const std::size_t column : used) is_read[column] = true;
  for (const TimeMapping& part : time) {
    is_read[part.column] = true;
    if (part.is_text) reader.ReadAsTime(part.column);
  }
  for (std::size_t i = 0; i < is_read.size(); ++i) {
    if (!is_read[i]) reader.Ignore(i);
  }
}

}  // namespace gauntlet::sim
