#include "sim/recordings/time_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "controller/number.h"
#include "sim/recordings/quantities.h"
#include "sim/recordings/table_statistics.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"
#include "sim/tables/time_text.h"

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

/// True for a name of something that is no time: a finger, a joint, a sensor, a frame's number or
/// another quantity. Such a column is no time even if its values rise.
bool NamesOther(std::string_view name) {
  if (IsSampleNumber(name)) return true;
  const std::vector<std::string> words = WordsOf(name);
  const bool is_hand = std::ranges::any_of(words, [](const std::string& word) {
    return !FingerOf(word).empty() || !JointOf(word).empty() || !ArmPartOf(word).empty() ||
           IsSpread(word) || IsSensorWord(word) || IsJointWord(word);
  });
  return is_hand || HasWordOf(words, "x y z w flexion extension flex elbow img image") ||
         std::ranges::any_of(QuantityRules(), [&words](const QuantityRule& rule) {
           return rule.quantity != Quantity::kTime && HasWordOf(words, rule.words);
         });
}

struct Steps {
  double usual = 0.0;
  double unevenness = 0.0;     // mean difference from the usual step, as its multiple
  double rising_share = 0.0;   // share of steps >= 0
  double forward_share = 0.0;  // share of steps > 0
  bool is_count = false;       // nearly all steps are 1
  bool is_whole = true;        // no value has a fraction
};

Steps StepsOf(const std::vector<double>& values) {
  Steps steps;
  std::vector<double> all;
  std::size_t rising = 0, forward = 0, ones = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    rising += step >= 0.0 ? 1 : 0;
    forward += step > 0.0 ? 1 : 0;
    ones += step == 1.0 ? 1 : 0;
    if (step >= 0.0) all.push_back(step);
  }
  steps.is_whole =
      std::ranges::all_of(values, [](double value) { return value == std::round(value); });
  if (all.empty()) return steps;
  const double count = static_cast<double>(values.size() - 1);
  steps.usual = UsualInterval(all);
  for (const double step : all) {
    steps.unevenness +=
        std::abs(step - steps.usual) / (steps.usual * static_cast<double>(all.size()));
  }
  steps.rising_share = static_cast<double>(rising) / count;
  steps.forward_share = static_cast<double>(forward) / count;
  constexpr double kNearlyAll = 0.95;
  steps.is_count = static_cast<double>(ones) > kNearlyAll * count;
  return steps;
}

// Rates of gloves; other units of the time are a mistake.
constexpr double kSlowest_hz = 1.0;
constexpr double kFastest_hz = 1e4;

// Names of numbers that may be a time's, too.
constexpr std::string_view kRowNumbers = "i n id idx nr index sequence counter";
constexpr double kSince1970_s = 5e8;  // from 1985 on

bool IsRateOfGlove(double usual_step, std::string_view unit) {
  const double rate_hz = 1.0 / (usual_step * SecondsPer(std::string(unit)));
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

/// Unit by the size of the numbers if they count from a known date, else by the sampling rates of
/// gloves.
std::string_view UnitByValues(double first, double usual_step) {
  if (AreDays(first, usual_step)) return "day";
  if (AreTicks(first)) return "ticks";
  constexpr std::array<std::pair<double, std::string_view>, 4> kSince1970 = {
      {{1e17, "ns"}, {1e14, "us"}, {1e11, "ms"}, {kSince1970_s, "s"}}};
  for (const auto& [least, unit] : kSince1970) {
    if (first >= least) return unit;
  }
  constexpr double kLongest_s = 0.4;
  for (const std::string_view unit : {"s", "ms", "us", "ns"}) {
    if (usual_step * SecondsPer(std::string(unit)) <= kLongest_s) return unit;
  }
  return "ns";
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
std::vector<TimePart> NamedParts(const TableLayout& layout) {
  constexpr std::array<Meaning, 6> kParts = {{{"day", "day"},
                                              {"h", "hour hours hh"},
                                              {"min", "minute minutes min mm"},
                                              {"s", "second seconds sec secs ss"},
                                              {"ms", "ms millisecond milliseconds"},
                                              {"ns", "nsec nsecs nanosec"}}};
  std::vector<TimePart> parts;
  for (std::size_t column = 0; column < layout.columns; ++column) {
    const std::vector<std::string> words = WordsOf(layout.names[column]);
    if (words.empty() || KindOf(layout, column) != CellKind::kNumber) continue;
    const std::string unit(MeaningOf(kParts, words.back()));
    const bool is_new = std::ranges::find(parts, unit, &TimePart::unit) == parts.end();
    if (!unit.empty() && is_new) parts.push_back({column, unit});
  }
  const auto has = [&parts](std::string_view unit) {
    return std::ranges::find(parts, unit, &TimePart::unit) != parts.end();
  };
  if ((has("h") && has("min")) || (has("min") && has("s"))) return parts;
  if (has("s") && has("ns")) {
    std::erase_if(parts,
                  [](const TimePart& part) { return part.unit != "s" && part.unit != "ns"; });
    return parts;
  }
  return {};
}

/// True if these parts add up to a time that advances in nearly every row.
bool Advance(const std::vector<TimePart>& parts, const TableLayout& layout) {
  constexpr double kNearlyAll = 0.9;
  std::vector<double> times;
  for (const auto& row : layout.rows) {
    double sum_s = 0.0;
    for (const auto& [column, unit] : parts) {
      sum_s += unit == "date" ? SecondsOfText(row[column]).value_or(controller::kNaN)
                              : SecondsPer(unit) * NumberIn(layout, row[column]);
    }
    times.push_back(sum_s);
  }
  return StepsOf(times).forward_share > kNearlyAll;
}

/// Columns of dates and clock times: one with both, or one of each.
std::vector<TimePart> DateParts(const TableLayout& layout) {
  std::vector<TimePart> parts;
  for (std::size_t column = 0; column < layout.columns; ++column) {
    if (KindOf(layout, column) != CellKind::kTime) continue;
    const std::string& cell = layout.rows.front()[column];
    const bool has_clock = cell.find(':') != std::string::npos;
    const bool has_date = cell.find_first_of("-/") != std::string::npos ||
                          std::ranges::count(cell.substr(0, 10), '.') == 2;
    if (has_clock && has_date) return {{column, "date"}};
    parts.push_back({column, "date"});
  }
  return parts;
}

/// Whole seconds in dates or clocks, and a column with their milliseconds; without both nothing.
std::vector<TimePart> WithMilliseconds(std::vector<TimePart> dates, const TableLayout& layout) {
  for (std::size_t column = 0; column < layout.columns && !dates.empty(); ++column) {
    if (KindOf(layout, column) != CellKind::kNumber || UnitByName(layout.names[column]) != "ms") {
      continue;
    }
    const std::vector<double> values = ValuesOf(layout, column);
    if (!std::ranges::all_of(values, [](double ms) { return ms >= 0.0 && ms < 1000.0; })) continue;
    if (std::ranges::is_sorted(values)) continue;  // a time of its own
    dates.push_back({column, "ms"});
    return dates;
  }
  return {};
}

/// The time is this column: its unit is that of its name, unless no glove has that rate.
TimeGuess GuessOf(std::size_t column, const std::string& name, double first, double usual_step,
                  bool by_name) {
  constexpr double kUsualSlowest_hz = 5.0;
  constexpr double kUsualFastest_hz = 1500.0;
  const std::string_view named = UnitByName(name);
  const std::string_view by_values = UnitByValues(first, usual_step);
  const bool is_wrong = !named.empty() && named != by_values && !IsRateOfGlove(usual_step, named) &&
                        IsRateOfGlove(usual_step, by_values);
  const std::string unit(named.empty() || is_wrong ? by_values : named);
  const double rate_hz = 1.0 / (usual_step * SecondsPer(unit));
  TimeGuess guess = {{{column, unit}}, by_name ? "by its name" : "it rises in every row"};
  guess.is_named = by_name;
  guess.unit_is_guessed = named.empty() && first < kSince1970_s;
  // Steps of 1000 are as well milliseconds of a slow log as microseconds of a fast one.
  constexpr double kCoarser = 1e3;
  constexpr double kSlowestLog_s = 2.0;
  const bool may_be_slow =
      unit != "s" && unit != "day" && first < kSince1970_s && kCoarser / rate_hz <= kSlowestLog_s;
  guess.is_assumed =
      is_wrong || (!by_name && first < kSince1970_s) ||
      (named.empty() && (rate_hz < kUsualSlowest_hz || rate_hz > kUsualFastest_hz || may_be_slow));
  if (is_wrong) {
    guess.why += fmt::format("; {} by its values, not {} as its name says", unit, named);
  } else if (named.empty()) {
    guess.why += fmt::format("; {} by a step of {:.5g}", unit, usual_step);
  } else {
    guess.why += fmt::format("; {} by its name", unit);
  }
  return guess;
}

struct Candidate {
  std::size_t column = 0;
  double first = 0.0;
  Steps steps = {};
};

/// Order of two columns that rise: the likelier one goes back less often, or else is more even.
bool IsMoreLikeTime(const Candidate& one, const Candidate& other) {
  if (one.steps.forward_share != other.steps.forward_share) {
    return one.steps.forward_share > other.steps.forward_share;
  }
  return one.steps.unevenness < other.steps.unevenness;
}

}  // namespace

double SecondsPer(const std::string& time_unit) { return SecondsPerUnit(time_unit).value_or(1.0); }

TimeGuess GuessTime(const TableLayout& layout, const std::string& unit) {
  const auto dates = DateParts(layout);
  TimeGuess of_dates = {dates, dates.size() > 1 ? "date and clock" : "dates or clocks"};
  if (!dates.empty() && Advance(dates, layout)) return of_dates;
  if (const auto parts = WithMilliseconds(dates, layout); Advance(parts, layout)) {
    return {parts, "dates or clocks, and their milliseconds"};
  }
  if (const auto parts = NamedParts(layout); parts.size() > 1) {
    return {parts, "by the names of its parts, which add up"};
  }
  constexpr double kNearlyAll = 0.9;
  constexpr double kAll = 0.98;  // except where the clock starts anew
  TimeGuess best = {{}, "no column rises as a time does"};
  if (!dates.empty()) best = std::move(of_dates);
  for (const bool by_name : {true, false}) {
    if (!by_name && !dates.empty()) break;
    std::optional<Candidate> found;
    for (std::size_t column = 0; column < layout.columns; ++column) {
      const std::string& name = layout.names[column];
      if (KindOf(layout, column) != CellKind::kNumber) continue;
      const bool is_named =
          TimeScaleS(name).has_value() || (MayBeTime(name) && !IsSampleNumber(name));
      if (is_named != by_name || (!by_name && NamesOther(name))) continue;
      const std::vector<double> values = ValuesOf(layout, column);
      const Steps steps = StepsOf(values);
      // A program may poll faster than the glove samples. Then times repeat.
      const bool rises = steps.rising_share > kNearlyAll && steps.usual > 0.0;
      if (values.size() < 3 || !rises || (!by_name && steps.forward_share < kAll)) continue;
      const bool numbers_rows = steps.is_whole && values.front() < kSince1970_s &&
                                !TimeScaleS(name) && HasWordOf(WordsOf(name), kRowNumbers);
      const bool has_unit = !unit.empty() || !UnitByName(name).empty();
      if ((steps.is_count && !has_unit) || numbers_rows) {
        if (dates.empty()) best.why = fmt::format("column {} only counts the rows", column + 1);
        continue;
      }
      const Candidate candidate = {column, values.front(), steps};
      if (!found || (!by_name && IsMoreLikeTime(candidate, *found))) found = candidate;
    }
    if (found && !unit.empty()) return {{{found->column, unit}}, "in the unit that is given"};
    if (found) {
      return GuessOf(found->column, layout.names[found->column], found->first, found->steps.usual,
                     by_name);
    }
  }
  return best;
}

TimeGuess TimeOfMap(const std::vector<TimeMapping>& time) {
  TimeGuess guess = {{}, time.empty() ? "the map names none" : "by the map"};
  for (const TimeMapping& part : time) {
    guess.parts.push_back({part.column, part.is_text ? "date" : UnitOfSeconds(part.scale_s)});
  }
  return guess;
}

std::vector<TimeMapping> TimeByName(const TableLayout& layout) {
  std::vector<TimeMapping> time;
  const TimeGuess guess = GuessTime(layout);
  for (const TimePart& part : guess.parts) {
    if (!guess.is_named || guess.is_assumed) break;
    time.push_back({part.column, SecondsPer(part.unit), part.unit == "date"});
  }
  for (std::size_t c = 0; time.empty() && c < layout.columns; ++c) {
    const auto scale_s = TimeScaleS(layout.names[c]);
    if (scale_s) time.push_back({c, *scale_s, KindOf(layout, c) == CellKind::kTime});
  }
  return time;
}

}  // namespace gauntlet::sim
