#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/row_clock.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/csv_reader.h"
#include "sim/recordings/time_columns.h"
#include "sim/settings/yaml_reader.h"

namespace gauntlet::sim {
namespace {

struct FilterOptions {
  std::string kind;
  std::vector<std::string> settings;
  std::vector<std::string> columns;  // to filter; empty: all but the time
};

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// The filter of the command line, and the rate that `rate_hz` gives beside the filter's own keys.
struct StreamFilter {
  controller::FilterConfig config;
  double rate_hz = kUnknown;

  void Visit(controller::SettingsVisitor& visitor) {
    config.Visit(visitor);
    visitor.Number({.key = "rate_hz", .help = "sampling rate", .min = 0, .open_range = true},
                   rate_hz);
  }
};

/// What a filter makes of a few samples at some rate, or why there is none.
struct Outcome {
  std::vector<double> values;
  std::string refusal;
  bool operator==(const Outcome&) const = default;
};

Outcome OutcomeAt(double rate_hz, const controller::FilterConfig& config, int channel_count) {
  constexpr int kSamples = 50;
  Outcome outcome;
  try {
    const auto filter = controller::MakeFilter(config, channel_count, rate_hz);
    std::vector<double> values(static_cast<std::size_t>(channel_count));
    for (int k = 0; k < kSamples; ++k) {
      std::ranges::fill(values, k % 10 < 5 ? 0.0 : k);
      filter->Step(values, values);
      outcome.values.push_back(values.front());
    }
  } catch (const controller::SettingError& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}

/// Some filters count samples, as a median does; others have cutoffs in Hz.
bool DependsOnRate(const controller::FilterConfig& config, int channel_count) {
  return OutcomeAt(10.0, config, channel_count) != OutcomeAt(10e3, config, channel_count);
}

/// `r=21.18,12.52` is meant as a list: one value for each channel.
std::string WithList(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || text.find(',') == std::string::npos ||
      text.find('[') != std::string::npos) {
    return text;
  }
  return fmt::format("{}=[{}]", text.substr(0, equals), text.substr(equals + 1));
}

StreamFilter ReadFilter(const FilterOptions& options) {
  std::vector<std::string> kinds;
  for (const controller::FilterKind& kind : controller::FilterKinds()) {
    kinds.emplace_back(kind.name);
  }
  if (std::find(kinds.begin(), kinds.end(), options.kind) == kinds.end()) {
    throw UserError({.place = "filter " + options.kind,
                     .problem = "unknown kind" + Suggestion(options.kind, kinds)});
  }
  for (const std::string& text : options.settings) {
    if (text.starts_with("kind=")) {
      throw UserError({.place = "--set " + text,
                       .problem = "the kind is an argument: gauntlet filter " + text.substr(5)});
    }
    if (text.ends_with(','))
      throw UserError({.place = "--set " + text, .problem = "ends with a comma"});
  }
  YAML::Node root(YAML::NodeType::Map);
  root["kind"] = options.kind;
  YamlSource source{.file = "command line", .overrides = {}};
  for (const std::string& text : options.settings) ApplyOverride(root, WithList(text), source);
  YamlReader reader(root, "", source);
  StreamFilter filter;
  filter.Visit(reader);
  reader.RejectUnknownKeys();
  return filter;
}

/// A line-by-line filter: reads one row, writes one row, flushes. The first rows of a stream wait
/// until they have told the rate, if the filter needs it and nobody gave it.
class FilterStream {
 public:
  FilterStream(const StreamFilter& settings, const std::vector<std::string>& columns)
      : settings_(settings), asked_(columns) {}

  void ReadHeader(std::string_view line) {
    // A blank may be part of a name: `sensor 3` is one column.
    separator_ = SeparatorOf(line) == ' ' ? ',' : SeparatorOf(line);
    const std::vector<std::string_view> names = SplitCells(line, separator_);
    columns_ = names.size();
    FindAsked(names);
    for (std::size_t column = 0; column < columns_; ++column) AddColumn(names[column], column);
    if (std::ranges::all_of(names, IsNumber)) {  // data frames do so; or the header was forgotten
      Say("gauntlet: warning: standard input:1: numbers only, taken as the header\n");
    }
    if (channels_.empty()) Fail(1, "has no channel besides the time");
    StartIfRateIsKnown();
    Print("{}\n", Trimmed(line));
    CheckOutput();
  }

  void ReadRow(std::string_view line, std::size_t row) {
    const std::vector<std::string_view> fields = SplitCells(line, separator_);
    if (fields.size() != columns_) {
      Fail(row, fmt::format("has {} fields, must have {}", fields.size(), columns_));
    }
    const bool has_time = clock_ && clock_->Add(Plain(fields[time_column_]));
    if (filter_ != nullptr) {
      FilterRow(fields, row);
      return;
    }
    if (!has_time) {
      Fail(row, time_column_,
           fmt::format("is \"{}\", must be a time above that of the row before, from which the "
                       "rate follows; --set rate_hz=HZ gives it otherwise",
                       Shown(fields[time_column_])));
    }
    waiting_.push_back({std::string(line), row});
    if (clock_->rows() == RowClock::kRowsForRate) StartAtRateOfClock();
  }

  /// At the end of the stream.
  void Finish() {
    if (filter_ == nullptr && !waiting_.empty()) StartAtRateOfClock();
    constexpr double kNoticeable = 0.05;
    const double measured_hz = clock_ ? clock_->RateHz() : kUnknown;
    if (needs_rate_ && std::abs(measured_hz / rate_hz_ - 1.0) > kNoticeable) {
      Say("gauntlet: warning: standard input: its times say {:.5g} Hz, the filter was made for "
          "{:.5g} Hz\n",
          measured_hz, rate_hz_);
    }
    if (missing_ > 0) {
      Say("gauntlet: {} missing values held at the last good one\n", missing_);
    }
  }

 private:
  /// The first column of time is the clock; `k`, the number of the sample, is no channel in the
  /// first column only.
  void AddColumn(std::string_view cell, std::size_t column) {
    const std::string_view name = Unquoted(cell);
    if (std::ranges::find(is_asked_, true) != is_asked_.end()) {
      if (is_asked_[column]) {
        channels_.push_back(column);
      } else if (const auto scale_s = TimeScaleS(name); scale_s && !clock_) {
        clock_.emplace(*scale_s);
        time_column_ = column;
      }
      return;
    }
    if (name.empty()) Fail(1, column, "has no name");
    if (const auto scale_s = TimeScaleS(name)) {
      if (!clock_) {
        clock_.emplace(*scale_s);
        time_column_ = column;
      }
    } else if (!IsSampleNumber(name) || column > 0) {
      channels_.push_back(column);
      if (!MayBeTime(name)) return;
      Say("gauntlet: warning: standard input:1:{}: {} is filtered as a channel; if it is the time, "
          "call it time_s or time_ms\n",
          column + 1, Shown(name));
    }
  }

  /// Columns that --columns names, by their names or by their numbers from 1.
  void FindAsked(const std::vector<std::string_view>& names) {
    is_asked_.assign(columns_, false);
    for (const std::string& asked : asked_) {
      const auto found = std::ranges::find(names, std::string_view(asked), Unquoted);
      std::size_t column = static_cast<std::size_t>(found - names.begin());
      if (found == names.end()) {
        std::from_chars(asked.data(), asked.data() + asked.size(), column);
        if (column < 1 || column > columns_ || asked != std::to_string(column)) {
          std::vector<std::string> known;
          for (const std::string_view name : names) known.emplace_back(Unquoted(name));
          throw UserError({.place = "--columns",
                           .problem = fmt::format("standard input has no column {}{}", Shown(asked),
                                                  Suggestion(asked, known))});
        }
        --column;
      }
      is_asked_[column] = true;
    }
  }

  /// The text of a number with a decimal point.
  std::string Plain(std::string_view field) const {
    std::string text(Unquoted(field));
    if (separator_ != ',') std::ranges::replace(text, ',', '.');
    return text;
  }

  static bool IsNumber(std::string_view text) {
    text = Trimmed(text);
    double number = 0.0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && rest == text.data() + text.size();
  }

  void StartIfRateIsKnown() {
    constexpr double kAnyRateHz = 1000.0;
    const int count = static_cast<int>(channels_.size());
    needs_rate_ = DependsOnRate(settings_.config, count);
    if (!needs_rate_ || std::isfinite(settings_.rate_hz)) {
      Start(needs_rate_ ? settings_.rate_hz : kAnyRateHz);
    } else if (!clock_) {
      throw UserError({.place = fmt::format("filter {}", settings_.config.kind()),
                       .problem = "needs the sampling rate: a column of time (as time_s), or --set "
                                  "rate_hz=HZ"});
    }
  }

  void Start(double rate_hz) {
    rate_hz_ = rate_hz;
    filter_ = controller::MakeFilter(settings_.config, static_cast<int>(channels_.size()), rate_hz);
    values_.assign(channels_.size(), 0.0);
    filtered_.assign(channels_.size(), 0.0);
    started_.assign(channels_.size(), false);
  }

  void StartAtRateOfClock() {
    constexpr double kLowestHz = 10.0;
    constexpr double kHighestHz = 10e3;
    const double rate_hz = clock_->RateHz();
    if (!(rate_hz >= kLowestHz && rate_hz <= kHighestHz)) {
      Fail(1, time_column_,
           clock_->rows() < 2 ? "has one row, from which no rate follows; give --set rate_hz=HZ"
                              : fmt::format("gives {:.5g} Hz, must be {:g} to {:g} Hz; name the "
                                            "unit (as time_ms), or give --set rate_hz=HZ",
                                            rate_hz, kLowestHz, kHighestHz));
    }
    Start(rate_hz);
    for (const auto& [line, row] : waiting_) FilterRow(SplitCells(line, separator_), row);
    waiting_.clear();
  }

  void FilterRow(const std::vector<std::string_view>& fields, std::size_t row) {
    for (std::size_t i = 0; i < channels_.size(); ++i) ReadValue(fields[channels_[i]], row, i);
    filter_->Step(values_, filtered_);
    Write(fields);
  }

  /// A filter gets finite numbers only, and none so large that a sum of them is not: another is
  /// the last good one again. Before a channel's first good one its filter does not count; it
  /// starts there.
  void ReadValue(std::string_view field, std::size_t row, std::size_t channel) {
    const std::optional<double> value = NumberOrMissing(Plain(field));
    if (!value) {
      Fail(row, channels_[channel], fmt::format("is \"{}\", must be a number", Shown(field)));
    }
    constexpr double kLargest = 1e100;
    if (std::abs(*value) <= kLargest) {
      values_[channel] = *value;
      if (!started_[channel]) filter_->ResetChannel(static_cast<int>(channel));
      started_[channel] = true;
    } else {
      ++missing_;
    }
  }

  void Write(const std::vector<std::string_view>& fields) {
    text_.clear();
    const auto out = std::back_inserter(text_);
    std::size_t channel = 0;
    for (std::size_t column = 0; column < columns_; ++column) {
      if (column > 0) text_.push_back(separator_);
      if (channel < channels_.size() && channels_[channel] == column) {
        const double value = started_[channel] ? filtered_[channel] : kUnknown;
        const std::size_t begin = text_.size();
        fmt::format_to(out, "{}", value);  // the fewest digits that read back to the same bits
        if (separator_ != ',' && fields[column].find(',') != std::string_view::npos) {
          std::replace(text_.begin() + begin, text_.end(), '.', ',');
        }
        ++channel;
      } else {
        fmt::format_to(out, "{}", Trimmed(fields[column]));
      }
    }
    text_.push_back('\n');
    PrintText({text_.data(), text_.size()});
    CheckOutput();
  }

  [[noreturn]] static void Fail(std::size_t row, const std::string& problem) {
    throw UserError({.place = fmt::format("standard input:{}", row), .problem = problem});
  }
  [[noreturn]] static void Fail(std::size_t row, std::size_t column, const std::string& problem) {
    throw UserError(
        {.place = fmt::format("standard input:{}:{}", row, column + 1), .problem = problem});
  }

  struct WaitingRow {
    std::string line;
    std::size_t row;
  };

  const StreamFilter& settings_;
  const std::vector<std::string>& asked_;
  std::vector<bool> is_asked_;
  char separator_ = ',';
  std::unique_ptr<controller::Filter> filter_;  // none until the rate is known
  bool needs_rate_ = false;
  double rate_hz_ = kUnknown;
  std::size_t columns_ = 0;
  std::optional<RowClock> clock_;
  std::size_t time_column_ = 0;
  std::vector<WaitingRow> waiting_;
  std::vector<std::size_t> channels_;  // columns that are filtered
  std::vector<double> values_;
  std::vector<double> filtered_;
  std::vector<bool> started_;  // had a good value
  std::size_t missing_ = 0;
  fmt::memory_buffer text_;
};

/// A read that failed is no end: what comes behind it is missing.
void CheckInput() {
  if (std::cin.bad()) {
    throw RunError(fmt::format("standard input: cannot be read: {}", std::strerror(errno)));
  }
}

void RunFilter(const FilterOptions& options) {
  EndAtSignals();  // it waits for its source, and has nothing to tidy up
  const StreamFilter settings = ReadFilter(options);
  FilterStream stream(settings, options.columns);
  std::ios::sync_with_stdio(false);
  std::string line;
  errno = 0;
  if (!std::getline(std::cin, line)) {
    CheckInput();
    throw UserError({.place = "standard input", .problem = "is empty, needs a header"});
  }
  stream.ReadHeader(WithoutByteOrderMark(line));
  for (std::size_t row = 2; std::getline(std::cin, line); ++row) {
    if (!Trimmed(line).empty()) stream.ReadRow(line, row);
  }
  CheckInput();
  stream.Finish();
}

}  // namespace

void AddFilterCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "filter", "Filter a stream: CSV with a header in, the same columns out, line by line");
  const auto options = std::make_shared<FilterOptions>();
  command->add_option("kind", options->kind, "kind of filter (gauntlet list filters)")->required();
  command
      ->add_option("--set", options->settings,
                   "a setting of the filter, or rate_hz (if no column of time tells it); lists as "
                   "r=21.18,12.52; may be repeated")
      ->type_name("key=value")
      ->take_all();
  command
      ->add_option(
          "--columns", options->columns,
          "columns to filter, by names or numbers from 1; all others pass through, also as "
          "text [all but the time]")
      ->type_name("NAME,..")
      ->delimiter(',');
  command->footer(
      "\nCells stand between commas, semicolons or tabs, and come out so. A column of\n"
      "time (time, timestamp, t, with a unit as in time_ms; in s without) passes through, and k,\n"
      "frame or sample if it is the first; all others are channels, unless --columns names some.\n"
      "The sampling rate is that of the first 21 times, unless rate_hz gives it; filters that\n"
      "only count samples need none. A missing value (empty, nan, NA), or one beyond 1e100, is\n"
      "held at the last good one.\n"
      "\nExample:\n  gauntlet filter kalman --set q=0.001 --set r=21.18 < in.csv > out.csv\n");
  command->callback([options] { RunFilter(*options); });
}

}  // namespace gauntlet::sim
