#include "sim/cli/stream_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/cli/row_clock.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/recording_reader.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr const char* kPlace = "standard input";

std::size_t ValuesIn(const std::vector<std::string_view>& cells, char separator) {
  return std::ranges::count_if(cells,
                               [=](std::string_view cell) { return IsValue(cell, separator); });
}

enum class Likeness { kNone, kPossible, kRow };

/// Likeness of a line to a row. A row has values and, unless it may stand alone, as many cells as
/// the line above it, or one more, without a name. A note (`Firmware: 1.2`) may look like a row
/// with a text: then only a line below it of the same shape makes it one.
Likeness LikenessToRow(std::string_view line, const std::string& above, bool may_be_alone) {
  const char separator = SeparatorOf(line);
  const std::vector<std::string_view> cells = SplitCells(line, separator);
  const std::size_t values = ValuesIn(cells, separator);
  const bool is_all_values = values == cells.size();
  if (above.empty()) return may_be_alone && is_all_values ? Likeness::kRow : Likeness::kNone;
  const std::size_t cells_above = SplitCells(above, separator).size();
  if (is_all_values && cells.size() > 1 && cells_above + 1 == cells.size()) return Likeness::kRow;
  if (values == 0 || cells_above != cells.size()) return Likeness::kNone;
  return 2 * values > cells.size() ? Likeness::kRow : Likeness::kPossible;
}

/// True if only rows tell which column is the time, or which are clocks beside a clock.
bool IsTimeUnclear(const TableLayout& layout) {
  bool may_be = false;
  for (std::size_t c = 0; c < layout.columns; ++c) {
    const std::string& name = layout.names[c];
    if (TimeScaleS(name) && KindOf(layout, c) != CellKind::kTime) return false;
    may_be = may_be || (MayBeTime(name) && !IsSampleNumber(name)) ||
             KindOf(layout, c) == CellKind::kTime;
  }
  return may_be;
}

/// The first line with cells names the columns. A blank may be part of a name: `sensor 3`.
TableLayout LayoutWithoutRows(const std::vector<TextLine>& lines) {
  TableLayout layout;
  const auto header =
      std::ranges::find_if(lines, [](const TextLine& line) { return IsRow(line.text); });
  if (header == lines.end()) throw UserError({.place = kPlace, .problem = "is empty"});
  layout.separator = SeparatorOf(header->text) == ' ' ? ',' : SeparatorOf(header->text);
  layout.has_header = true;
  layout.skipped_lines = static_cast<int>(header - lines.begin());
  for (const std::string_view cell : SplitCells(header->text, layout.separator)) {
    layout.names.emplace_back(Unquoted(cell));
  }
  layout.columns = layout.names.size();
  return layout;
}

/// The shape that FindTable() finds, if the last line has it: few lines may mislead it.
TableLayout LayoutOf(const std::vector<TextLine>& lines) {
  std::string text;
  for (const TextLine& line : lines) text += std::string(Trimmed(line.text)) + "\n";
  try {
    TableLayout layout = FindTable(kPlace, TextSource(text), ProblemHandling::kRepair).layout;
    const std::size_t cells = SplitCells(lines.back().text, layout.separator).size();
    if (cells == layout.columns || cells == layout.columns + 1) return layout;
  } catch (const UserError&) {  // no table in it
  }
  return LayoutWithoutRows(lines);
}

/// Columns that --columns names, by their names or by their numbers from 1.
std::vector<bool> AskedColumns(const std::vector<std::string>& names,
                               const std::vector<std::string>& asked) {
  std::vector<bool> is_asked(names.size(), false);
  for (const std::string& one : asked) {
    const auto found = std::ranges::find(names, one);
    std::size_t column = static_cast<std::size_t>(found - names.begin());
    if (found == names.end()) {
      const auto number = controller::ParseWholeNumber(one, 1, std::ssize(names));
      if (!number) {
        throw UserError({.place = "--columns",
                         .problem = fmt::format("standard input has no column {}{}", Shown(one),
                                                Suggestion(one, names))});
      }
      column = *number - 1;
    }
    is_asked[column] = true;
  }
  return is_asked;
}

}  // namespace

bool IsRow(std::string_view line) { return !Trimmed(line).empty() && Trimmed(line).front() != '#'; }

StreamHead ReadHead(TextLines& lines, bool has_map) {
  constexpr std::size_t kMostLines = 64;
  std::vector<TextLine> read;
  std::string above;
  std::string_view line;
  Likeness likeness = Likeness::kNone;  // of the last line
  bool ends = false;
  while (!ends && read.size() < kMostLines && lines.Next(line)) {
    read.push_back({std::string(line), lines.number()});
    if (!IsRow(line)) continue;
    const Likeness before = std::exchange(likeness, LikenessToRow(line, above, has_map));
    ends = likeness == Likeness::kRow || (likeness != Likeness::kNone && before == likeness);
    above = line;
  }
  ends = ends || likeness == Likeness::kPossible;  // the stream has ended
  StreamHead head;
  head.layout = ends ? LayoutOf(read) : LayoutWithoutRows(read);
  TableLayout& layout = head.layout;
  if (!has_map && ends && IsTimeUnclear(layout)) {
    const std::size_t most = read.size() + RowClock::kRowsForRate;
    while (read.size() < most && lines.Next(line)) {
      read.push_back({std::string(line), lines.number()});
    }
    layout = LayoutOf(read);
  }
  const bool has_names =
      std::ranges::any_of(layout.names, [](const std::string& name) { return !name.empty(); });
  bool is_header = layout.has_header || (!has_names && !has_map);
  for (std::size_t i = static_cast<std::size_t>(layout.skipped_lines); i < read.size(); ++i) {
    if (!IsRow(read[i].text)) continue;
    if (!is_header) {
      head.rows.push_back(read[i]);
      continue;
    }
    is_header = false;
    for (const std::string_view cell : SplitCells(read[i].text, layout.separator)) {
      head.names.emplace_back(Trimmed(cell));
    }
  }
  if (!has_names || head.names.size() == layout.columns) return head;
  head.lacks_first_name = head.names.size() + 1 == layout.columns && layout.names.front().empty();
  head.names.clear();  // in a comment, above their units, or one short
  for (const std::string& name : layout.names) {
    const bool is_plain = name.find_first_of({layout.separator, '"', ' '}) == std::string::npos;
    head.names.push_back(is_plain ? name : '"' + name + '"');
  }
  return head;
}

StreamTable::StreamTable(const StreamHead& head, const StreamColumns& given) {
  separator_ = head.layout.separator;
  columns_ = head.layout.columns;
  values_.resize(columns_);
  if (given.map.empty()) {
    ChooseColumns(head, given);
  } else {
    has_map_ = true;
    ApplyMap(head, given.map, given.asked);
  }
}

void StreamTable::AddChannel(std::size_t column, std::vector<ChannelValues::Parts>& channels) {
  output_[column].channel = channels.size();
  filtered_.push_back(channels.size());
  channels.push_back({{.column = column}});
}

/// `k`, the number of the sample, is no channel in the first column only.
void StreamTable::ChooseColumns(const StreamHead& head, const StreamColumns& given) {
  const std::vector<std::string>& asked = given.asked;
  hand_is_chosen_ = !given.hand.empty();
  if (const auto column = HandColumn(head.layout)) hand_ = {*column, given.hand};
  if (hand_is_chosen_ && !hand_) {
    throw UserError({.place = "--hand " + given.hand,
                     .problem = "standard input has no column that names the hand of each row"});
  }
  std::vector<std::string> names;
  for (const std::string& name : head.names) names.emplace_back(Unquoted(name));
  names.resize(columns_);
  const std::vector<bool> is_asked = AskedColumns(names, asked);
  time_ = TimeByName(kPlace, head.layout, given.time_unit);
  std::erase_if(time_, [&](const TimeMapping& time) { return is_asked[time.column]; });
  const std::vector<std::size_t> aside = ColumnsAside(time_, head.layout);
  std::vector<ChannelValues::Parts> channels;
  for (std::size_t column = 0; column < columns_; ++column) {
    const std::string& name = names[column];
    output_.push_back({.column = column});
    if (!asked.empty() && is_asked[column]) {
      AddChannel(column, channels);
      continue;
    }
    const bool is_last_of_separators = name.empty() && column > 0 && column + 1 == columns_;
    if (asked.empty() && name.empty()) {
      if (!is_last_of_separators) {
        Say("gauntlet: standard input: column {} has no name and passes through\n", column + 1);
      }
      continue;
    }
    const bool is_time = std::ranges::find(time_, column, &TimeMapping::column) != time_.end();
    if (TimeScaleS(name) || (IsSampleNumber(name) && column == 0)) continue;
    if (hand_ && hand_->column == column) continue;
    if (is_time) {
      Say("gauntlet: standard input: {} is the time\n", Shown(name));
    } else if (asked.empty() && std::ranges::find(aside, column) != aside.end()) {
      Say("gauntlet: standard input: {} is no signal and passes through; --columns filters it\n",
          Shown(name));
    } else if (asked.empty()) {
      AddChannel(column, channels);
      if (!MayBeTime(name)) continue;
      Say("gauntlet: warning: standard input:1:{}: {} is filtered as a channel; if it is the time, "
          "call it time_s or time_ms\n",
          column + 1, Shown(name));
    }
  }
  if (ValuesIn({names.begin(), names.end()}, separator_) == columns_) {
    // Data frames do so; or the header was forgotten.
    Say("gauntlet: warning: standard input:1: numbers only, taken as the header\n");
  }
  if (channels.empty()) Fail(1, "has no channel besides the time");
  channels_ = ChannelValues(std::move(channels));
  const auto written = std::span(head.names).subspan(head.lacks_first_name ? 1 : 0);
  header_ = fmt::format("{}\n", fmt::join(written, std::string(1, separator_)));
}

void StreamTable::ApplyMap(const StreamHead& head, const std::string& map,
                           const std::vector<std::string>& asked) {
  const ColumnMap columns = ReadColumnMap(
      map,
      RecordingColumns{
          .name = kPlace, .header = head.layout.names, .count = columns_, .may_choose_rows = true});
  time_ = columns.time;
  hand_ = columns.hand;
  const auto hand = HandColumn(head.layout);
  if (!hand_ && hand) hand_ = {*hand, ""};
  hand_is_chosen_ = columns.hand.has_value();
  const std::vector<std::string> names = AddMappedChannels(columns);
  KeepAsked(names, asked);
  if (head.names.empty()) return;
  for (const OutputCell& cell : output_) {
    if (&cell != output_.data()) header_.push_back(separator_);
    header_ += cell.channel ? names[*cell.channel] + "_deg" : head.names[cell.column];
  }
  header_.push_back('\n');
}

std::vector<std::string> StreamTable::AddMappedChannels(const ColumnMap& map) {
  std::vector<ChannelValues::Parts> parts(KnownChannels().size());
  std::vector<bool> passes(columns_, true);
  for (const ColumnMapping& mapping : map.channels) {
    ChannelValues::Part& part =
        parts[mapping.channel].emplace_back(PartOf(mapping, NominalCounts{}));
    part.factor *= kDegPerRad;
    part.offset *= kDegPerRad;
    passes[mapping.column] = false;
  }
  remarks_ = EnvelopesOf(map);
  std::vector<std::string> names;
  std::vector<ChannelValues::Parts> channels;
  for (std::size_t column = 0; column < columns_; ++column) {
    if (passes[column]) output_.push_back({.column = column});
    for (std::size_t i = 0; !passes[column] && i < parts.size(); ++i) {
      if (parts[i].empty()) continue;
      if (std::ranges::min(parts[i], {}, &ChannelValues::Part::column).column != column) continue;
      output_.push_back({.column = column, .channel = channels.size()});
      names.emplace_back(KnownChannels()[i].name);
      channels.push_back(parts[i]);
    }
  }
  channels_ = ChannelValues(std::move(channels));
  return names;
}

void StreamTable::KeepAsked(const std::vector<std::string>& names,
                            const std::vector<std::string>& asked) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (asked.empty() || std::ranges::find(asked, names[i]) != asked.end()) filtered_.push_back(i);
  }
  for (const std::string& one : asked) {
    if (std::ranges::find(names, one) != names.end()) continue;
    throw UserError({.place = "--columns",
                     .problem = fmt::format("the map names no channel {}{}", Shown(one),
                                            Suggestion(one, names))});
  }
}

void StreamTable::Read(std::string_view line, std::size_t row) {
  row_ = row;
  fields_ = SplitCells(line, separator_);
  const bool has_end = fields_.size() == columns_ + 1 && Trimmed(fields_.back()).empty();
  if (has_end) fields_.pop_back();
  if (fields_.size() != columns_) {
    Fail(row, fmt::format("has {} fields, must have {}", fields_.size(), columns_));
  }
}

/// Rows of both hands are two recordings: without a choice the first row decides, and the first of
/// the other hand is a mistake.
bool StreamTable::IsOfOtherHand() {
  if (!hand_) return false;
  const std::string side = HandInText(Unquoted(fields_[hand_->column]));
  if (!hand_is_chosen_ && hand_->side.empty()) hand_->side = side;
  if (side == hand_->side) return false;
  if (!hand_is_chosen_ && !side.empty()) {
    Fail(row_, hand_->column,
         fmt::format("is of the {} hand, rows before of the {}; --hand left or --hand right takes "
                     "one, or a map with the row {},{}",
                     side, hand_->side, hand_->column + 1, side));
  }
  return hand_is_chosen_;
}

/// The text of a number with a decimal point.
std::string StreamTable::Plain(std::string_view field) const {
  std::string text(Unquoted(field));
  if (separator_ != ',') std::ranges::replace(text, ',', '.');
  return text;
}

double StreamTable::Time() const {
  double sum = 0.0;
  for (const TimeMapping& time : time_) {
    const std::string_view field = fields_[time.column];
    const std::optional<double> value =
        time.is_text ? SecondsOfText(Unquoted(field)) : NumberOrMissing(Plain(field));
    sum += value.value_or(kNaN) * (time.scale_s / time_scale_s());
  }
  return sum;
}

double StreamTable::ValueOf(std::size_t channel, double time_s) {
  for (const ChannelValues::Part& part : channels_.parts(channel)) {
    const std::string_view field = fields_[part.column];
    const std::optional<double> value = NumberOrMissing(Plain(field));
    if (!value) {
      Fail(row_, part.column, fmt::format("is \"{}\", must be a number", Shown(field)));
    }
    values_[part.column] = *value;
  }
  return channels_.Next(channel, time_s, values_);
}

/// With the fewest digits that read back to the same bits, and a decimal comma as it came.
void StreamTable::WriteNumber(std::size_t channel, double value) {
  const std::ptrdiff_t begin = std::ssize(text_);
  fmt::format_to(std::back_inserter(text_), "{}", value);
  const bool has_comma =
      separator_ != ',' &&
      std::ranges::any_of(channels_.parts(channel), [this](const ChannelValues::Part& part) {
        return fields_[part.column].find(',') != std::string_view::npos;
      });
  if (has_comma) std::replace(text_.begin() + begin, text_.end(), '.', ',');
}

std::string_view StreamTable::Written(std::span<const double> values, double time_s) {
  text_.clear();
  std::size_t next = 0;  // of the channels that are filtered, which come in their order
  for (const OutputCell& cell : output_) {
    if (&cell != output_.data()) text_.push_back(separator_);
    if (!cell.channel) {
      text_ += Trimmed(fields_[cell.column]);
    } else if (next < filtered_.size() && filtered_[next] == *cell.channel) {
      WriteNumber(*cell.channel, values[next++]);
    } else {
      WriteNumber(*cell.channel, ValueOf(*cell.channel, time_s));
    }
  }
  text_.push_back('\n');
  return text_;
}

void StreamTable::Fail(std::size_t row, const std::string& problem) {
  throw UserError({.place = fmt::format("{}:{}", kPlace, row), .problem = problem});
}

void StreamTable::Fail(std::size_t row, std::size_t column, const std::string& problem) {
  throw UserError(
      {.place = fmt::format("standard input:{}:{}", row, column + 1), .problem = problem});
}

}  // namespace gauntlet::sim
