#include "sim/inspect/time_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sim/base/error.h"
#include "sim/inspect/joint_names.h"
#include "sim/inspect/table_statistics.h"
#include "sim/recordings/time_columns.h"

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

struct Steps {
  double usual = 0.0;
  double rising_share = 0.0;   // share of steps >= 0
  double forward_share = 0.0;  // share of steps > 0
  bool is_count = false;       // nearly all steps are 1
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
  if (all.empty()) return steps;
  const double count = static_cast<double>(values.size() - 1);
  steps.usual = UsualInterval(all);
  steps.rising_share = static_cast<double>(rising) / count;
  steps.forward_share = static_cast<double>(forward) / count;
  constexpr double kNearlyAll = 0.95;
  steps.is_count = static_cast<double>(ones) > kNearlyAll * count;
  return steps;
}

/// Unit by the size of the numbers if they count from 1970, else by the sampling rates of gloves.
std::string_view UnitByValues(double first, double usual_step) {
  constexpr std::array<std::pair<double, std::string_view>, 4> kSince1970 = {
      {{1e17, "ns"}, {1e14, "us"}, {1e11, "ms"}, {5e8, "s"}}};
  for (const auto& [least, unit] : kSince1970) {
    if (first >= least) return unit;
  }
  constexpr double kLongest_s = 0.4;
  for (const std::string_view unit : {"s", "ms", "us", "ns"}) {
    if (usual_step * SecondsPer(std::string(unit)) <= kLongest_s) return unit;
  }
  return "ns";
}

/// Unit at the end of a name such as time_ms; empty if there is none.
std::string_view UnitByName(const std::string& name) {
  const auto scale_s = TimeScaleS(name);
  if (!scale_s) return "";
  if (*scale_s == 1.0) {
    const std::vector<std::string> words = WordsOf(name);
    const bool says_so = words.back().starts_with("s") && words.size() + words.back().size() > 2;
    return says_so ? "s" : "";
  }
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

}  // namespace

double SecondsPer(const std::string& time_unit) { return SecondsPerUnit(time_unit).value_or(1.0); }

TimeGuess GuessTime(const TableLayout& layout) {
  if (const auto dates = DateParts(layout); !dates.empty()) {
    return {dates, dates.size() > 1 ? "date and clock" : "dates or clocks"};
  }
  if (const auto parts = NamedParts(layout); parts.size() > 1) {
    return {parts, "by the names of its parts, which add up"};
  }
  constexpr double kNearlyAll = 0.9;
  constexpr double kAll = 0.98;  // except where the clock starts anew
  TimeGuess best = {{}, "no column rises as a time does"};
  for (const bool by_name : {true, false}) {
    for (std::size_t column = 0; column < layout.columns; ++column) {
      const std::string& name = layout.names[column];
      if (KindOf(layout, column) != CellKind::kNumber) continue;
      const bool is_named =
          TimeScaleS(name).has_value() || (MayBeTime(name) && !IsSampleNumber(name));
      if (is_named != by_name) continue;
      const std::vector<double> values = ValuesOf(layout, column);
      const Steps steps = StepsOf(values);
      // A program may poll faster than the glove samples. Then times repeat.
      const bool rises = steps.rising_share > kNearlyAll && steps.usual > 0.0;
      if (values.size() < 3 || !rises || (!by_name && steps.forward_share < kAll)) continue;
      if (steps.is_count && UnitByName(name).empty()) {
        best.why = fmt::format("column {} only counts the rows", column + 1);
        continue;
      }
      const std::string_view by_values = UnitByValues(values.front(), steps.usual);
      const std::string_view unit = UnitByName(name).empty() ? by_values : UnitByName(name);
      std::string why = by_name ? "by its name" : "it rises in every row";
      why +=
          UnitByName(name).empty()
              ? fmt::format("; {}, as a step of {:.5g} would else be no glove's", unit, steps.usual)
              : fmt::format("; {} by its name", unit);
      if (unit != by_values) why += fmt::format(" (the values look like {})", by_values);
      return {{{column, std::string(unit)}}, why};
    }
  }
  return best;
}

}  // namespace gauntlet::sim
