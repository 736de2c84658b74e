#include "sim/recordings/inspect/stop_questions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

/// Share of the rows with an angle beyond the joint's range, by more than this share of the range.
double ShareBeyond(const Inspection& inspection, std::size_t c, double margin) {
  const InspectedColumn& column = inspection.columns[c];
  const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
  const double reach_deg = margin * (joint.max_deg - joint.min_deg) + 0.1;
  double factor = inspection.DegPerUnit() * (column.is_inverted ? -1.0 : 1.0);
  double offset_deg = 0.0;
  if (!column.mappings.empty()) {
    const ColumnScale scale = ScaleOf(column.mappings.front(), {});
    factor = scale.factor * kDegPerRad;
    offset_deg = scale.offset_rad * kDegPerRad;
  }
  double beyond = 0.0, all = 0.0;
  for (const double value : inspection.picture_values[c]) {
    if (!std::isfinite(value)) continue;
    all += 1.0;
    const double deg = factor * value + offset_deg;
    beyond += deg < joint.min_deg - reach_deg || deg > joint.max_deg + reach_deg ? 1.0 : 0.0;
  }
  return all > 0.0 ? beyond / all : 0.0;
}

/// True if values whose unit the file does not say reach neither below 0 nor above 100.
bool MayBePercent(const Inspection& inspection) {
  constexpr double kLeast = 90.0;
  double low = kNaN, high = kNaN;
  for (const std::size_t c : inspection.MappedColumns()) {
    low = std::fmin(low, inspection.columns[c].statistics.low);
    high = std::fmax(high, inspection.columns[c].statistics.high);
  }
  return inspection.unit_is_assumed && low >= 0.0 && high >= kLeast && high <= 100.0;
}

/// A sentence if an angle is mostly beyond its joint's range, or often far beyond it.
std::string RangeQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  if (!inspection.HasAngles()) return "";
  constexpr double kMostly = 0.5;
  constexpr double kOften = 0.05;
  constexpr double kFar = 0.5;  // of the joint's range: reading takes it for a glitch
  for (const std::size_t c : inspection.MappedColumns()) {
    const double share = ShareBeyond(inspection, c, 0.0);
    const double far_share = ShareBeyond(inspection, c, kFar);
    if (share < kMostly && far_share < kOften) continue;
    const Channel& joint = KnownChannels()[ChannelIndex(inspection.columns[c].channel)];
    return fmt::format(
        "column {}: {} of {:.0f} % of the rows is outside its range, {:g} to {:g} deg; {}the unit "
        "[{}] or the joint is another{}",
        c + 1, joint.name, 100.0 * std::max(share, far_share), joint.min_deg, joint.max_deg,
        inspection.columns[c].is_from_straight
            ? "angles between bones, 180 deg where straight, are as in the "
              "map: sign -1 and an offset; else "
            : "",
        NameOf(inspection.unit), MayBePercent(inspection) ? "; --unit percent if they are" : "");
  }
  return "";
}

/// A sentence if the joints have a clock of their own, with the first word of their names, whose
/// duration is not that of the time.
std::string ClockQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  constexpr double kSame = 0.005;  // of the duration
  const double duration_s = inspection.time.duration_s;
  for (std::size_t c = 0; inspection.has_time && c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const std::size_t cut = std::min(column.name.find('_'), column.name.size() - 1) + 1;
    const auto scale_s = TimeScaleS(column.name.substr(cut));
    const double own_s = scale_s.value_or(kNaN) * (column.statistics.high - column.statistics.low);
    const std::string_view word = std::string_view(column.name).substr(0, cut);
    const auto has_word = [&](std::size_t i) {
      return inspection.columns[i].name.starts_with(word);
    };
    if (column.is_time || !(std::abs(own_s - duration_s) > kSame * duration_s) ||
        !std::ranges::all_of(inspection.MappedColumns(), has_word)) {
      continue;
    }
    return fmt::format(
        "the joints have a clock of their own, column {}, which takes {:.4g} s, not {:.4g} s; "
        "name it as the time in a map",
        c + 1, own_s, duration_s);
  }
  return "";
}

/// A sentence if the time falls from row to row, or in so many that it is not used.
std::string FallingTimeQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  constexpr double kNearlyAlways = 0.9;
  constexpr double kOften = 0.05;
  for (std::size_t c = 0; !inspection.has_time && c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const double share = column.statistics.falling_share;
    if (!TimeScaleS(column.name) || share <= kOften) continue;
    return share > kNearlyAlways
               ? fmt::format("the time (column {}) falls from row to row; sort the rows by it",
                             c + 1)
               : fmt::format(
                     "the time (column {}) goes back in {:.0f} % of the rows; sort the "
                     "rows by it",
                     c + 1, 100.0 * share);
  }
  return "";
}

/// A sentence if the unit of the time is unknown, and no rate is known.
std::string TimeUnitQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  if (inspection.rate_is_known || inspection.time_question.empty()) return "";
  return inspection.time_question +
         "; --time-unit s, ms, us or ns says the unit, or --rate HZ the rate of the rows";
}

/// A sentence if texts that may be the time are not understood, and the rate would be assumed.
std::string TextTimeQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  for (std::size_t c = 0; !inspection.rate_is_known && c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    const bool is_named = TimeScaleS(column.name) ||
                          HasWordOf(WordsOf(column.name), "time timestamp datetime clock stamp");
    if (inspection.has_time || column.kind != CellKind::kText || !is_named) continue;
    return fmt::format(
        "the time (column {}) is a text that is not understood: '{}'; write it in seconds, or give "
        "the rate to gauntlet inspect --rate HZ",
        c + 1, OneLine(inspection.layout.rows.front()[c], 30));
  }
  return "";
}

/// A sentence if an array of texts may be the time, is left out, and the rate would be assumed.
std::string LeftOutTimeQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  constexpr std::string_view kBegin = "left out: ";
  constexpr std::string_view kEnd = " (texts)";
  if (inspection.rate_is_known || inspection.has_time) return "";
  for (const std::string& remark : inspection.remarks) {
    if (!remark.starts_with(kBegin) || !remark.ends_with(kEnd)) continue;
    const std::string_view all =
        std::string_view(remark).substr(kBegin.size(), remark.size() - kBegin.size() - kEnd.size());
    for (const std::string_view cell : SplitCells(all, ',')) {
      const std::string name(Trimmed(cell));
      if (!TimeScaleS(name) && !HasWordOf(WordsOf(name), "time timestamp datetime")) continue;
      return fmt::format(
          "the time ({}) is an array of texts, which is not read; write it in seconds, or give the "
          "rate to gauntlet inspect --rate HZ",
          OneLine(name, 30));
    }
  }
  return "";
}

/// A sentence if the header has one name too few, and it is unknown which.
std::string HeaderQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  if (!inspection.problems.contains(std::string(NameOf(RecordingProblem::kShortHeader)))) return "";
  const bool is_last = inspection.columns.back().name.empty();
  const InspectedColumn& nameless =
      is_last ? inspection.columns.back() : inspection.columns.front();
  constexpr double kNearlyAll = 0.95;
  const bool counts = nameless.statistics.counting_share > kNearlyAll;
  const bool is_clear = nameless.kind != CellKind::kNumber || nameless.statistics.step == 0.0 ||
                        nameless.is_time || (!is_last && counts) ||
                        (!is_last && !inspection.time_question.empty());
  if (is_clear) return "";
  return fmt::format(
      "the header has {} names for {} columns, and the one without a name is unknown; name all",
      inspection.columns.size() - 1, inspection.columns.size());
}

/// A sentence if the header has one name too many, and it is unknown which.
std::string LongHeaderQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  const std::string& extra = inspection.layout.extra_name;
  const bool is_clear = extra.empty() ||
                        HasWordOf(WordsOf(extra), "comment comments remark note notes label") ||
                        WordsOf(extra).empty() ||
                        std::ranges::any_of(inspection.columns, [](const InspectedColumn& column) {
                          return column.is_time && TimeScaleS(column.name).has_value();
                        });
  if (is_clear) return "";
  return fmt::format(
      "the header has {} names for {} columns, and the one without values is unknown; name each "
      "column once",
      inspection.columns.size() + 1, inspection.columns.size());
}

/// A sentence if the time is missing in many rows, or goes back in many.
std::string TimeQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  if (!inspection.has_time) return "";
  constexpr double kMost = 0.05;
  const auto rows = static_cast<double>(inspection.rows);
  const double missing = static_cast<double>(inspection.time.missing) / rows;
  const double restarts = static_cast<double>(inspection.time.restarts) / rows;
  if (missing > kMost) {
    return fmt::format("the time is missing in {:.0f} % of the rows; keep those that have one",
                       100.0 * missing);
  }
  if (restarts > kMost) {
    return fmt::format("the time goes back in {:.0f} % of the rows; sort them by the time",
                       100.0 * restarts);
  }
  return "";
}

/// A sentence if rows of several tables are below each other.
std::string TablesQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  constexpr std::size_t kMostRows = 9;  // more are no lines above a table
  constexpr std::size_t kFewRows = 2;
  const TableLayout& layout = inspection.layout;
  if (layout.rows_before > kMostRows ||
      (layout.rows_before > kFewRows && kMostRows * layout.rows_before > inspection.rows)) {
    return fmt::format(
        "{} rows above the table have another number of columns; write each table to a file",
        layout.rows_before);
  }
  if (layout.second_names_line == 0) return "";
  return fmt::format("line {} names the columns anew, in another way; write each table to a file",
                     layout.second_names_line);
}

/// A sentence if many rows have another number of values than there are columns.
std::string RowsQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  constexpr double kMost = 0.05;
  for (const auto& [problem, words] : {std::pair(RecordingProblem::kTruncatedRow, "fewer"),
                                       std::pair(RecordingProblem::kRowTooLong, "more")}) {
    const auto found = inspection.problems.find(std::string(NameOf(problem)));
    if (found == inspection.problems.end()) continue;
    const double share = static_cast<double>(found->second) / static_cast<double>(inspection.rows);
    if (share <= kMost) continue;
    return fmt::format(
        "{:.0f} % of the rows have {} than {} values; write as many in each, empty ones where "
        "there are none",
        100.0 * share, words, inspection.columns.size());
  }
  return "";
}

/// Seconds in a cell of a column of times.
double SecondsIn(const Inspection& inspection, std::size_t column, const std::string& cell) {
  const InspectedColumn& is = inspection.columns[column];
  if (is.kind != CellKind::kNumber) return SecondsOfText(cell).value_or(kNaN);
  const double scale_s = is.is_time ? SecondsPer(is.time_unit) : TimeScaleS(is.name).value_or(1.0);
  return scale_s * NumberIn(inspection.layout, cell);
}

/// A sentence if joints stand before and behind a second clock that is not the time: each then has
/// a clock of its own.
std::string OwnClocksQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  const std::vector<InspectedColumn>& columns = inspection.columns;
  const std::vector<std::size_t> joints = inspection.MappedColumns();
  const auto time = std::ranges::find_if(columns, &InspectedColumn::is_time);
  if (std::ranges::count_if(columns, &InspectedColumn::is_time) != 1 || joints.empty()) {
    return "";
  }
  const auto time_column = static_cast<std::size_t>(time - columns.begin());
  for (std::size_t c = joints.front() + 1; c < joints.back(); ++c) {
    const bool is_clock = columns[c].kind == CellKind::kTime ||
                          HasWordOf(WordsOf(columns[c].name), "time timestamp clock");
    if (columns[c].is_time || columns[c].is_sensor || columns[c].kind == CellKind::kText ||
        !is_clock) {
      continue;
    }
    constexpr double kOften = 0.05;
    double apart = 0.0, farthest_s = 0.0;
    for (const std::vector<std::string>& row : inspection.layout.rows) {
      const double away_s = std::abs(SecondsIn(inspection, c, row[c]) -
                                     SecondsIn(inspection, time_column, row[time_column]));
      apart += away_s * inspection.time.rate_hz > 1.0 ? 1.0 : 0.0;
      farthest_s = std::fmax(farthest_s, away_s);
    }
    if (apart <= kOften * static_cast<double>(inspection.layout.rows.size())) continue;
    return fmt::format(
        "columns {} and {} are clocks of different joints, up to {:.3g} s apart; keep one clock "
        "and its joints, or name the time in a map",
        time_column + 1, c + 1, farthest_s);
  }
  return "";
}

/// A sentence if the rate is that of no glove.
std::string RateBeyondQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  constexpr double kSlowest_hz = 1.0;
  constexpr double kFastest_hz = 1e4;
  const double rate_hz = inspection.time.rate_hz;
  if (rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz) return "";
  return fmt::format(
      "{:.4g} rows per second, must be from 1 to 10000: the unit of the time is another "
      "(--time-unit)",
      rate_hz);
}

/// Columns of numbers that are no time, label or number of a row.
std::vector<std::size_t> ValuesOf(const Inspection& inspection) {
  std::vector<std::size_t> values;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    using enum Quantity;
    const InspectedColumn& is = inspection.columns[c];
    const bool is_aside = is.is_time || is.quantity == kTime || is.quantity == kNumber ||
                          is.quantity == kLabel || is.quantity == kNothing;
    if (is.kind == CellKind::kNumber && !is_aside) values.push_back(c);
  }
  return values;
}

/// The column that names the sensor of each row, if there are several.
std::optional<std::size_t> NamesOfValues(const Inspection& inspection,
                                         std::span<const RowGroups> groups) {
  for (const RowGroups& group : groups) {
    const InspectedColumn& column = inspection.columns[group.column()];
    if (column.kind != CellKind::kText || group.count() < 2 || !NamesValues(column.name)) continue;
    if (group.Alternate() || ValuesOf(inspection).size() == 1) return group.column();
  }
  return std::nullopt;
}

/// A sentence if each row has the values of one sensor.
std::string LongTableQuestion(const Inspection& inspection, std::span<const RowGroups> groups) {
  const auto names = NamesOfValues(inspection, groups);
  if (!names) return "";
  const auto shown = [&](std::size_t c) { return OneLine(inspection.columns[c].name, 20); };
  const std::vector<std::size_t> values = ValuesOf(inspection);
  const auto time = std::ranges::find_if(inspection.columns, &InspectedColumn::is_time);
  std::string way;
  if (values.size() == 1 && time != inspection.columns.end()) {
    way = fmt::format(
        ", as pandas does: pd.read_csv(FILE).pivot(index='{}', columns='{}', values='{}')"
        ".to_csv(NEW)",
        OneLine(time->name, 20), shown(*names), shown(values.front()));
  }
  return fmt::format("column {} '{}' names the sensor of each row; write a column for each{}",
                     *names + 1, shown(*names), way);
}

/// A sentence if rows of several hands or devices take turns.
std::string AlternatingQuestion(const Inspection& inspection, std::span<const RowGroups> groups) {
  for (const RowGroups& group : groups) {
    const std::string& name = inspection.columns[group.column()].name;
    const bool names_hands = HasWordOf(WordsOf(name), "hand handedness side");
    if (!group.Alternate() && !(names_hands && group.count() == 2)) continue;
    return fmt::format("rows of {} hands or devices{} (column {} '{}'); {}", group.count(),
                       group.Alternate() ? " alternate" : "", group.column() + 1, OneLine(name, 20),
                       HandColumn(inspection.layout) == group.column()
                           ? "--hand left or --hand right takes one"
                           : "keep those of one in a file");
  }
  return "";
}

/// A sentence if the rows of two senders take turns.
std::string SendersQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  return inspection.senders ? TextOf(*inspection.senders) : "";
}

std::string StillQuestion(const Inspection& inspection, std::span<const RowGroups>) {
  return inspection.MappedColumns().empty()
             ? "no sensor of the hand changes its value by more than its noise"
             : "";
}

struct StopRule {
  std::string (*ask)(const Inspection& inspection, std::span<const RowGroups> groups);
  Remedy remedy;
  bool with_map = false;  // asked even if a map names time and joints
};

/// The first sentence counts.
constexpr StopRule kStopRules[] = {
    {LongTableQuestion, Remedy::kInSentence, true},
    {AlternatingQuestion, Remedy::kInSentence, true},
    {SendersQuestion, Remedy::kInSentence, true},
    {RateBeyondQuestion, Remedy::kMap, true},
    {FallingTimeQuestion, Remedy::kInSentence},
    {StillQuestion, Remedy::kInSentence, true},
    {TablesQuestion, Remedy::kInSentence, true},
    {RowsQuestion, Remedy::kInSentence, true},
    {TimeQuestion, Remedy::kInSentence, true},
    {HeaderQuestion, Remedy::kInSentence},
    {LongHeaderQuestion, Remedy::kInSentence},
    {OwnClocksQuestion, Remedy::kMap},
    {TextTimeQuestion, Remedy::kInSentence},
    {LeftOutTimeQuestion, Remedy::kInSentence},
    {TimeUnitQuestion, Remedy::kInSentence},
    {ClockQuestion, Remedy::kMap},
    {RangeQuestion, Remedy::kPresetOrMap},
};

}  // namespace

bool NamesValues(const std::string& name) {
  return HasWordOf(WordsOf(name),
                   "sensor sensors joint joints channel finger servo motor variable signal");
}

bool IsLongTable(const Inspection& inspection, std::span<const RowGroups> groups) {
  return NamesOfValues(inspection, groups).has_value();
}

StopQuestion FindStopQuestion(const Inspection& inspection, std::span<const RowGroups> groups,
                              bool has_map) {
  for (const StopRule& rule : kStopRules) {
    if (has_map && !rule.with_map) continue;
    if (std::string sentence = rule.ask(inspection, groups); !sentence.empty()) {
      return {.sentence = std::move(sentence), .remedy = rule.remedy};
    }
  }
  return {};
}

}  // namespace gauntlet::sim
