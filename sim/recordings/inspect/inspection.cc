#include "sim/recordings/inspect/inspection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <set>
#include <string_view>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/base/unfinished_mark.h"
#include "sim/recordings/column_map.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/envelope.h"
#include "sim/recordings/inspect/health.h"
#include "sim/recordings/inspect/senders.h"
#include "sim/recordings/inspect/stop_questions.h"
#include "sim/recordings/profile.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/missing.h"
#include "sim/tables/name_words.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

/// A table as it is, or the beginning of a text, cut at the end of a line. `is_whole` becomes false
/// if the text has more.
TableInput BeginningOf(TableInput input, const std::shared_ptr<bool>& is_whole) {
  if (!std::holds_alternative<CsvReader::Source>(input)) return input;
  auto source = std::get<CsvReader::Source>(std::move(input));
  return [source = std::move(source), is_whole, given = std::uintmax_t{0}](
             char* buffer, std::size_t size) mutable -> std::size_t {
    if (!*is_whole) return 0;
    const std::size_t got = source(buffer, size);
    given += got;
    if (given < kMostInspectedBytes) return got;
    *is_whole = false;
    const std::string_view text(buffer, got);
    return std::min(text.rfind('\n'), got - 1) + 1;
  };
}

/// True for the name of a column that tells hands or devices apart. One of numbers may be a
/// sensor's, too, unless it is called so at its end.
bool NamesDevices(const std::string& name, CellKind kind) {
  const std::vector<std::string> words = WordsOf(name);
  if (kind == CellKind::kNumber) {
    return !words.empty() && IsWordOf("handedness side device id track", words.back());
  }
  return kind == CellKind::kText &&
         (HasWordOf(words, "hand handedness side device glove id track") || NamesValues(name));
}

/// Columns that may tell hands, devices or sessions apart by their names.
std::vector<RowGroups> GroupsToWatch(const Inspection& inspection) {
  std::vector<RowGroups> groups;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    if (NamesDevices(column.name, column.kind) || NamesParts(column.name)) groups.emplace_back(c);
  }
  return groups;
}

/// The column of the time, or the first that has its name, though its time does not rise. The
/// number of columns: none.
std::size_t ClockOf(const TimeGuess& time, const std::vector<InspectedColumn>& columns) {
  if (!time.parts.empty()) return time.parts.front().column;
  const auto named = std::ranges::find_if(columns, [](const InspectedColumn& column) {
    return column.kind == CellKind::kNumber && TimeScaleS(column.name);
  });
  return static_cast<std::size_t>(named - columns.begin());
}

/// Reads the whole table once. Rows that repeat the one before, with its time, do not count if
/// nearly all rows at the time of the one before are such: they were written twice. `doubled`: how
/// many do not count.
TableStatistics ReadTable(const TimeGuess& time, const std::vector<InspectedColumn>& columns,
                          const std::optional<HandRows>& hand, CsvReader& csv,
                          MidnightClock& midnight, std::vector<RowGroups>& groups,
                          SenderWatch& senders, std::size_t& doubled) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].kind == CellKind::kText && !(hand && hand->column == c)) csv.ReadAsTexts(c);
    if (columns[c].kind == CellKind::kTime) csv.ReadAsTime(c);
  }
  TableStatistics statistics(csv.column_count());
  std::vector<double> values(csv.column_count());
  const std::size_t clock = ClockOf(time, columns);
  std::optional<TableStatistics> once;  // of the rows that are no such
  std::vector<double> before(csv.column_count());
  double before_s = kNaN;
  std::size_t at_same_time = 0;
  constexpr int kMostCopies = 3;  // more are a clock that stands still
  int copies = 0;
  while (csv.NextRow(values)) {
    const double time_s = midnight.Add(time.parts.empty() ? kNaN : TimeOfRow(time.parts, values));
    const bool is_at_same_time = time_s == before_s;
    at_same_time += is_at_same_time ? 1 : 0;
    if (!is_at_same_time) copies = 0;
    if (is_at_same_time && copies < kMostCopies && AreSame(values, before)) {
      ++copies;
      ++doubled;
      if (!once) once = statistics;
    } else if (once) {
      once->Add(time_s, values);
    }
    before_s = time_s;
    before = values;
    statistics.Add(time_s, values);
    const bool is_named = time.parts.empty() && clock < values.size();
    senders.Add(is_named ? *TimeScaleS(columns[clock].name) * values[clock] : time_s, values);
    for (RowGroups& group : groups) group.Add(values[group.column()]);
  }
  constexpr double kNearlyAll = 0.98;
  if (static_cast<double>(doubled) < kNearlyAll * static_cast<double>(at_same_time)) doubled = 0;
  return doubled > 0 ? *once : statistics;
}

/// A clock whose steps are longer than those of the rows.
bool IsCoarse(const TimeStatistics& time, std::size_t rows) {
  constexpr double kMostRepeats = 0.04;  // more would need a repair of too many rows
  return time.duration_s > 0.0 &&
         static_cast<double>(time.repeats) > kMostRepeats * static_cast<double>(rows);
}

/// Rows that come in bursts, as USB packets do: most intervals are far shorter or far longer than
/// the usual one.
bool IsInBursts(const TimeStatistics& time) {
  constexpr double kFar = 4.0;
  const double usual_ms = 1e3 / time.rate_hz;
  return time.short_ms < usual_ms / kFar && time.long_ms > kFar * usual_ms;
}

/// The rates in a line before the table: numbers behind `rate` or `fs`, or before `Hz`. Other
/// numbers of the line, as of a version, are none.
std::vector<double> RatesIn(const std::string& note) {
  constexpr double kSlowest_hz = 1.0;
  constexpr double kFastest_hz = 1e4;
  std::vector<double> rates_hz;
  constexpr std::string_view kInterval = "Delta_X";  // of LabVIEW, in s
  if (note.starts_with(kInterval)) {
    const std::string_view rest = Trimmed(std::string_view(note).substr(kInterval.size()));
    const auto interval_s = controller::ParseNumber(rest.substr(0, rest.find_first_of(" \t,;")));
    if (interval_s && *interval_s > 0.0) rates_hz.push_back(1.0 / *interval_s);
    return rates_hz;
  }
  if (!HasWordOf(WordsOf(note),
                 "sampling sample samplerate samplingrate samples fps fs frame update")) {
    return rates_hz;
  }
  constexpr std::string_view kDigits = "0123456789";
  for (std::size_t behind = 0, digit = note.find_first_of(kDigits); digit != std::string::npos;
       digit = note.find_first_of(kDigits, behind)) {
    const std::string before = note.substr(behind, digit - behind);
    behind = std::min(note.find_first_not_of("0123456789.", digit), note.size());
    const std::string number = note.substr(digit, behind - digit);
    const std::size_t next = std::min(note.find_first_of(kDigits, behind), note.size());
    const std::vector<std::string> unit = WordsOf(note.substr(behind, next - behind));
    const auto rate_hz = controller::ParseNumber(number);
    const bool is_rate =
        HasWordOf(WordsOf(before), "rate frequency hz fps fs samplerate samplingrate") ||
        (!unit.empty() && HasWordOf({unit.front()}, "hz fps"));
    if (is_rate && rate_hz && *rate_hz >= kSlowest_hz && *rate_hz <= kFastest_hz) {
      rates_hz.push_back(*rate_hz);
    }
  }
  return rates_hz;
}

/// Rate in the lines before the table, as `Sampling rate: 100 Hz`; 0 if there is none, or if they
/// contain several.
double RateInNotes(const std::vector<std::string>& notes) {
  double found_hz = 0.0;
  for (const std::string& note : notes) {
    for (const double rate_hz : RatesIn(note)) {
      if (found_hz > 0.0 && rate_hz != found_hz) return 0.0;
      found_hz = rate_hz;
    }
  }
  return found_hz;
}

/// The value of a column that has the rate in every row, as `fps`; 0 if there is none.
double RateInColumns(const std::vector<InspectedColumn>& columns) {
  constexpr double kSlowest_hz = 1.0;
  constexpr double kFastest_hz = 1e4;
  for (const InspectedColumn& column : columns) {
    const ColumnStatistics& is = column.statistics;
    const bool is_constant = is.good_rows > 1 && is.low == is.high;
    if (!is_constant || is.low < kSlowest_hz || is.low > kFastest_hz) continue;
    if (IsWordOf("fps fs rate ratehz framerate frameratehz samplerate samplingrate "
                 "sampleratehz samplingratehz samplinghz samplehz",
                 BareName(column.name))) {
      return is.low;
    }
  }
  return 0.0;
}

/// A table whose rows have no times of their own: the rate is the given one (0: none), the mean of
/// a coarse clock, or an assumption.
void SetRate(const TimeStatistics& time, bool is_coarse, double given_rate_hz,
             Inspection& inspection) {
  constexpr double kAssumedRateHz = 50.0;
  inspection.rate_is_known = given_rate_hz > 0.0;
  inspection.rate_is_assumed = !inspection.rate_is_known;
  const auto rows = static_cast<double>(inspection.rows);
  // A clock of whole seconds begins and ends within one: only between its steps rows are counted.
  const double mean_rate_hz =
      time.mean_rate_hz > 0.0 ? time.mean_rate_hz : (rows - 1.0) / time.duration_s;
  inspection.time.rate_hz = inspection.rate_is_known ? given_rate_hz
                            : is_coarse              ? mean_rate_hz
                                                     : kAssumedRateHz;
  inspection.time.duration_s = rows / inspection.time.rate_hz;
}

/// The map that is given, if one is.
std::optional<ColumnMap> MapOf(const Inspection& inspection, const std::string& map) {
  if (map.empty()) return std::nullopt;
  return ReadColumnMap(map, {.name = inspection.file,
                             .header = inspection.layout.names,
                             .count = inspection.layout.columns,
                             .may_choose_rows = true});
}

/// The rows of the hand that a person asks for, if a column has it.
std::optional<HandRows> HandOf(const Inspection& inspection, const std::string& side) {
  const auto column = side.empty() ? std::nullopt : HandColumn(inspection.layout);
  return column ? std::optional(HandRows{*column, side}) : std::nullopt;
}

/// Leaves out the rows of the other hand.
void KeepRowsOfHand(CsvReader& reader, Inspection& inspection) {
  if (!inspection.hand) return;
  const auto& [column, side] = *inspection.hand;
  KeepHand(*inspection.hand, reader);
  inspection.remarks.push_back(fmt::format("rows of the {} hand only, by column {} '{}'", side,
                                           column + 1,
                                           OneLine(inspection.columns[column].name, 20)));
  std::vector<std::vector<std::string>> rows = inspection.layout.rows;
  std::erase_if(rows, [&](const std::vector<std::string>& row) {
    return HandInText(row[inspection.hand->column]) != inspection.hand->side;
  });
  if (!rows.empty()) inspection.layout.rows = std::move(rows);
}

/// The time of the profile that a person names, or whose names the table has; else a guess.
TimeGuess TimeOf(const TableLayout& layout, const std::vector<Profile>& profiles,
                 const InspectionOptions& options) {
  for (const Profile& profile : profiles) {
    const std::vector<std::string>& names = profile.match.names;
    const bool has_names = !names.empty() && std::ranges::all_of(names, [&](const auto& name) {
      return std::ranges::any_of(
          layout.names, [&name](const std::string& other) { return IsSameName(name, other); });
    });
    const std::string& preset = options.joints.preset;
    if (!has_names || (!preset.empty() && preset != profile.name)) continue;
    const ColumnMap map = MapOfProfile(
        profile, {.name = "the table", .header = layout.names, .count = layout.columns});
    if (map.time.empty()) continue;
    TimeGuess time = TimeOfMap(map.time);
    time.why = "by the profile " + profile.name;
    return time;
  }
  return GuessTime(layout, options.time_unit);
}

/// Takes over the guessed time columns if their time advances from row to row.
void SetTime(const TimeGuess& guess, const TimeStatistics& time, double given_rate_hz,
             Inspection& inspection) {
  const bool is_bursts = !guess.parts.empty() && IsInBursts(time);
  const bool is_coarse = is_bursts || (!guess.parts.empty() && IsCoarse(time, inspection.rows));
  inspection.has_time = !guess.parts.empty() && std::isfinite(time.rate_hz) && !is_coarse;
  inspection.rate_is_known = inspection.has_time;
  inspection.time_why = guess.parts.empty() || inspection.has_time ? guess.why
                        : is_bursts ? "its rows come in bursts and are spread evenly"
                        : is_coarse ? "its clock repeats in many rows; the mean rate counts"
                                    : "its column has no two rows at different times";
  inspection.time_question = guess.question;
  if (guess.asked) inspection.columns.at(*guess.asked).is_time = true;
  for (const TimeMapping& part : guess.parts) inspection.columns.at(part.column).is_time = true;
  if (!inspection.has_time) {
    SetRate(time, is_coarse, given_rate_hz, inspection);
    return;
  }
  inspection.rate_is_assumed = guess.unit_is_assumed;
  inspection.time = time;
  for (const TimeMapping& part : guess.parts) {
    inspection.columns.at(part.column).time_unit = UnitOfTime(part);
  }
}

int BitsFor(double high) {
  for (const int bits : {8, 10, 12, 14, 16, 24}) {
    if (high < std::ldexp(1.0, bits)) return bits;
  }
  return 32;
}

std::vector<ColumnEvidence> EvidenceOf(const Inspection& inspection,
                                       const std::vector<std::size_t>& clocks) {
  std::vector<ColumnEvidence> evidence;
  const std::vector<std::string> own = WithJoints(WithDigits(WithFingers(inspection.layout.names)));
  const std::vector<std::string> english = InEnglish(own);
  const std::vector<std::string>& names = english.empty() ? own : english;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    evidence.push_back({.name = names[c],
                        .is_text = column.kind != CellKind::kNumber,
                        .is_time = column.is_time || std::ranges::find(clocks, c) != clocks.end(),
                        .statistics = column.statistics});
  }
  return evidence;
}

/// The family of the columns that a person calls sensors, and nothing else.
std::vector<ColumnFamily> GivenFamily(const std::vector<ColumnEvidence>& evidence,
                                      std::size_t first, std::size_t last) {
  if (first < 1 || last < first || last > evidence.size()) {
    throw UserError(fmt::format("--columns must be FIRST-LAST within 1 and {}", evidence.size()));
  }
  std::vector<std::size_t> columns(last - first + 1);
  std::iota(columns.begin(), columns.end(), first - 1);
  for (const std::size_t c : columns) {
    if (!evidence[c].is_text && !evidence[c].is_time && evidence[c].statistics.good_rows > 0) {
      continue;
    }
    throw UserError(fmt::format("--columns: column {} {}", c + 1,
                                evidence[c].is_time ? "is the time" : "contains no numbers"));
  }
  return {FamilyOfSensors(evidence, columns)};
}

/// True for a sensor that carries nothing: it hardly ever leaves one value, or seldom and not far,
/// or has only noise. `is_mixed`: the rows are of two senders, which look like noise.
bool IsDead(const InspectedColumn& column, double widest, bool is_mixed) {
  const ColumnStatistics& is = column.statistics;
  constexpr double kAlways = 0.99;
  constexpr double kMostly = 0.95;
  constexpr double kNarrow = 0.5;  // of the widest range of a sensor
  return is.commonest_share >= kAlways || (!is_mixed && IsOnlyNoise(column)) ||
         (is.commonest_share >= kMostly && is.high - is.low < kNarrow * widest);
}

/// True for activity that is rectified already: never below zero, and near it at rest.
bool IsRectified(const ColumnStatistics& is) {
  constexpr double kNearZero = 0.1;  // of the highest usual value
  return is.low >= 0.0 && is.usual_low < kNearZero * is.usual_high;
}

/// Replaces the statistics of raw muscle signals by those of their envelopes. `table`: of the file;
/// a text or stream has been read, and is opened again.
void ComputeEnvelopeStatistics(const std::filesystem::path& file, TableInput table,
                               const TimeGuess& time, Inspection& inspection) {
  std::vector<std::pair<std::size_t, Envelope>> envelopes;
  for (const std::size_t c : inspection.Sensors()) {
    if (inspection.columns[c].quantity != Quantity::kMuscle) continue;
    if (IsRectified(inspection.columns[c].statistics)) continue;
    envelopes.emplace_back(c, Envelope(kUsualEnvelope_ms));
  }
  if (envelopes.empty()) return;
  const auto is_whole = std::make_shared<bool>(true);
  if (!std::holds_alternative<std::shared_ptr<const Table>>(table)) {
    table = TableSource(file, inspection.array);
  }
  auto [layout, reader] =
      FindTable(file.string(), BeginningOf(std::move(table), is_whole), ProblemHandling::kRepair);
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    if (inspection.columns[c].kind == CellKind::kText) reader.Ignore(c);
    if (inspection.columns[c].kind == CellKind::kTime) reader.ReadAsTime(c);
  }
  if (inspection.hand) KeepHand(*inspection.hand, reader);
  TableStatistics statistics(envelopes.size());
  std::vector<double> values(reader.column_count());
  std::vector<double> active(envelopes.size());
  MidnightClock midnight(time.parts);
  for (double row = 0.0; reader.NextRow(values); ++row) {
    const double time_s = midnight.Add(inspection.has_time ? TimeOfRow(time.parts, values)
                                                           : row / inspection.time.rate_hz);
    for (std::size_t i = 0; i < envelopes.size(); ++i) {
      active[i] = envelopes[i].second.Step(time_s, values[envelopes[i].first]);
    }
    statistics.Add(time_s, active);
  }
  for (std::size_t i = 0; i < envelopes.size(); ++i) {
    InspectedColumn& column = inspection.columns[envelopes[i].first];
    column.statistics = statistics.Column(i);
    column.envelope_ms = kUsualEnvelope_ms;
    column.why = fmt::format("its envelope, mean absolute value over {:g} ms, lags by {:g} ms",
                             kUsualEnvelope_ms, 0.5 * kUsualEnvelope_ms);
  }
}

/// Quantities of the columns, and the joints of one family.
void SetJoints(const std::vector<ColumnFamily>& families, const JointChoice& choice,
               Inspection& inspection) {
  for (const ColumnFamily& family : families) {
    for (const std::size_t c : family.columns) {
      InspectedColumn& column = inspection.columns[c];
      column.quantity = family.quantity;
      column.why = family.quantity == Quantity::kSensor
                       ? "a sensor of another family than that of the joints"
                       : std::string(family.why);
      if (column.kind == CellKind::kTime || family.why.empty()) column.why = "another time";
    }
  }
  double widest = 0.0;  // range of a sensor
  for (const std::size_t c : choice.columns) {
    const ColumnStatistics& is = inspection.columns[c].statistics;
    widest = std::max(widest, is.high - is.low);
  }
  for (std::size_t i = 0; i < choice.columns.size(); ++i) {
    InspectedColumn& column = inspection.columns[choice.columns[i]];
    const ColumnJoint& joint = choice.joints[i];
    column.is_sensor = true;
    if (!choice.mappings.empty()) column.mappings = choice.mappings[i];
    column.is_dead = IsDead(column, widest, inspection.senders.has_value());
    column.channel = joint.channel;
    column.basis = joint.basis;
    column.why = joint.why.empty() ? "its joint is unknown" : joint.why;
  }
  inspection.unit = choice.columns.empty() ? RawUnit::kUnknown : choice.unit;
  inspection.unit_is_assumed = choice.unit_is_assumed;
  inspection.unit_why = choice.unit_why;
  inspection.unit_high = choice.high;
  inspection.profile = choice.profile;
  inspection.profiles_to_ask_for = choice.profiles_to_ask_for;
  if (inspection.unit == RawUnit::kCounts) inspection.bits = BitsFor(choice.high);
  inspection.question = choice.question;
  inspection.asks_joints = !choice.question.empty() && choice.asks_joints;
  for (const HealthFinding& finding : HealthOf(inspection)) {
    InspectedColumn& column = inspection.columns[finding.column];
    if (column.is_dead) column.why = finding.sentence;
  }
  inspection.remedy = choice.is_command_log    ? Remedy::kIdentify
                      : choice.columns.empty() ? Remedy::kInSentence
                                               : Remedy::kPresetOrMap;
}

/// True if a map or a profile says what the values are.
bool HasMappings(const Inspection& inspection) {
  return std::ranges::any_of(
      inspection.columns, [](const InspectedColumn& column) { return !column.mappings.empty(); });
}

/// One sign for all joints that bend mainly to the positive side: that of most of them. Angles of
/// a joint that are nearly all negative fall while it bends.
void GuessSign(Inspection& inspection) {
  if (!inspection.HasAngles() || HasMappings(inspection)) return;
  std::vector<std::size_t> flexions;
  std::size_t falling = 0, rising = 0;
  for (const std::size_t c : inspection.MappedColumns()) {
    const InspectedColumn& column = inspection.columns[c];
    const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
    if (joint.max_deg < -joint.min_deg + 20.0 || column.is_turning) continue;
    flexions.push_back(c);
    const double middle_deg = inspection.DegPerUnit() *
                              (column.statistics.usual_low + column.statistics.usual_high) / 2.0;
    const double far_deg = 0.05 * (joint.max_deg - joint.min_deg);
    falling += middle_deg < -far_deg ? 1 : 0;
    rising += middle_deg > far_deg ? 1 : 0;
  }
  inspection.sign_is_assumed = falling > 0;
  if (falling <= rising) return;
  for (const std::size_t c : flexions) inspection.columns[c].is_inverted = true;
}

/// Angles that jump by 360 from row to row go on without the jump, in the range of the joint.
void UnwrapTurns(Inspection& inspection) {
  if (inspection.unit != RawUnit::kDegrees || HasMappings(inspection)) return;
  constexpr double kTurn_deg = 360.0;
  for (const std::size_t c : inspection.MappedColumns()) {
    InspectedColumn& column = inspection.columns[c];
    if (column.statistics.turns == 0) continue;
    column.is_turning = true;
    std::vector<double>& values = inspection.picture_values[c];
    double turns = 0.0, low = kNaN, high = kNaN, before = kNaN;
    for (double& value : values) {
      if (value - before > kTurn_deg / 2.0) turns -= kTurn_deg;
      if (value - before < -kTurn_deg / 2.0) turns += kTurn_deg;
      before = value;
      value += turns;
      low = std::fmin(low, value);
      high = std::fmax(high, value);
    }
    const Channel& joint = KnownChannels()[ChannelIndex(column.channel)];
    const double middle = (joint.min_deg + joint.max_deg) / 2.0;
    column.added = kTurn_deg * std::round((middle - (low + high) / 2.0) / kTurn_deg);
    column.why += "; it jumps by 360: the jumps are undone";
    for (double& value : values) value += column.added;
  }
}

/// Marks joints that come near half a turn, beyond which no joint bends, and never go below 0; all
/// if most do.
void MarkAnglesFromStraight(Inspection& inspection) {
  constexpr double kNearStraight_deg = 140.0;
  constexpr double kMost_deg = 190.0;
  if (!inspection.HasAngles() || HasMappings(inspection)) return;
  const std::vector<std::size_t> joints = inspection.MappedColumns();
  const auto is_straight = [&](std::size_t c) {
    const ColumnStatistics& is = inspection.columns[c].statistics;
    const double high_deg = inspection.DegPerUnit() * is.usual_high;
    return is.usual_low >= 0.0 && high_deg > kNearStraight_deg && high_deg < kMost_deg;
  };
  const bool are_most = 2 * std::ranges::count_if(joints, is_straight) > std::ssize(joints);
  for (const std::size_t c : joints) {
    inspection.columns[c].is_from_straight = are_most || is_straight(c);
  }
}

/// Signs and offsets that the map offers for such angles.
void OfferAnglesFromStraight(Inspection& inspection) {
  for (InspectedColumn& column : inspection.columns) {
    if (!column.is_from_straight) continue;
    column.is_inverted = true;
    column.added = 180.0 / (inspection.unit == RawUnit::kDegrees ? 1.0 : kDegPerRad);
  }
}

/// Two senders by the clock and by all columns of numbers that may be sensors.
void FindSenders(const SenderWatch& watch, std::size_t clock, Inspection& inspection) {
  std::vector<std::pair<std::size_t, double>> sensors;
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    const InspectedColumn& column = inspection.columns[c];
    if (column.kind != CellKind::kNumber || column.is_time || c == clock) continue;
    sensors.emplace_back(c, column.statistics.usual_high - column.statistics.usual_low);
  }
  inspection.senders = watch.Find(clock, sensors);
}

void KeepPicture(const TableStatistics& statistics, Inspection& inspection) {
  inspection.picture_time_s = statistics.kept_times_s();
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    inspection.picture_values.push_back(inspection.columns[c].kind == CellKind::kNumber
                                            ? statistics.KeptValues(c)
                                            : std::vector<double>());
  }
  if (inspection.has_time) return;
  const double period_s = static_cast<double>(statistics.kept_every()) / inspection.time.rate_hz;
  for (std::size_t i = 0; i < inspection.picture_time_s.size(); ++i) {
    inspection.picture_time_s[i] = static_cast<double>(i) * period_s;
  }
}

/// Columns without names below lines that say they are signals of muscles or the brain. What is far
/// smaller than they are, as an accelerometer, is none.
void FindMusclesByNotes(const std::vector<std::string>& notes,
                        std::span<const ColumnEvidence> columns,
                        std::vector<ColumnFamily>& families) {
  constexpr double kFarSmaller = 0.02;
  const auto names_muscles = [](const std::string& note) {
    return HasWordOf(WordsOf(note), "emg semg exg eeg");
  };
  if (std::ranges::none_of(notes, names_muscles)) return;
  for (std::size_t f = 0, count = families.size(); f < count; ++f) {
    if (families[f].quantity != Quantity::kSensor || !families[f].facts.words.empty()) continue;
    const double least = kFarSmaller * families[f].facts.reach;
    const auto is_small = [&](std::size_t c) {
      const ColumnStatistics& is = columns[c].statistics;
      return std::max(std::abs(is.low), std::abs(is.high)) < least;
    };
    ColumnFamily small = families[f];
    std::erase_if(small.columns, [&](std::size_t c) { return !is_small(c); });
    small.quantity = Quantity::kUnknown;
    small.why = "far smaller than the signals of muscles beside it";
    std::erase_if(families[f].columns, is_small);
    families[f].quantity = Quantity::kMuscle;
    families[f].unit = RawUnit::kUnknown;
    families[f].why = "signals of muscles or the brain, by the lines above the table";
    if (!small.columns.empty()) families.push_back(std::move(small));
  }
}

/// Clocks beside the time, if it is used.
std::vector<std::size_t> OtherClocks(const TimeGuess& time, const Inspection& inspection) {
  return inspection.has_time ? ClocksBeside(time.parts, inspection.layout)
                             : std::vector<std::size_t>();
}

void FindJoints(const std::vector<RowGroups>& groups, const TimeGuess& time,
                const InspectionOptions& options, const std::optional<ColumnMap>& map,
                const std::string& angle_unit, const std::vector<Profile>& profiles,
                Inspection& inspection) {
  const std::vector<ColumnEvidence> evidence =
      EvidenceOf(inspection, OtherClocks(time, inspection));
  try {
    std::vector<ColumnFamily> families =
        options.columns ? GivenFamily(evidence, options.columns->first, options.columns->second)
                        : FindFamilies(evidence);
    FindMusclesByNotes(inspection.layout.notes, evidence, families);
    SetJoints(families,
              ChooseJoints({.columns = evidence,
                            .families = families,
                            .angle_unit = angle_unit,
                            .format = std::string(NameInProfiles(inspection.format)),
                            .duration_s = inspection.time.duration_s,
                            .is_translated = !InEnglish(inspection.layout.names).empty()},
                           options.joints, map, profiles),
              inspection);
  } catch (const UserError& error) {
    if (!error.place().empty()) throw;
    throw UserError({.place = inspection.file, .problem = error.what()});
  }
  UnwrapTurns(inspection);
  GuessSign(inspection);
  MarkAnglesFromStraight(inspection);
  // Rows of two senders are to be recorded again, whatever their joints are, and rows of one value
  // to be written in columns.
  if (inspection.question.empty() || inspection.senders || IsLongTable(inspection, groups)) {
    const StopQuestion stop = FindStopQuestion(inspection, groups, map.has_value());
    inspection.question = stop.sentence;
    inspection.remedy = stop.remedy;
    inspection.asks_joints = false;
    if (inspection.remedy == Remedy::kPresetOrMap) OfferAnglesFromStraight(inspection);
  }
}

}  // namespace

std::vector<std::size_t> Inspection::MappedColumns() const {
  std::vector<std::size_t> mapped;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!columns[c].channel.empty() && !columns[c].is_dead) mapped.push_back(c);
  }
  return mapped;
}

bool Inspection::HasAssumedJoint() const {
  return std::ranges::any_of(
      MappedColumns(), [this](std::size_t c) { return columns[c].basis == JointBasis::kAssumed; });
}

std::vector<std::size_t> Inspection::Sensors() const {
  std::vector<std::size_t> sensors;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c].is_sensor) sensors.push_back(c);
  }
  return sensors;
}

bool Inspection::HasAngles() const {
  return unit == RawUnit::kDegrees || unit == RawUnit::kRadians || unit == RawUnit::kMilliradians;
}

double Inspection::DegPerUnit() const {
  if (unit == RawUnit::kMilliradians) return kRadPerMilliradian * kDegPerRad;
  return unit == RawUnit::kRadians ? kDegPerRad : 1.0;
}

double LowDegOf(const Channel& joint) {
  return joint.name.ends_with("_mcp") ? std::max(joint.min_deg, 0.0) : joint.min_deg;
}

Inspection Inspect(const std::filesystem::path& file, const InspectionOptions& options) {
  Inspection inspection;
  inspection.file = file.string();
  inspection.array = options.array;
  OpenedTable opened = OpenTable(file, options.array);
  inspection.format = opened.format;
  inspection.file_bytes = opened.file_bytes;
  inspection.arrays = std::move(opened.arrays);
  inspection.topics = std::move(opened.topics);
  if (!opened.table) {
    inspection.question = QuestionOf(inspection.topics);
    return inspection;
  }
  if (const auto* table = std::get_if<std::shared_ptr<const Table>>(&*opened.table)) {
    inspection.is_cut = (*table)->is_cut;
    inspection.is_tracked = (*table)->is_tracked;
  }
  const auto is_whole = std::make_shared<bool>(true);
  auto [layout, reader] =
      FindTable(file.string(), BeginningOf(*opened.table, is_whole), ProblemHandling::kRepair,
                [&inspection](RecordingProblem problem, std::size_t) {
                  ++inspection.problems[std::string(NameOf(problem))];
                });
  inspection.layout = std::move(layout);
  inspection.columns.resize(inspection.layout.columns);
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    inspection.columns[c].name = inspection.layout.names[c];
    inspection.columns[c].kind = KindOf(inspection.layout, c);
  }
  const std::optional<ColumnMap> map = MapOf(inspection, options.map);
  inspection.hand = map ? map->hand : HandOf(inspection, options.joints.hand);
  KeepRowsOfHand(reader, inspection);
  const std::vector<Profile> profiles =
      map ? std::vector<Profile>() : AllProfiles(std::filesystem::absolute(file));
  const TimeGuess time = map ? TimeOfMap(map->time) : TimeOf(inspection.layout, profiles, options);
  std::vector<RowGroups> groups = GroupsToWatch(inspection);
  SenderWatch senders(inspection.columns.size());
  MidnightClock midnight(time.parts);
  std::size_t doubled = 0;
  const TableStatistics statistics = ReadTable(time, inspection.columns, inspection.hand, reader,
                                               midnight, groups, senders, doubled);
  if (doubled > 0) {
    inspection.remarks.push_back(
        fmt::format("{} rows repeat the one before and its time: they do not count", doubled));
  }
  inspection.is_whole = *is_whole;
  if (midnight.midnights() > 0) inspection.remarks.emplace_back(kPastMidnight);
  std::error_code ignored;
  if (std::filesystem::exists(UnfinishedMark(file), ignored)) {
    inspection.remarks.emplace_back(
        "its session runs, or was killed: at most the last second of it is missing");
  }
  for (const std::string& remark : reader.remarks()) inspection.remarks.push_back(OneLine(remark));
  for (const RowGroups& group : groups) {
    const std::string& name = inspection.columns[group.column()].name;
    if (!NamesParts(name) || group.count() < 2) continue;
    inspection.remarks.push_back(fmt::format("column {} '{}' has {} values: parts of one recording",
                                             group.column() + 1, OneLine(name, 20), group.count()));
  }
  inspection.rows = statistics.rows();
  if (inspection.hand && inspection.rows == 0) {
    throw UserError({.place = inspection.file,
                     .problem = fmt::format("no row of the {} hand", inspection.hand->side)});
  }
  for (std::size_t c = 0; c < inspection.columns.size(); ++c) {
    if (inspection.columns[c].kind == CellKind::kNumber) {
      inspection.columns[c].statistics = statistics.Column(c);
    }
  }
  double noted_rate_hz = RateInNotes(inspection.layout.notes);
  if (noted_rate_hz == 0.0) noted_rate_hz = RateInColumns(inspection.columns);
  SetTime(time, statistics.Time(), options.rate_hz > 0.0 ? options.rate_hz : noted_rate_hz,
          inspection);
  KeepPicture(statistics, inspection);
  FindSenders(senders, ClockOf(time, inspection.columns), inspection);
  FindJoints(groups, time, options, map, reader.angle_unit(), profiles, inspection);
  ComputeEnvelopeStatistics(file, std::move(*opened.table), time, inspection);
  return inspection;
}

}  // namespace gauntlet::sim
