#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/commands.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/row_clock.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/stream_table.h"
#include "sim/recordings/time_guess.h"
#include "sim/results/table_text.h"
#include "sim/settings/libraries/like_filter.h"
#include "sim/settings/yaml_reader.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_format.h"
#include "sim/tables/text_forms.h"
#include "sim/tables/text_lines.h"
#include "sim/trial/held_filter.h"

namespace gauntlet::sim {
namespace {

struct FilterOptions {
  static constexpr auto kName = "filter";
  static constexpr auto kPurpose = "Filter a CSV stream line by line";
  static constexpr auto kGroup = Group::kOther;
  std::string kind;
  std::vector<std::string> settings;
  std::vector<std::string> columns;  // to filter; empty: all but the time
  std::string map;                   // empty: columns as their names say
  std::string time_unit;             // empty: by the name of the column
  std::string hand;                  // left or right; empty: all rows

  Options Rows() {
    return {
        Argument("kind", &kind, Offer::kFilterKinds, "kind of filter (gauntlet list filters)"),
        Option("--set", &settings, {.value = "key=value", .offer = Offer::kFilterKeys},
               "a setting of the filter, or rate_hz (if no column of time tells it); lists as "
               "r=21.18,12.52; may be repeated"),
        Option("--columns", &columns, {.value = "NAME,..", .separator = ','},
               "columns to filter, by names or numbers from 1; all others pass through, also as "
               "text [all but the time]"),
        Option("--map", &map, {.value = "FILE.csv", .offer = Offer::kFiles},
               "column map, or the name of a preset, as a scenario's glove.motion.map: its "
               "channels are filtered, in degrees, and come out as NAME_deg; with --columns those "
               "named, as NAME"),
        TimeUnitOption(time_unit, {"--map"}),
        Option("--hand", &hand, {.choices = {"left", "right"}, .excludes = {"--map"}},
               "the hand whose rows come out, where a column names the hand of each row"),
    };
  }

  static constexpr auto kNotes = R"(
The table is found as gauntlet inspect finds it; lines above it are left out. Labels of a
serial plotter (flex1:512 flex2:300), lists ([512 300]), JointState of ROS as text and the
alpha encoding of opengloves come out as a table. A column of time (time, timestamp, t, with a
unit as in time_ms; in s without) passes through, and so do numbers of rows, labels, hands and
other times by their names; all others are channels, unless --columns names some. A clock may
go past midnight.
Another name of a time, as recv_timestamp_ms, is taken if its first 21 values rise.
With like=LIBRARY the settings are those of another library, as it means them (gauntlet export
--for names them). The unit that they say is that of the columns; with --map these are degrees.

The sampling rate is that of the first 21 times, unless rate_hz gives it; filters that
only count samples need none. A missing value (empty, nan, NA), or one beyond 1e100, is
held at the last good one.

A map's columns need no such names, nor a header. Each channel comes out where the first
column stood that it is made of, not cut to the joint's range; columns without a row in the
map pass through. Counts whose bits the map does not say are of 10 bits. Rows of the other hand
are left out, by --hand or by a map that has the hand.

Example:
  gauntlet filter kalman --set q=0.001 --set r=21.18 < in.csv > out.csv
  gauntlet filter exponential --set like=dex-retargeting --set low_pass_alpha=0.2 < in.csv

  gauntlet inspect glove.csv --write-map map.csv
  gauntlet filter one_euro --map map.csv < glove.csv > angles.csv
  gauntlet filter butterworth --map map.csv --columns index_mcp,index_pip < glove.csv
)";
};

/// The filter of the command line, and the rate that `rate_hz` gives beside the filter's own keys.
struct StreamFilter {
  controller::FilterConfig config;
  double rate_hz = controller::kNaN;
  YamlSource source = {.file = "command line", .overrides = {}};
  std::optional<LikeFilter> like = {};  // has the settings of `config`, for a rate

  bool DependsOnRateOf(int channels) const {
    return DependsOnRate(config, channels) || (like && like->settings->DependsOnRate());
  }
  /// At a rate, for a signal in `unit`; empty: in that of the settings.
  controller::FilterConfig At(double rate, std::string_view unit) const {
    controller::FilterConfig filter = config;
    if (like) filter.settings = like->At(rate, unit, source);
    return filter;
  }

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
  const std::vector<std::string> kinds = AllNames(controller::FilterKinds());
  if (std::ranges::find(kinds, options.kind) == kinds.end()) {
    throw UserError({.place = "filter " + options.kind,
                     .problem = "unknown kind" + Suggestion(options.kind, kinds)});
  }
  for (const std::string& text : options.settings) {
    if (text.starts_with("kind=")) {
      throw UserError(
          {.place = "--set " + text,
           .problem = "the kind is an argument: gauntlet filter " + ShellWord(text.substr(5))});
    }
    if (text.ends_with(','))
      throw UserError({.place = "--set " + text, .problem = "ends with a comma"});
  }
  YamlNode root = YamlNode::Map({{YamlNode::Scalar("kind"), YamlNode::Scalar(options.kind)}});
  StreamFilter filter;
  for (const std::string& text : options.settings) {
    ApplyOverride(root, WithList(text), filter.source);
  }
  const YamlNode rate_hz = ChildOf(root, "rate_hz");
  YamlNode of_library = WithoutChild(root, "rate_hz");
  if ((filter.like = ExtractLikeFilter(of_library, "", filter.source))) {
    std::vector<YamlNode::Entry> entries = of_library.entries();
    if (rate_hz.IsDefined()) entries.emplace_back(YamlNode::Scalar("rate_hz"), rate_hz);
    root = YamlNode::Map(std::move(entries));
  }
  ReadAll(root, filter.source, filter);
  return filter;
}

/// A line-by-line filter: reads one row, writes one row, flushes. The first rows of a stream wait
/// until they have told the rate, if the filter needs it and it is not given.
class FilterStream {
 public:
  FilterStream(const StreamFilter& settings, StreamTable table)
      : settings_(settings), table_(std::move(table)) {
    if (table_.has_time()) clock_.emplace(table_.time_scale_s());
    midnight_ = MidnightClock(table_.time());
    if (table_.needs_time() && !clock_ && !std::isfinite(settings_.rate_hz)) {
      throw UserError({.place = "--map",
                       .key = "envelope_ms",
                       .problem = "needs the times of the rows: a column of time in the map, or "
                                  "--set rate_hz=HZ"});
    }
    StartIfRateIsKnown();
    for (const std::string& remark : table_.remarks()) {
      Say("gauntlet: standard input: {}\n", remark);
    }
    PrintText(table_.header());
    CheckOutput();
  }

  void ReadRow(std::string_view line, std::size_t row) {
    table_.Read(line, row);
    if (table_.IsOfOtherHand()) {
      ++rows_of_other_hand_;
      return;
    }
    const double time = midnight_.Add(table_.Time());
    const bool has_time = clock_ && clock_->Add(time);
    if (filter_) {
      FilterRow(time);
      return;
    }
    if (!has_time) {
      StreamTable::Fail(row, table_.time_column(),
                        fmt::format("is \"{}\", must be a time above that of the row before, from "
                                    "which the rate follows; --set rate_hz=HZ gives it otherwise",
                                    Shown(table_.TimeText())));
    }
    waiting_.push_back({std::string(line), row, time});
    if (clock_->rows() == RowClock::kRowsForRate) StartAtRateOfClock();
  }

  /// At the end of the stream.
  void Finish() {
    if (!filter_ && !waiting_.empty()) StartAtRateOfClock();
    constexpr double kNoticeable = 0.05;
    const double measured_hz = clock_ ? clock_->RateHz() : controller::kNaN;
    if (needs_rate_ && std::abs(measured_hz / rate_hz_ - 1.0) > kNoticeable) {
      Say("gauntlet: warning: standard input: its times say {:.5g} Hz, the filter was made for "
          "{:.5g} Hz\n",
          measured_hz, rate_hz_);
    }
    if (filter_ && filter_->held() > 0) {
      Say("gauntlet: {} missing values held at the last good one\n", filter_->held());
    }
    if (midnight_.midnights() > 0) Say("gauntlet: standard input: {}\n", kPastMidnight);
    if (rows_of_other_hand_ > 0) {
      Say("gauntlet: standard input: {} rows of the other hand left out\n", rows_of_other_hand_);
    }
  }

 private:
  void StartIfRateIsKnown() {
    constexpr double kAnyRateHz = 1000.0;
    const int count = table_.channel_count();
    needs_rate_ = settings_.DependsOnRateOf(count);
    if (!needs_rate_ || std::isfinite(settings_.rate_hz)) {
      Start(needs_rate_ ? settings_.rate_hz : kAnyRateHz);
    } else if (!clock_) {
      throw UserError({.place = fmt::format("filter {}", settings_.config.kind()),
                       .problem = "needs the sampling rate: a column of time (as time_s), or --set "
                                  "rate_hz=HZ"});
    }
  }

  void Start(double rate_hz) {
    const std::size_t count = table_.channel_count();
    rate_hz_ = rate_hz;
    filter_.emplace(settings_.At(rate_hz, table_.unit()), static_cast<int>(count), rate_hz);
    values_.assign(count, 0.0);
    filtered_.assign(count, 0.0);
  }

  void StartAtRateOfClock() {
    constexpr double kLowestHz = 10.0;
    constexpr double kHighestHz = 10e3;
    const double rate_hz = clock_->RateHz();
    if (!(rate_hz >= kLowestHz && rate_hz <= kHighestHz)) {
      StreamTable::Fail(1, table_.time_column(),
                        clock_->rows() < 2
                            ? "has one row, from which no rate follows; give --set rate_hz=HZ"
                            : fmt::format("gives {:.5g} Hz, must be {:g} to {:g} Hz; "
                                          "--time-unit ms, or --set rate_hz=HZ",
                                          rate_hz, kLowestHz, kHighestHz));
    }
    Start(rate_hz);
    for (const auto& [line, row, time] : waiting_) {
      table_.Read(line, row);
      FilterRow(time);
    }
    waiting_.clear();
  }

  /// `time`: as of the table, which goes on over midnight.
  void FilterRow(double time) {
    const double time_s = clock_ ? time * table_.time_scale_s() : rows_ / settings_.rate_hz;
    ++rows_;
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] = table_.Value(i, time_s);
    filter_->Step(values_, filtered_);
    PrintText(table_.Written(filtered_, time_s));
    CheckOutput();
  }

  struct WaitingRow {
    std::string line;
    std::size_t row;
    double time;
  };

  const StreamFilter& settings_;
  StreamTable table_;
  std::optional<HeldFilter> filter_;  // none until the rate is known
  bool needs_rate_ = false;
  double rate_hz_ = controller::kNaN;
  double rows_ = 0.0;  // that are filtered
  std::optional<RowClock> clock_;
  MidnightClock midnight_;
  std::size_t rows_of_other_hand_ = 0;
  std::vector<WaitingRow> waiting_;
  std::vector<double> values_;
  std::vector<double> filtered_;
};

/// The text of standard input, as soon as it comes; UTF-16 as UTF-8.
/// Errors: UserError for what is no text; RunError where a read failed, which is no end: what comes
/// behind it is missing.
TextLines::Source StandardInput() {
  const TextLines::Source bytes = [](char* buffer, std::size_t size) {
    for (;;) {
      const ssize_t got = read(STDIN_FILENO, buffer, size);
      if (got >= 0) return static_cast<std::size_t>(got);
      if (errno == EINTR) continue;
      throw RunError(fmt::format("standard input: cannot be read: {}", std::strerror(errno)));
    }
  };
  std::string head = BytesOf(bytes, 2);  // of a byte order mark
  TextLines::Source all = WithHead(head, bytes);
  return FormatOfBytes(head) == FileFormat::kUtf16 ? Utf8Of(std::move(all)) : all;
}

void RunFilter(const FilterOptions& options) {
  EndAtSignals();  // it waits for its source, and has nothing to tidy up
  const StreamFilter settings = ReadFilter(options);
  LiveTable table = PlainStream("standard input", StandardInput());
  TextLines lines("standard input", std::move(table.source));
  const StreamHead head = ReadHead(lines, !options.map.empty());
  FilterStream stream(settings, StreamTable(head, {.map = options.map,
                                                   .asked = options.columns,
                                                   .time_unit = options.time_unit,
                                                   .hand = options.hand}));
  for (const TextLine& row : head.rows) stream.ReadRow(row.text, row.number);
  for (std::string_view line; lines.Next(line);) {
    if (IsRow(line)) stream.ReadRow(line, lines.number());
  }
  stream.Finish();
  if (table.left_out && *table.left_out > 0) {
    Say("gauntlet: standard input: {} without all labels left out\n",
        Counted(*table.left_out, "line"));
  }
}

}  // namespace

Command MakeFilterCommand() { return MakeCommand(RunFilter); }

}  // namespace gauntlet::sim
