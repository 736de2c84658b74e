#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>

#include "controller/filters/filter_registry.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/cli/commands.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/standard_streams.h"
#include "sim/recordings/time_columns.h"
#include "sim/settings/yaml_reader.h"

namespace gauntlet::sim {
namespace {

struct FilterOptions {
  std::string kind;
  std::vector<std::string> settings;
};

/// The filter of the command line, and the rate that `rate_hz` gives beside the filter's own keys.
struct StreamFilter {
  controller::FilterConfig config;
  double rate_hz = 1000.0;

  void Visit(controller::SettingsVisitor& visitor) {
    config.Visit(visitor);
    visitor.Number({.key = "rate_hz", .help = "sampling rate", .min = 0, .open_range = true},
                   rate_hz);
  }
};

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

/// A line-by-line filter: reads one row, writes one row, flushes.
class FilterStream {
 public:
  explicit FilterStream(const StreamFilter& settings) : settings_(settings) {}

  void ReadHeader(std::string_view line) {
    const std::vector<std::string_view> names = SplitCells(line);
    columns_ = names.size();
    std::size_t column = 0;
    std::size_t numbers = 0;
    for (const std::string_view name : names) {
      const std::string_view trimmed = Trimmed(name);
      if (trimmed.empty()) Fail(1, column, "has no name");
      if (!IsTime(trimmed, column)) channels_.push_back(column);
      numbers += IsNumber(trimmed);
      ++column;
    }
    if (numbers == columns_) {  // names that data frames give; or the header was forgotten
      Say("gauntlet: warning: standard input:1: numbers only, taken as the header\n");
    }
    if (channels_.empty()) Fail(1, "has no channel besides the time");
    filter_ = controller::MakeFilter(settings_.config, static_cast<int>(channels_.size()),
                                     settings_.rate_hz);
    values_.assign(channels_.size(), 0.0);
    started_.assign(channels_.size(), false);
    Print("{}\n", Trimmed(line));
    CheckOutput();
  }

  void ReadRow(std::string_view line, std::size_t row) {
    const std::vector<std::string_view> fields = SplitCells(line);
    if (fields.size() != columns_) {
      Fail(row, fmt::format("has {} fields, must have {}", fields.size(), columns_));
    }
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      ReadValue(Trimmed(fields[channels_[i]]), row, i);
    }
    filtered_.resize(values_.size());
    filter_->Step(values_, filtered_);
    Write(fields);
  }

  std::size_t missing() const { return missing_; }

 private:
  /// `k`, the number of the sample, is time in the first column only.
  static bool IsTime(std::string_view name, std::size_t column) {
    name = Unquoted(name);
    return TimeScaleS(name) || (IsSampleNumber(name) && column == 0);
  }

  static bool IsNumber(std::string_view text) {
    double number = 0.0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && rest == text.data() + text.size();
  }

  /// A filter gets finite numbers only, and none so large that a sum of them is not: another is
  /// the last good one again. Before a channel's first good one its filter does not count; it
  /// starts there.
  void ReadValue(std::string_view field, std::size_t row, std::size_t channel) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (!field.empty()) {
      const char* begin = field.data() + (field.front() == '+' ? 1 : 0);
      const char* end = field.data() + field.size();
      const auto [rest, error] = std::from_chars(begin, end, value);
      if (error != std::errc() || rest != end) {
        Fail(row, channels_[channel], fmt::format("is \"{}\", must be a number", field));
      }
    }
    constexpr double kLargest = 1e100;
    if (std::abs(value) <= kLargest) {
      values_[channel] = value;
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
      if (column > 0) text_.push_back(',');
      if (channel < channels_.size() && channels_[channel] == column) {
        const double value =
            started_[channel] ? filtered_[channel] : std::numeric_limits<double>::quiet_NaN();
        fmt::format_to(out, "{:.17g}", value);
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

  const StreamFilter& settings_;
  std::unique_ptr<controller::Filter> filter_;
  std::size_t columns_ = 0;
  std::vector<std::size_t> channels_;  // columns that are filtered
  std::vector<double> values_;
  std::vector<double> filtered_;
  std::vector<bool> started_;  // had a good value
  std::size_t missing_ = 0;
  fmt::memory_buffer text_;
};

void RunFilter(const FilterOptions& options) {
  EndAtSignals();  // it waits for its source, and has nothing to tidy up
  const StreamFilter settings = ReadFilter(options);
  FilterStream stream(settings);
  std::ios::sync_with_stdio(false);
  std::string line;
  if (!std::getline(std::cin, line)) {
    throw UserError({.place = "standard input", .problem = "is empty, needs a header"});
  }
  stream.ReadHeader(WithoutByteOrderMark(line));
  for (std::size_t row = 2; std::getline(std::cin, line); ++row) {
    if (!Trimmed(line).empty()) stream.ReadRow(line, row);
  }
  if (stream.missing() > 0) {
    Say("gauntlet: {} missing values held at the last good one\n", stream.missing());
  }
}

}  // namespace

void AddFilterCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "filter", "Filter a stream: CSV with a header in, the same columns out, line by line");
  const auto options = std::make_shared<FilterOptions>();
  command->add_option("kind", options->kind, "kind of filter (gauntlet list filters)")->required();
  command
      ->add_option("--set", options->settings,
                   "a setting of the filter, or rate_hz; lists as r=21.18,12.52; may be repeated")
      ->type_name("key=value")
      ->take_all();
  command->footer(
      "\nColumns named t_s, time, time_s, time_ms or time_us pass through, and k if it is the\n"
      "first; all others are channels. A missing value, or one beyond 1e100, is held at the last\n"
      "good one.\n"
      "\nExample:\n  gauntlet filter kalman --set q=0.001 --set r=21.18 < in.csv > out.csv\n");
  command->callback([options] { RunFilter(*options); });
}

}  // namespace gauntlet::sim
