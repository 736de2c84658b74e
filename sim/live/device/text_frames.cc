#include "sim/live/device/text_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/tables/json_arrays.h"
#include "sim/tables/missing.h"
#include "sim/tables/text_forms.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::sim {

/// Names and values of lines in one form.
class LineForm {
 public:
  enum class Found { kRow, kNames, kHalf, kGarbage };

  LineForm(FrameFormat format, std::vector<std::string> names, std::size_t count)
      : format_(format), names_(std::move(names)), count_(count) {}
  virtual ~LineForm() = default;

  FrameFormat format() const { return format_; }
  /// Empty: not known.
  const std::vector<std::string>& names() const { return names_; }
  std::size_t count() const { return count_; }
  const std::string& problem() const { return problem_; }

  /// `values` has count() places. kNames: the line gave names(), which were not known before, or
  /// repeats them.
  virtual Found Read(std::string_view line, std::span<double> values) = 0;

 protected:
  Found Fail(Found found, std::string problem) {
    problem_ = std::move(problem);
    return found;
  }
  Found FailCount(std::size_t count) {
    return Fail(count < count_ ? Found::kHalf : Found::kGarbage,
                fmt::format("a line has {} of {} values", count, count_));
  }

  FrameFormat format_;
  std::vector<std::string> names_;
  std::size_t count_;
  std::string problem_;
};

namespace {

constexpr std::size_t kLongestFrameLine = std::size_t{1} << 16;
constexpr std::size_t kMostHeadLines = 40;
constexpr std::size_t kLinesForLabels = 4;

bool IsBlankOrComment(std::string_view line) {
  const std::string_view text = Trimmed(line);
  return text.empty() || text.front() == '#';
}

/// Without the cell behind a separator at the end.
void DropBlankEnd(std::vector<std::string_view>& cells) {
  if (cells.size() > 1 && Trimmed(cells.back()).empty()) cells.pop_back();
}

std::vector<std::string> NamesIn(const std::vector<std::string_view>& cells) {
  std::vector<std::string> names;
  for (const std::string_view cell : cells) names.emplace_back(Unquoted(cell));
  return names;
}

/// True for cells that may name columns: texts, none of them a value.
bool AreNames(const std::vector<std::string_view>& cells, char separator) {
  return std::ranges::all_of(cells, [separator](std::string_view cell) {
    return !IsValue(cell, separator) && TextProblem(cell).empty();
  });
}

/// True for values only, at least one of them a number.
bool AreValues(const std::vector<std::string_view>& cells, char separator) {
  bool has_number = false;
  const bool has_values = std::ranges::all_of(cells, [&](std::string_view cell) {
    const std::optional<double> value = ValueIn(cell, separator);
    has_number = has_number || (value && std::isfinite(*value));
    return value.has_value();
  });
  return has_values && has_number;
}

// --- CSV -----------------------------------------------------------------------------------------

class CsvForm : public LineForm {
 public:
  CsvForm(char separator, std::vector<std::string> names, std::size_t count)
      : LineForm(FrameFormat::kCsv, std::move(names), count), separator_(separator) {}

  Found Read(std::string_view line, std::span<double> values) override {
    std::vector<std::string_view> cells = SplitCells(line, separator_);
    if (cells.size() == count_ + 1) DropBlankEnd(cells);
    if (cells.size() != count_) return FailCount(cells.size());
    for (std::size_t i = 0; i < count_; ++i) {
      const std::optional<double> value = ValueIn(cells[i], separator_);
      if (!value) return ReadNames(cells, i);
      values[i] = *value;
    }
    return Found::kRow;
  }

 private:
  Found ReadNames(const std::vector<std::string_view>& cells, std::size_t bad_cell) {
    if (!AreNames(cells, separator_)) {
      return Fail(Found::kGarbage, fmt::format("value {} of a line is no number", bad_cell + 1));
    }
    std::vector<std::string> names = NamesIn(cells);
    if (names_.empty())
      names_ = std::move(names);
    else if (names != names_)
      return Fail(Found::kGarbage, "a line has other names of columns");
    return Found::kNames;
  }

  char separator_;
};

// --- Labels, alpha encoding, JointState, lists ---------------------------------------------------

class TableForm : public LineForm {
 public:
  TableForm(FrameFormat format, TextForm form)
      : LineForm(format, form.names, form.names.size()), form_(std::move(form)) {}

  Found Read(std::string_view line, std::span<double> values) override {
    if (std::exchange(form_.has_header, false)) return Found::kNames;
    const auto cells = form_.convert(line);
    if (!cells) {
      return Fail(Found::kGarbage, "a line does not have the labels of the first ones");
    }
    for (std::size_t i = 0; i < count_; ++i) {
      values[i] = ValueIn((*cells)[i], ',').value_or(kMissing);
    }
    return Found::kRow;
  }

 private:
  TextForm form_;
};

FrameFormat FormatOf(TextFormKind kind) {
  if (kind == TextFormKind::kLabels) return FrameFormat::kLabels;
  return kind == TextFormKind::kAlpha ? FrameFormat::kAlpha : FrameFormat::kCsv;
}

// --- JSON ----------------------------------------------------------------------------------------

/// The numbers of a line with one JSON value, by name; empty if it has none or is no JSON.
std::vector<NamedArray> JsonValuesIn(std::string_view line) {
  try {
    return ReadJsonRow(line);
  } catch (const UserError&) {
    return {};
  }
}

std::vector<std::string> JsonNamesIn(std::string_view line) {
  std::vector<std::string> names;
  for (const NamedArray& value : JsonValuesIn(line)) names.push_back(value.name);
  return names;
}

bool LooksLikeJson(std::string_view line) {
  const std::string_view text = Trimmed(line);
  return text.starts_with('{') || text.starts_with('[');
}

class JsonForm : public LineForm {
 public:
  explicit JsonForm(std::vector<std::string> names)
      : LineForm(FrameFormat::kJson, std::move(names), 0) {
    count_ = names_.size();
  }

  Found Read(std::string_view line, std::span<double> values) override {
    const std::vector<NamedArray> found = JsonValuesIn(line);
    std::ranges::fill(values, kMissing);
    bool has_value = false;
    for (const NamedArray& value : found) {
      const auto name = std::ranges::find(names_, value.name);
      if (name == names_.end()) continue;
      const double number = value.values.front();
      values[static_cast<std::size_t>(name - names_.begin())] = number;
      has_value = has_value || !std::isnan(number);
    }
    if (has_value) return Found::kRow;
    const std::string_view text = Trimmed(line);
    const bool has_end = text.ends_with('}') || text.ends_with(']');
    return Fail(LooksLikeJson(line) && !has_end ? Found::kHalf : Found::kGarbage,
                "a line is no JSON with the keys of the first one");
  }
};

}  // namespace

// --- Lines ---------------------------------------------------------------------------------------

TextFrames::TextFrames(FrameFormat format, ByteFlow flow)
    : format_(format), flow_(flow), passes_over_line_(flow == ByteFlow::kCutStream) {}

TextFrames::~TextFrames() = default;

void TextFrames::Restart() {
  if (!rest_.empty()) CountHalf("the last line has no end");
  rest_.clear();
  passes_over_line_ = flow_ == ByteFlow::kCutStream;
}

void TextFrames::Decode(std::string_view bytes, std::int64_t arrival_ns,
                        const FrameReceiver& receive) {
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    const std::string_view part = bytes.substr(0, end);
    bytes.remove_prefix(std::min(part.size() + 1, bytes.size()));
    if (!passes_over_line_) rest_.append(part);
    if (rest_.size() > kLongestFrameLine) {
      CountGarbage(fmt::format("a line is longer than {} bytes", kLongestFrameLine));
      rest_.clear();
      passes_over_line_ = true;
    }
    if (end == std::string_view::npos) return;
    if (!std::exchange(passes_over_line_, false)) {
      DecodeLine(std::exchange(rest_, {}), arrival_ns, receive);
    }
  }
}

void TextFrames::EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) {
  passes_over_line_ = false;
  DecodeLine(std::exchange(rest_, {}), arrival_ns, receive);
}

void TextFrames::DecodeLine(std::string_view line, std::int64_t arrival_ns,
                            const FrameReceiver& receive) {
  line = WithoutByteOrderMark(line);
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (IsBlankOrComment(line)) return;
  if (form_) {
    DecodeRow(line, arrival_ns, receive);
    return;
  }
  head_.push_back({std::string(line), arrival_ns});
  form_ = FindForm();
  if (!form_) {
    if (head_.size() > kMostHeadLines) {
      CountGarbage("no two lines agree");
      head_.pop_front();
      is_first_line_ = false;
    }
    return;
  }
  format_ = form_->format();
  columns_.count = form_->count();
  values_.resize(columns_.count);
  NameColumns(form_->names());
  for (std::size_t i = 0; i < first_; ++i) CountGarbage("a line before the first ones that agree");
  const std::deque<Line> head = std::exchange(head_, {});
  for (std::size_t i = first_; i < head.size(); ++i) {
    DecodeRow(head[i].text, head[i].arrival_ns, receive);
  }
}

void TextFrames::DecodeRow(std::string_view line, std::int64_t arrival_ns,
                           const FrameReceiver& receive) {
  switch (form_->Read(line, values_)) {
    case LineForm::Found::kRow:
      Emit(values_, arrival_ns, receive);
      break;
    case LineForm::Found::kNames:
      if (columns_.names.empty()) NameColumns(form_->names());
      break;
    case LineForm::Found::kHalf:
      CountHalf(form_->problem());
      break;
    case LineForm::Found::kGarbage:
      CountGarbage(form_->problem());
      break;
  }
}

// --- The form of the first lines -----------------------------------------------------------------

std::unique_ptr<LineForm> TextFrames::FindTable() {
  const std::size_t last = head_.size() - 1;
  const std::string& line = head_[last].text;
  const std::string& line_above = head_[last - 1].text;
  const char separator = SeparatorOf(line);
  std::vector<std::string_view> cells = SplitCells(line, separator);
  if (!AreValues(cells, separator)) return nullptr;
  std::vector<std::string_view> above = SplitCells(line_above, separator);
  // A separator may stand behind the last value, or behind the last name.
  DropBlankEnd(above);
  if (AreValues(above, separator)) above = SplitCells(line_above, separator);
  if (cells.size() == above.size() + 1) DropBlankEnd(cells);
  if (above.size() != cells.size()) return nullptr;
  // A word alone may be a boot message: only the first line of a stream that begins whole names a
  // single column.
  const auto may_name = [&](std::size_t i) {
    return cells.size() > 1 || (i == 0 && is_first_line_ && flow_ != ByteFlow::kCutStream);
  };
  std::vector<std::string> names;
  if (AreNames(above, separator)) {
    if (!may_name(last - 1)) return nullptr;
    names = NamesIn(above);
  } else if (!AreValues(above, separator)) {
    return nullptr;
  }
  first_ = last - 1;
  return std::make_unique<CsvForm>(separator, std::move(names), cells.size());
}

std::unique_ptr<LineForm> TextFrames::FindForm() {
  std::unique_ptr<LineForm> form;
  if (head_.size() < 2) return form;
  const std::string& last = head_.back().text;
  const std::string& above = head_[head_.size() - 2].text;
  if (MayBe(FrameFormat::kJson) && LooksLikeJson(last) && LooksLikeJson(above)) {
    std::vector<std::string> names = JsonNamesIn(last);
    first_ = head_.size() - 2;
    if (!names.empty() && names == JsonNamesIn(above)) {
      return std::make_unique<JsonForm>(std::move(names));
    }
  }
  if (MayBe(FrameFormat::kCsv)) form = FindTable();
  if (form) return form;
  for (const std::size_t count : {kLinesForLabels, std::size_t{2}}) {
    first_ = head_.size() - std::min(head_.size(), count);
    std::vector<std::string> lines;
    for (std::size_t i = first_; i < head_.size(); ++i) lines.push_back(head_[i].text);
    auto found = FormOf(lines);
    if (!found || !MayBe(FormatOf(found->kind))) continue;
    return std::make_unique<TableForm>(FormatOf(found->kind), std::move(*found));
  }
  return form;
}

}  // namespace gauntlet::sim
