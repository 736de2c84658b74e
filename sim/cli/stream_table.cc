#include "sim/cli/stream_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "controller/number.h"
#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/column_scale.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/recording_reader.h"
#include "sim/recordings/time_columns.h"
#include "sim/recordings/time_text.h"

namespace gauntlet::sim {
namespace {

bool IsNumber(std::string_view text) {
  return controller::ParseNumberOfProgram(Trimmed(text)).has_value();
}

std::vector<std::string> NamesOf(const std::vector<std::string_view>& cells) {
  std::vector<std::string> names;
  for (const std::string_view cell : cells) names.emplace_back(Unquoted(cell));
  return names;
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

StreamTable::StreamTable(std::string_view first_line, const std::string& map,
                         const std::vector<std::string>& asked) {
  if (map.empty()) {
    TakeColumns(first_line, asked);
  } else {
    TakeMap(first_line, map, asked);
  }
}

void StreamTable::TakeTime(std::size_t column, double scale_s) {
  if (time_.empty()) time_.push_back({.column = column, .scale_s = scale_s});
}

void StreamTable::TakeChannel(std::size_t column) {
  output_[column].channel = channels_.size();
  filtered_.push_back(channels_.size());
  channels_.push_back(StreamChannel{Part{.column = column}});
}

/// The first column of time is the clock; `k`, the number of the sample, is no channel in the
/// first column only.
void StreamTable::TakeColumns(std::string_view line, const std::vector<std::string>& asked) {
  // A blank may be part of a name: `sensor 3` is one column.
  separator_ = SeparatorOf(line) == ' ' ? ',' : SeparatorOf(line);
  const std::vector<std::string_view> cells = SplitCells(line, separator_);
  const std::vector<std::string> names = NamesOf(cells);
  columns_ = names.size();
  const std::vector<bool> is_asked = AskedColumns(names, asked);
  for (std::size_t column = 0; column < columns_; ++column) {
    const std::string& name = names[column];
    output_.push_back({.column = column});
    if (!asked.empty() && is_asked[column]) {
      TakeChannel(column);
      continue;
    }
    if (asked.empty() && name.empty()) Fail(1, column, "has no name");
    if (const auto scale_s = TimeScaleS(name)) {
      TakeTime(column, *scale_s);
    } else if (asked.empty() && (!IsSampleNumber(name) || column > 0)) {
      TakeChannel(column);
      if (!MayBeTime(name)) continue;
      Say("gauntlet: warning: standard input:1:{}: {} is filtered as a channel; if it is the time, "
          "call it time_s or time_ms\n",
          column + 1, Shown(name));
    }
  }
  if (std::ranges::all_of(cells, IsNumber)) {  // data frames do so; or the header was forgotten
    Say("gauntlet: warning: standard input:1: numbers only, taken as the header\n");
  }
  if (channels_.empty()) Fail(1, "has no channel besides the time");
  header_ = fmt::format("{}\n", Trimmed(line));
}

void StreamTable::TakeMap(std::string_view line, const std::string& map,
                          const std::vector<std::string>& asked) {
  separator_ = SeparatorOf(line);
  std::vector<std::string_view> cells = SplitCells(line, separator_);
  const bool has_header = !std::ranges::all_of(
      cells, [this](std::string_view cell) { return IsValue(cell, separator_); });
  if (has_header && separator_ == ' ') {  // as without a map
    separator_ = ',';
    cells = SplitCells(line, separator_);
  }
  columns_ = cells.size();
  const std::vector<std::string> no_header;
  const ColumnMap columns =
      ReadColumnMap(map, RecordingColumns{.name = "standard input",
                                          .header = has_header ? NamesOf(cells) : no_header,
                                          .count = columns_});
  time_ = columns.time;
  const std::vector<std::string> names = TakeChannels(columns);
  KeepAsked(names, asked);
  if (!has_header) return;
  for (const OutputCell& cell : output_) {
    if (&cell != output_.data()) header_.push_back(separator_);
    header_ +=
        cell.channel ? names[*cell.channel] + "_deg" : std::string(Trimmed(cells[cell.column]));
  }
  header_.push_back('\n');
}

std::vector<std::string> StreamTable::TakeChannels(const ColumnMap& map) {
  const RecordingFormat nominal;
  std::vector<StreamChannel> parts(KnownChannels().size());
  std::vector<bool> passes(columns_, true);
  for (const ColumnMapping& mapping : map.channels) {
    const ColumnScale scale = ScaleOf(mapping, nominal.low_counts, nominal.high_counts);
    parts[mapping.channel].push_back({.column = mapping.column,
                                      .factor = scale.factor * kDegPerRad,
                                      .offset = scale.offset_rad * kDegPerRad});
    passes[mapping.column] = false;
  }
  std::vector<std::string> names;
  for (std::size_t column = 0; column < columns_; ++column) {
    if (passes[column]) output_.push_back({.column = column});
    for (std::size_t i = 0; !passes[column] && i < parts.size(); ++i) {
      if (parts[i].empty()) continue;
      if (std::ranges::min(parts[i], {}, &Part::column).column != column) continue;
      output_.push_back({.column = column, .channel = channels_.size()});
      names.emplace_back(KnownChannels()[i].name);
      channels_.push_back(parts[i]);
    }
  }
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
  if (fields_.size() != columns_) {
    Fail(row, fmt::format("has {} fields, must have {}", fields_.size(), columns_));
  }
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

double StreamTable::ValueOf(const StreamChannel& channel) const {
  double sum = -0.0;
  for (const Part& part : channel) {
    const std::string_view field = fields_[part.column];
    const std::optional<double> value = NumberOrMissing(Plain(field));
    if (!value) {
      Fail(row_, part.column, fmt::format("is \"{}\", must be a number", Shown(field)));
    }
    sum += part.factor * *value + part.offset;
  }
  return sum;
}

/// With the fewest digits that read back to the same bits, and a decimal comma as it came.
void StreamTable::WriteNumber(const StreamChannel& channel, double value) {
  const std::ptrdiff_t begin = std::ssize(text_);
  fmt::format_to(std::back_inserter(text_), "{}", value);
  const bool has_comma =
      separator_ != ',' && std::ranges::any_of(channel, [this](const Part& part) {
        return fields_[part.column].find(',') != std::string_view::npos;
      });
  if (has_comma) std::replace(text_.begin() + begin, text_.end(), '.', ',');
}

std::string_view StreamTable::Written(std::span<const double> values) {
  text_.clear();
  std::size_t next = 0;  // of the channels that are filtered, which come in their order
  for (const OutputCell& cell : output_) {
    if (&cell != output_.data()) text_.push_back(separator_);
    if (!cell.channel) {
      text_ += Trimmed(fields_[cell.column]);
    } else if (next < filtered_.size() && filtered_[next] == *cell.channel) {
      WriteNumber(channels_[*cell.channel], values[next++]);
    } else {
      WriteNumber(channels_[*cell.channel], ValueOf(channels_[*cell.channel]));
    }
  }
  text_.push_back('\n');
  return text_;
}

void StreamTable::Fail(std::size_t row, const std::string& problem) {
  throw UserError({.place = fmt::format("standard input:{}", row), .problem = problem});
}

void StreamTable::Fail(std::size_t row, std::size_t column, const std::string& problem) {
  throw UserError(
      {.place = fmt::format("standard input:{}:{}", row, column + 1), .problem = problem});
}

}  // namespace gauntlet::sim
