#include "sim/device/text_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/base/csv_line.h"
#include "sim/base/text.h"
#include "sim/recordings/text_lines.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLongestFrameLine = std::size_t{1} << 16;
constexpr std::size_t kMostHeadLines = 40;

bool IsBlankOrComment(std::string_view line) {
  const std::string_view text = Trimmed(line);
  return text.empty() || text.front() == '#';
}

/// The shape of a line of cells.
struct RowShape {
  char separator = ',';
  std::size_t cells = 0;
  bool is_row = false;    // values only, at least one number
  bool is_names = false;  // keys only

  bool HasSameCells(const RowShape& other) const {
    return cells == other.cells && (separator == other.separator || cells == 1);
  }
};

RowShape ShapeOf(std::string_view line) {
  RowShape shape{.separator = SeparatorOf(line)};
  std::vector<std::string_view> cells = SplitCells(line, shape.separator);
  if (cells.size() > 1 && Trimmed(cells.back()).empty()) cells.pop_back();
  shape.cells = cells.size();
  bool has_number = false;
  shape.is_row = std::ranges::all_of(cells, [&](std::string_view cell) {
    const std::optional<double> value = ValueIn(cell, shape.separator);
    has_number = has_number || (value && std::isfinite(*value));
    return value.has_value();
  });
  shape.is_row = shape.is_row && has_number;
  shape.is_names = std::ranges::all_of(cells, [&](std::string_view cell) {
    return !Unquoted(cell).empty() && !ValueIn(cell, shape.separator) && TextProblem(cell).empty();
  });
  return shape;
}

}  // namespace

TextFrames::TextFrames(FrameFormat format, bool begins_whole)
    : format_(format), begins_whole_(begins_whole), is_in_line_(!begins_whole) {}

void TextFrames::Restart() {
  if (!rest_.empty()) CountHalf("a line has no end");
  rest_.clear();
  is_in_line_ = !begins_whole_;
}

void TextFrames::Take(std::string_view bytes, std::int64_t arrival_ns,
                      const FrameReceiver& receive) {
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    const std::string_view part = bytes.substr(0, end);
    bytes.remove_prefix(std::min(part.size() + 1, bytes.size()));
    if (!is_in_line_) rest_.append(part);
    if (rest_.size() > kLongestFrameLine) {
      CountGarbage(fmt::format("a line is longer than {} bytes", kLongestFrameLine));
      rest_.clear();
      is_in_line_ = true;
    }
    if (end == std::string_view::npos) return;
    if (is_in_line_) {
      is_in_line_ = false;
      continue;
    }
    const std::string line = std::exchange(rest_, {});
    TakeLine(line, arrival_ns, receive);
  }
}

void TextFrames::EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) {
  is_in_line_ = false;
  const std::string line = std::exchange(rest_, {});
  TakeLine(line, arrival_ns, receive);
}

void TextFrames::TakeLine(std::string_view line, std::int64_t arrival_ns,
                          const FrameReceiver& receive) {
  line = WithoutByteOrderMark(line);
  if (IsBlankOrComment(line)) return;
  if (is_known_) {
    TakeRow(line, arrival_ns, receive);
    return;
  }
  head_.push_back({std::string(line), arrival_ns});
  LookAtHead(receive);
  if (!is_known_ && head_.size() > kMostHeadLines) {
    CountGarbage("lines that do not agree with each other");
    head_.pop_front();
  }
}

bool TextFrames::FindTable() {
  if (format_ != FrameFormat::kDetect && format_ != FrameFormat::kCsv) return false;
  if (head_.size() < 2) return false;
  const std::size_t last = head_.size() - 1;
  const RowShape row = ShapeOf(head_[last].text);
  const RowShape above = ShapeOf(head_[last - 1].text);
  if (!row.is_row || !row.HasSameCells(above)) return false;
  const bool is_alone = row.cells == 1 && (!begins_whole_ || head_.size() > 2);
  if (!above.is_row && (!above.is_names || is_alone)) return false;
  std::size_t first = last - 1;  // the line of names, or the first row
  std::vector<std::string> names;
  if (above.is_names) {
    for (const std::string_view cell : SplitCells(head_[first].text, row.separator)) {
      names.emplace_back(Unquoted(cell));
    }
    names.resize(row.cells);
    ++first;
  } else if (first > 0) {
    // Names above rows that came before any shape was known, such as one cell of each.
    const RowShape top = ShapeOf(head_[first - 1].text);
    if (top.is_names && top.HasSameCells(row) && begins_whole_ && first == 1) {
      names.emplace_back(Unquoted(head_[0].text));
    }
  }
  const std::size_t left_out = above.is_names ? first - 1 : first - (names.empty() ? 0 : 1);
  for (std::size_t i = 0; i < left_out; ++i) CountGarbage("a line before the first two that agree");
  head_.erase(head_.begin(), head_.begin() + static_cast<std::ptrdiff_t>(first));
  separator_ = row.separator;
  columns_.count = row.cells;
  SetColumnNames(std::move(names), columns_);
  values_.resize(row.cells);
  format_ = FrameFormat::kCsv;
  return true;
}

void TextFrames::LookAtHead(const FrameReceiver& receive) {
  is_known_ = FindTable();
  if (!is_known_) return;
  for (const Line& line : std::exchange(head_, {})) TakeRow(line.text, line.arrival_ns, receive);
}

void TextFrames::TakeRow(std::string_view line, std::int64_t arrival_ns,
                         const FrameReceiver& receive) {
  std::vector<std::string_view> cells = SplitCells(line, separator_);
  if (cells.size() == columns_.count + 1 && Trimmed(cells.back()).empty()) cells.pop_back();
  if (cells.size() != columns_.count) {
    std::string problem = fmt::format("a line has {} of {} values", cells.size(), columns_.count);
    cells.size() < columns_.count ? CountHalf(std::move(problem))
                                  : CountGarbage(std::move(problem));
    return;
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::optional<double> value = ValueIn(cells[i], separator_);
    if (!value) {
      const RowShape shape = ShapeOf(line);
      if (!shape.is_names) {
        CountGarbage(fmt::format("the value {} of a line is no number", i + 1));
        return;
      }
      std::vector<std::string> names;  // sent again, for listeners that came later
      for (const std::string_view cell : cells) names.emplace_back(Unquoted(cell));
      if (columns_.names.empty()) {
        SetColumnNames(std::move(names), columns_);
      } else if (names != columns_.names) {
        CountGarbage("a line has other names of columns than the first one");
      }
      return;
    }
    values_[i] = *value;
  }
  ++counts_.frames;
  receive(FrameOf(columns_, values_, arrival_ns));
}

}  // namespace gauntlet::sim
