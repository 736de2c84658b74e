#include "sim/tables/text_forms.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/joint_unit.h"
#include "sim/tables/opensim_files.h"
#include "sim/tables/text_lines.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using Cells = std::vector<std::string>;
constexpr std::size_t kHeadLines = 40;

bool IsRowOfNumbers(std::string_view line) {
  const char separator = SeparatorOf(line);
  return std::ranges::all_of(SplitCells(line, separator), [separator](std::string_view cell) {
    return IsValue(cell, separator);
  });
}

bool IsNumber(std::string_view cell) {
  const std::optional<double> number = NumberOrMissing(Trimmed(cell));
  return number.has_value() && !Trimmed(cell).empty();
}

/// The next line; one whose list is not closed with those below it. False at the end.
bool NextRecord(TextLines& lines, std::string& record) {
  constexpr int kMostLines = 64;
  std::string_view line;
  if (!lines.Next(line)) return false;
  record = line;
  const auto is_open = [&record] {  // a colour has a bracket, too
    return record.find('\x1b') == std::string::npos &&
           std::ranges::count(record, '[') > std::ranges::count(record, ']');
  };
  for (int i = 0; i < kMostLines && is_open() && lines.Next(line); ++i) {
    record.append(" ").append(line);
  }
  return true;
}

// --- Labels in the cells -------------------------------------------------------------------------

/// Takes `I (1020) TAG:` off, as ESP-IDF logs begin, maybe behind a colour: milliseconds since the
/// start, returned in seconds.
std::optional<std::string> TakeLogTime(std::string_view& line) {
  std::string_view rest = line;
  if (rest.starts_with("\x1b[")) rest.remove_prefix(std::min(rest.find('m'), rest.size() - 1) + 1);
  constexpr std::string_view kLevels = "EWIDV";
  if (rest.size() < 3 || kLevels.find(rest[0]) == kLevels.npos || rest.substr(1, 2) != " (") {
    return std::nullopt;
  }
  const std::size_t end = rest.find(") ");
  const std::size_t colon = rest.find(": ");
  if (end == rest.npos || colon == rest.npos || colon < end) return std::nullopt;
  const auto ms = controller::ParseWholeNumber(rest.substr(3, end - 3), 0, INT64_MAX / 2);
  if (!ms) return std::nullopt;
  line = rest.substr(colon + 2);
  if (const std::size_t colour = line.find('\x1b'); colour != line.npos) {
    line = line.substr(0, colour);
  }
  return fmt::format("{:.3f}", 1e-3 * static_cast<double>(*ms));
}

/// Takes the clock or date off that a program for serial ports or logs writes before its text.
std::optional<std::string> TakeClockBefore(std::string_view& line) {
  if (auto time_s = TakeLogTime(line)) return time_s;
  for (const std::string_view mark : {"->", " - ", "]", "|"}) {
    const std::size_t end = line.find(mark);
    if (end == std::string_view::npos) continue;
    std::string_view clock = Trimmed(line.substr(0, end));
    if (mark == "]" && clock.starts_with('[')) clock.remove_prefix(1);
    if (!SecondsOfText(clock)) continue;
    line.remove_prefix(end + mark.size());
    return std::string(clock);
  }
  return std::nullopt;
}

/// Label and value of each cell, such as `Thumb:300`; the clock before them has the label `time`.
/// None if a cell has no label.
std::optional<std::vector<std::pair<std::string, std::string>>> LabelledCells(
    std::string_view line) {
  std::vector<std::pair<std::string, std::string>> cells;
  if (const auto clock = TakeClockBefore(line)) cells.emplace_back("time", *clock);
  std::string text(Trimmed(line));
  for (char& letter : text)
    letter = letter == ',' || letter == ';' || letter == '\t' ? ' ' : letter;
  for (std::size_t colon = text.find(": "); colon != std::string::npos; colon = text.find(": ")) {
    text.erase(colon + 1, 1);
  }
  std::string_view rest = text;
  while (!Trimmed(rest).empty()) {
    const std::string_view cell = TakeCell(rest, ' ');
    const std::size_t mark = cell.find_first_of(":=");
    if (mark == 0 || mark == std::string_view::npos || !IsNumber(cell.substr(mark + 1)) ||
        std::isalpha(static_cast<unsigned char>(cell.front())) == 0) {
      return std::nullopt;
    }
    cells.emplace_back(cell.substr(0, mark), cell.substr(mark + 1));
  }
  return cells;
}

std::optional<TextForm> LabelledForm(const std::vector<std::string>& head) {
  // The most frequent names: the first line of a serial port may lack its beginning.
  std::map<Cells, std::size_t> fitting;
  for (const std::string& line : head) {
    const auto cells = LabelledCells(line);
    if (!cells || cells->empty()) continue;
    Cells names;
    for (const auto& [label, value] : *cells) names.push_back(label);
    ++fitting[names];
  }
  if (fitting.empty()) return std::nullopt;
  const auto most =
      std::ranges::max_element(fitting, {}, [](const auto& form) { return form.second; });
  if (most->second < 3 || 2 * most->second < head.size()) return std::nullopt;
  TextForm form{.kind = TextFormKind::kLabels};
  form.names = most->first;
  form.convert = [names = form.names](std::string_view line) -> std::optional<Cells> {
    const auto cells = LabelledCells(line);
    if (!cells || cells->size() != names.size()) return std::nullopt;
    Cells values;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if ((*cells)[i].first != names[i]) return std::nullopt;
      values.push_back((*cells)[i].second);
    }
    return values;
  };
  return form;
}

// --- A clock before the row
// ------------------------------------------------------------------------

/// The cells of a line behind `CLOCK ->`, the clock first. None without one.
std::optional<Cells> ClockedCells(std::string_view line) {
  const std::size_t arrow = line.find("->");
  std::string_view rest = line;
  const bool is_log = TakeLogTime(rest).has_value();
  if (arrow == std::string_view::npos && !line.starts_with('[') && !is_log) return std::nullopt;
  auto clock = TakeClockBefore(line);
  if (!clock && arrow != std::string_view::npos && IsNumber(line.substr(0, arrow))) {
    clock = std::string(Trimmed(line.substr(0, arrow)));  // seconds since the start
    line.remove_prefix(arrow + 2);
  }
  if (!clock) return std::nullopt;
  Cells cells = {std::move(*clock)};
  const char separator = SeparatorOf(Trimmed(line));
  for (const std::string_view cell : SplitCells(Trimmed(line), separator)) {
    cells.emplace_back(Trimmed(cell));
  }
  return cells;
}

bool AreNumbers(const Cells& cells) {
  return cells.size() > 1 && std::all_of(cells.begin() + 1, cells.end(), IsNumber);
}

/// Rows of a serial port behind the clock of the program that shows them.
std::optional<TextForm> ClockedForm(const std::vector<std::string>& head) {
  std::map<std::size_t, std::size_t> fitting;  // lines by the number of cells
  for (const std::string& line : head) {
    const auto cells = ClockedCells(line);
    if (cells && AreNumbers(*cells)) ++fitting[cells->size()];
  }
  if (fitting.empty()) return std::nullopt;
  const auto most =
      std::ranges::max_element(fitting, {}, [](const auto& width) { return width.second; });
  if (most->second < 3 || 2 * most->second < head.size()) return std::nullopt;
  TextForm form{.kind = TextFormKind::kClocked, .names = {"time"}};
  for (std::size_t i = 1; i < most->first; ++i) form.names.push_back(fmt::format("value_{}", i));
  for (const std::string& line : head) {  // of the first sketch's header, if one was printed
    const auto cells = ClockedCells(line);
    if (!cells || cells->size() != most->first) continue;
    if (!AreNumbers(*cells)) form.names = *cells;
    break;
  }
  form.names.front() = "time";
  form.convert = [width = most->first](std::string_view line) -> std::optional<Cells> {
    auto cells = ClockedCells(line);
    if (!cells || cells->size() != width || !AreNumbers(*cells)) return std::nullopt;
    return cells;
  };
  return form;
}

// --- Lists in the cells --------------------------------------------------------------------------

/// Cells between commas that are neither in quotes nor in brackets.
Cells CellsWithLists(std::string_view line) {
  Cells cells(1);
  int depth = 0;
  bool is_quoted = false;
  for (const char letter : line) {
    if (letter == '"') is_quoted = !is_quoted;
    if (letter == '[') ++depth;
    if (letter == ']') --depth;
    if (letter == ',' && depth <= 0 && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += letter;
    }
  }
  return cells;
}

/// The numbers of a cell `[1.5 2.5]`; none if it is no list.
std::optional<Cells> ListIn(std::string_view cell) {
  std::string text(Trimmed(Unquoted(Trimmed(cell))));
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return std::nullopt;
  for (char& letter : text) letter = letter == ',' || letter == '[' || letter == ']' ? ' ' : letter;
  Cells numbers;
  std::string_view rest = text;
  while (!Trimmed(rest).empty()) {
    const std::string_view number = TakeCell(rest, ' ');
    if (!IsNumber(number)) return std::nullopt;
    numbers.emplace_back(number);
  }
  return numbers;
}

/// A row without its lists; none if there is none in it.
std::optional<Cells> WithoutLists(std::string_view line, std::vector<std::size_t>* sizes) {
  Cells row;
  bool has_list = false;
  for (const std::string& cell : CellsWithLists(line)) {
    const auto numbers = ListIn(cell);
    has_list = has_list || numbers;
    if (sizes != nullptr) sizes->push_back(numbers ? numbers->size() : 0);
    if (numbers) {
      row.insert(row.end(), numbers->begin(), numbers->end());
    } else {
      row.emplace_back(Trimmed(cell));
    }
  }
  if (!has_list) return std::nullopt;
  return row;
}

std::optional<TextForm> ListForm(const std::vector<std::string>& head, const ListNames& known) {
  if (head.size() < 2) return std::nullopt;
  std::vector<std::size_t> sizes;
  const auto first = WithoutLists(head[1], &sizes);
  const Cells names = CellsWithLists(head[0]);
  if (!first || names.size() != sizes.size() || WithoutLists(head[0], nullptr)) return std::nullopt;
  TextForm form{.kind = TextFormKind::kLists, .has_header = true};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name(Unquoted(Trimmed(names[i])));
    if (sizes[i] == 0) form.names.push_back(name);
    const auto parts = known.find(name);
    const bool has_names = parts != known.end() && parts->second.size() == sizes[i];
    for (std::size_t k = 0; k < sizes[i]; ++k) {
      form.names.push_back(has_names ? fmt::format("{}.{}", name, parts->second[k])
                                     : fmt::format("{}_{}", name, k + 1));
    }
  }
  form.convert = [width = form.names.size()](std::string_view line) -> std::optional<Cells> {
    auto row = WithoutLists(line, nullptr);
    if (row && row->size() != width) row.reset();
    return row;
  };
  return form;
}

// --- JointState of ROS ---------------------------------------------------------------------------

/// Column of a joint's position in JointState.
std::string PositionName(const std::string& joint) {
  return joint + std::string(UnitOfJoint(joint, controller::kNaN, {}).suffix);
}

/// A row of the stamp, the frame, the names, and numbers for each name in up to three arrays.
struct JointStateRow {
  Cells columns = {"sec", "nanosec"};
  Cells numbers;
};

std::optional<JointStateRow> JointStateIn(std::string_view line) {
  const std::vector<std::string_view> cells = SplitCells(line, ',');
  constexpr std::size_t kStamp = 3;
  constexpr double kFirstStamp_s = 5e8;
  if (cells.size() < kStamp + 2 || !IsNumber(cells[0]) || !IsNumber(cells[1])) return std::nullopt;
  const double sec = *NumberOrMissing(Trimmed(cells[0]));
  const double nanosec = *NumberOrMissing(Trimmed(cells[1]));
  if (!(sec >= kFirstStamp_s && sec < 1e10 && nanosec >= 0.0 && nanosec < 1e9)) return std::nullopt;
  JointStateRow row;
  row.numbers = {std::string(Trimmed(cells[0])), std::string(Trimmed(cells[1]))};
  const auto is_empty = [&cells](std::size_t i) { return Trimmed(cells[i]).empty(); };
  Cells joints;
  std::size_t at = kStamp;
  for (; at < cells.size() && !IsNumber(cells[at]) && !is_empty(at); ++at) {
    joints.emplace_back(Unquoted(Trimmed(cells[at])));
  }
  for (const std::string part : {"", "_velocity", "_effort"}) {
    if (at < cells.size() && is_empty(at)) {  // an array without numbers
      ++at;
      continue;
    }
    for (std::size_t i = 0; i < joints.size() && at < cells.size(); ++i, ++at) {
      if (!IsNumber(cells[at])) return std::nullopt;
      row.columns.push_back(part.empty() ? PositionName(joints[i]) : joints[i] + part);
      row.numbers.emplace_back(Trimmed(cells[at]));
    }
  }
  const std::size_t numbers = row.numbers.size() - 2;
  if (at < cells.size() || numbers == 0 || numbers % joints.size() != 0) return std::nullopt;
  return row;
}

std::optional<TextForm> JointStateForm(const std::vector<std::string>& head) {
  if (head.size() < 2) return std::nullopt;
  const auto first = JointStateIn(head[0]);
  if (!first || !JointStateIn(head[1])) return std::nullopt;
  TextForm form{.kind = TextFormKind::kJointState, .names = first->columns};
  form.convert = [names = form.names](std::string_view line) -> std::optional<Cells> {
    const auto row = JointStateIn(line);
    if (!row || row->columns != names) return std::nullopt;
    return row->numbers;
  };
  return form;
}

// --- rostopic echo -p ----------------------------------------------------------------------------

constexpr std::string_view kName = "field.name";  // and its number

/// JointState of `rostopic echo -p`: `field.position0` has the name in the column `field.name0`.
std::optional<TextForm> RosEchoForm(const std::vector<std::string>& head) {
  if (head.size() < 2 || !head[0].starts_with("%time,")) return std::nullopt;
  const Cells header = CellsWithLists(head[0]);
  const Cells first = CellsWithLists(head[1]);
  if (header.size() != first.size()) return std::nullopt;
  TextForm form{.kind = TextFormKind::kJointState, .has_header = true};
  std::vector<std::size_t> kept;
  Cells joints;
  for (std::size_t c = 0; c < header.size(); ++c) {
    if (header[c].starts_with(kName)) joints.emplace_back(Trimmed(first[c]));
  }
  for (std::size_t c = 0; c < header.size(); ++c) {
    if (header[c].starts_with(kName)) continue;
    std::string name = header[c];
    for (const auto& [field, after] : {std::pair("field.position", ""),
                                       {"field.velocity", "_velocity"},
                                       {"field.effort", "_effort"}}) {
      const auto number = name.starts_with(field)
                              ? controller::ParseWholeNumber(
                                    std::string_view(name).substr(std::string_view(field).size()),
                                    0, std::max<std::ptrdiff_t>(std::ssize(joints), 1) - 1)
                              : std::nullopt;
      if (number && !joints.empty()) {
        name = *after == '\0' ? PositionName(joints[*number]) : joints[*number] + after;
      }
    }
    kept.push_back(c);
    form.names.push_back(std::move(name));
  }
  if (joints.empty()) return std::nullopt;
  form.convert = [header, first, kept](std::string_view line) -> std::optional<Cells> {
    const Cells cells = CellsWithLists(line);
    if (cells.size() != header.size()) return std::nullopt;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (header[c].starts_with(kName) && cells[c] != first[c]) return std::nullopt;
    }
    Cells row;
    for (const std::size_t c : kept) row.push_back(cells[c]);
    return row;
  };
  return form;
}

// --- Alpha encoding of opengloves ----------------------------------------------------------------

using AlphaPairs = std::map<char, std::string>;

/// `A123B456C789`: a letter and its number, each once, and letters of pressed buttons, which are
/// left out. Source: opengloves, AlphaEncoding: A to E are the fingers, F and G the joystick.
std::optional<AlphaPairs> AlphaCells(std::string_view line) {
  AlphaPairs cells;
  std::size_t i = 0;
  line = Trimmed(line);
  while (i < line.size()) {
    if (line[i] == '(') {  // (AB)123: splay of a finger
      const std::size_t end = line.find(')', i);
      if (end == std::string_view::npos) return std::nullopt;
      i = std::min(line.find_first_not_of("0123456789", end + 1), line.size());
      continue;
    }
    const char letter = line[i++];
    if (letter < 'A' || letter > 'Z') return std::nullopt;
    const std::size_t end = std::min(line.find_first_not_of("0123456789", i), line.size());
    if (end > i && !cells.emplace(letter, line.substr(i, end - i)).second) return std::nullopt;
    i = end;
  }
  return cells;
}

std::optional<TextForm> AlphaForm(const std::vector<std::string>& head) {
  static const std::map<char, std::string> kNames = {
      {'A', "thumb"},  {'B', "index"},      {'C', "middle"},     {'D', "ring"},
      {'E', "little"}, {'F', "joystick_x"}, {'G', "joystick_y"}, {'P', "trigger"}};
  // The most frequent letters: a line of a serial port may lack its end.
  std::map<std::string, std::size_t> fitting;
  for (const std::string& line : head) {
    const auto cells = AlphaCells(line);
    if (!cells || cells->size() < 2 || !cells->contains('A')) continue;
    std::string letters;
    for (const auto& [letter, value] : *cells) {
      if (kNames.contains(letter)) letters += letter;
    }
    ++fitting[letters];
  }
  if (fitting.empty()) return std::nullopt;
  const auto most =
      std::ranges::max_element(fitting, {}, [](const auto& form) { return form.second; });
  if (most->second < 3 || 2 * most->second < head.size()) return std::nullopt;
  const std::string& letters = most->first;
  TextForm form{.kind = TextFormKind::kAlpha};
  for (const char letter : letters) form.names.push_back(kNames.at(letter));
  form.convert = [letters](std::string_view line) -> std::optional<Cells> {
    const auto cells = AlphaCells(line);
    Cells row;
    for (const char letter : letters) {
      if (!cells || !cells->contains(letter)) return std::nullopt;
      row.push_back(cells->at(letter));
    }
    return row;
  };
  return form;
}

// --- A row per channel ---------------------------------------------------------------------------

constexpr std::size_t kMostChannels = 64;  // far more than any glove has

/// True for a first line with more numbers than a glove has sensors, and nothing else.
bool MayBeTurned(const std::vector<std::string>& head) {
  if (head.empty()) return false;
  const auto cells = SplitCells(head[0], SeparatorOf(head[0]));
  return cells.size() > kMostChannels &&
         std::ranges::all_of(cells.begin() + 1, cells.end(), IsNumber);
}

/// The text with a column per channel; the text itself if it has more rows than channels.
std::string Turned(std::string text) {
  std::vector<std::vector<std::string_view>> rows;
  for (const std::string_view line : SplitLines(text)) {
    if (Trimmed(line).empty() || Trimmed(line).front() == '#') continue;
    if (rows.size() == kMostChannels) return text;
    rows.push_back(SplitCells(line, SeparatorOf(line)));
    if (rows.back().size() != rows.front().size()) return text;
  }
  const std::size_t columns = rows.empty() ? 0 : rows.front().size();
  if (rows.size() < 2 || columns <= 2 * rows.size()) return text;
  const bool has_names = !IsNumber(rows[0][0]) && !Trimmed(rows[0][0]).empty();
  std::string turned;
  for (std::size_t c = 0; c < columns; ++c) {
    const bool is_zero = c == 0 && std::ranges::all_of(rows, [](const auto& row) {
                           return NumberOrMissing(Trimmed(row[0])) == 0.0;
                         });
    if (is_zero) continue;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      std::string cell(Trimmed(rows[r][c]));
      std::ranges::replace(cell, ',', '.');
      turned += (r > 0 ? "," : "") + (c == 0 && has_names ? std::string(Unquoted(cell)) : cell);
    }
    turned += '\n';
  }
  return turned;
}

// --- Sources -------------------------------------------------------------------------------------

/// The plain table, line by line.
class PlainText {
 public:
  PlainText(TextForm form, TextLines::Source source)
      : form_(std::move(form)), lines_("", std::move(source)) {
    text_ = CsvLine(form_.names);
    if (form_.has_header) NextRecord(lines_, record_);
  }

  std::size_t Read(char* buffer, std::size_t size) {
    while (given_ == text_.size()) {
      if (!NextRecord(lines_, record_)) return 0;
      const auto cells = form_.convert(record_);
      if (!cells) ++left_out_;
      // Before the first row a comment would be a line of names or units.
      const std::string comment = has_row_ ? fmt::format("# {}\n", record_) : "";
      text_ = cells ? CsvLine(*cells) : comment;
      has_row_ = has_row_ || cells;
      given_ = 0;
    }
    const std::size_t count = text_.copy(buffer, size, given_);
    given_ += count;
    return count;
  }
  const std::size_t& left_out() const { return left_out_; }

 private:
  TextForm form_;
  TextLines lines_;
  std::string record_;
  std::string text_;
  std::size_t given_ = 0;
  std::size_t left_out_ = 0;
  bool has_row_ = false;
};

std::vector<std::string> LinesOfHead(std::string_view head) {
  std::vector<std::string> found;
  TextLines lines("", TextSource(head));
  for (std::string line; found.size() < kHeadLines && NextRecord(lines, line);) {
    if (!Trimmed(line).empty()) found.push_back(line);
  }
  return found;
}

}  // namespace

std::optional<TextForm> FormOf(const std::vector<std::string>& head, const ListNames& known) {
  std::optional<TextForm> form = ListForm(head, known);
  for (const auto& find : {LabelledForm, ClockedForm, AlphaForm, RosEchoForm, JointStateForm}) {
    if (!form) form = find(head);
  }
  return form;
}

LiveTable PlainStream(const std::string& name, TextLines::Source source) {
  constexpr std::size_t kBlock = 4096;
  constexpr std::size_t kLongestHead = std::size_t{1} << 20;  // longer lines are refused
  constexpr std::ptrdiff_t kLinesOfTrc = 6;                   // up to the one behind X1, Y1 ..
  std::string head;
  const auto read_lines = [&](std::ptrdiff_t count) {
    for (std::size_t got = 1;
         got > 0 && head.size() < kLongestHead && std::ranges::count(head, '\n') < count;) {
      const std::size_t size = head.size();
      head.resize(size + kBlock);
      got = source(head.data() + size, kBlock);
      head.resize(size + got);
    }
    std::vector<std::string> lines = LinesOfHead(head.substr(0, head.rfind('\n') + 1));
    if (std::ssize(lines) > count) lines.resize(static_cast<std::size_t>(count));
    return lines;
  };
  const std::vector<std::string> first = read_lines(1);
  if (first.empty()) return {WithHead(std::move(head), std::move(source))};
  if (first[0].starts_with("PathFileType")) read_lines(kLinesOfTrc);
  if (IsTrc(head)) {
    const TrcHeader header = ReadTrcHeader(name, head);
    return {WithHead(header.names + head.substr(header.bytes), std::move(source))};
  }
  const bool has_labels = LabelledCells(first[0]) || ClockedCells(first[0]) ||
                          AlphaCells(first[0]).value_or(AlphaPairs()).size() > 1;
  std::optional<TextForm> form;
  if (has_labels || !IsRowOfNumbers(first[0])) form = FormOf(read_lines(has_labels ? 4 : 2));
  source = WithHead(std::move(head), std::move(source));
  if (!form) return {std::move(source)};
  const auto text = std::make_shared<PlainText>(std::move(*form), std::move(source));
  return {[text](char* buffer, std::size_t size) { return text->Read(buffer, size); },
          std::shared_ptr<const std::size_t>(text, &text->left_out())};
}

TextLines::Source PlainTable(TextLines::Source source, const ListNames& known) {
  constexpr std::size_t kMostHead = std::size_t{64} << 10;
  constexpr std::size_t kMostTurned = std::size_t{64} << 20;
  std::string head = BytesOf(source, kMostHead);
  const std::vector<std::string> lines = LinesOfHead(head);
  if (MayBeTurned(lines)) {
    head += BytesOf(source, kMostTurned);
    if (head.size() < kMostTurned) return WithHead(Turned(std::move(head)), nullptr);
    return WithHead(std::move(head), std::move(source));
  }
  if (auto form = FormOf(lines, known)) {
    const auto text =
        std::make_shared<PlainText>(std::move(*form), WithHead(std::move(head), std::move(source)));
    return [text](char* buffer, std::size_t size) { return text->Read(buffer, size); };
  }
  return WithHead(std::move(head), std::move(source));
}

}  // namespace gauntlet::sim
