#include "sim/recordings/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/recordings/missing.h"
#include "sim/recordings/time_columns.h"
#include "sim/recordings/time_text.h"

namespace gauntlet::sim {
namespace {

/// A line whose texts in quotes are no more than quotes: separators in them separate nothing.
std::string OutsideQuotes(std::string_view line) {
  std::string outside;
  bool quoted = false;
  for (const char c : line) {
    quoted = quoted != (c == '"');
    if (!quoted || c == '"') outside += c;
  }
  return quoted ? std::string(line) : outside;  // one that does not close is a letter
}

/// True for all that may stand where a number is expected, a missing value included.
bool LooksLikeNumber(std::string_view cell, bool decimal_comma) {
  std::string text(Unquoted(cell));
  if (decimal_comma) std::ranges::replace(text, ',', '.');
  return NumberOrMissing(text).has_value();
}

}  // namespace

CsvReader::CsvReader(std::string name, Source source, ProblemHandling handling, Listener listener,
                     int skipped_lines)
    : name_(std::move(name)),
      source_(std::move(source)),
      handling_(handling),
      listener_(std::move(listener)),
      buffer_(std::size_t{1} << 16) {
  ReadFirstLine(skipped_lines);
}

void CsvReader::Fail(std::size_t column, const std::string& problem) const {
  FailInRow(row_, column, problem);
}

void CsvReader::FailInRow(std::size_t row, std::size_t column, const std::string& problem) const {
  throw UserError({.place = fmt::format("{}:{}:{}", name_, std::max<std::size_t>(row, 1), column),
                   .problem = problem});
}

void CsvReader::Problem(RecordingProblem problem, std::size_t column, const std::string& message) {
  if (handling_ != ProblemHandling::kRepair) Fail(column, message);
  if (listener_) listener_(problem, row_);
}

std::string CsvReader::Quoted(std::string_view cell) const {
  constexpr std::size_t kLongest = 30;
  const bool has_letters =
      std::ranges::any_of(cell, [](unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; });
  const bool is_shown = !has_letters || (column_count_ > 1 && LooksLikeKey(Unquoted(cell)));
  return fmt::format("'{}'", is_shown ? OneLine(cell, kLongest) : "...");
}

void CsvReader::Refill() {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) {
    if (buffer_.size() >= kLongestLine) {
      ++row_;
      Fail(1, LineTooLong());
    }
    buffer_.resize(buffer_.size() * 2);
  }
  const std::size_t got = source_(buffer_.data() + end_, buffer_.size() - end_);
  if (got == 0) source_is_empty_ = true;
  end_ += got;
}

bool CsvReader::NextLine(std::string_view& line) {
  std::size_t searched = 0;
  for (;;) {
    const char* start = buffer_.data() + begin_;
    const std::size_t size = end_ - begin_;
    const void* found = std::memchr(start + searched, '\n', size - searched);
    if (found != nullptr) {
      line = {start, static_cast<const char*>(found)};
      begin_ += line.size() + 1;
      break;
    }
    if (source_is_empty_) {
      if (size == 0) return false;
      line = {start, size};
      begin_ = end_;
      break;
    }
    searched = size;
    Refill();
  }
  ++row_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return true;
}

bool CsvReader::NextUsefulLine(std::string_view& line) {
  while (NextLine(line)) {
    const std::string_view text = Trimmed(line);
    if (!text.empty() && text[0] != '#') return true;
  }
  return false;
}

void CsvReader::ReadFirstLine(int skipped_lines) {
  std::string_view line;
  bool found = NextLine(line);
  for (int skipped = 0; found && skipped < skipped_lines; ++skipped) found = NextLine(line);
  line = WithoutByteOrderMark(line);
  if (!found || Trimmed(line).empty() || Trimmed(line)[0] == '#') found = NextUsefulLine(line);
  if (!found) {
    row_ = 0;
    Fail(1, "the file holds no data");
  }
  separator_ = SeparatorOf(line);
  const bool decimal_comma = separator_ != ',';
  bool is_header = false;
  for (const std::string_view cell : SplitCells(line, separator_)) {
    header_.emplace_back(Unquoted(cell));
    is_header = is_header || !(LooksLikeNumber(cell, decimal_comma) || SecondsOfText(cell));
  }
  column_count_ = header_.size();
  if (is_header) {
    ReadFirstRowOfData();
  } else {
    header_.clear();
    has_first_row_ = true;
    first_row_ = line;
    first_row_line_ = row_;
  }
  meanings_.assign(column_count_, Meaning::kNumber);
}

void CsvReader::ReadFirstRowOfData() {
  const std::size_t header_line = row_;
  std::string_view line;
  if (!NextUsefulLine(line)) return;
  has_first_row_ = true;
  first_row_ = line;
  first_row_line_ = row_;
  row_ = header_line;  // where the reader stands, for messages, until the first row is asked for
  const std::vector<std::string_view> cells = SplitCells(line, separator_);
  if (cells.size() != header_.size() + 1 || Trimmed(cells.back()).empty()) return;
  Problem(RecordingProblem::kShortHeader, header_.size(),
          fmt::format("the header has {} names for {} values", header_.size(), cells.size()));
  const bool time_is_first = TimeScaleS(header_.front()).has_value();
  header_.insert(time_is_first ? header_.end() : header_.begin(), std::string());
  column_count_ = header_.size();
}

bool CsvReader::NextLineOfData(std::string_view& line) {
  if (!has_first_row_) return NextUsefulLine(line);
  has_first_row_ = false;
  row_ = first_row_line_;
  line = first_row_;
  return true;
}

bool CsvReader::NextRow(std::span<double> values) {
  std::string_view line;
  if (!NextLineOfData(line)) return false;
  ParseRow(line, values);
  return true;
}

bool CsvReader::NextRow(std::vector<std::string>& cells) {
  std::string_view line;
  if (!NextLineOfData(line)) return false;
  cells.clear();
  for (const std::string_view cell : SplitCells(line, separator_))
    cells.emplace_back(Unquoted(cell));
  if (cells.size() != column_count_) {
    Problem(cells.size() < column_count_ ? RecordingProblem::kTruncatedRow
                                         : RecordingProblem::kRowTooLong,
            cells.size(), fmt::format("the row has {} of {} values", cells.size(), column_count_));
    cells.resize(column_count_);
  }
  return true;
}

void CsvReader::ParseRow(std::string_view line, std::span<double> values) {
  const char* const end = line.data() + line.size();
  std::string_view rest = line;
  std::size_t column = 0;
  bool more = true;
  for (; column < column_count_ && more; ++column) {
    double value;
    const char* const behind = controller::ReadNumber(rest.data(), end, value);
    if (meanings_[column] == Meaning::kNumber && behind != nullptr && separator_ != ' ' &&
        (behind == end || *behind == separator_)) {
      values[column] = value;
      more = behind != end;
      rest = {behind + (more ? 1 : 0), end};
      continue;
    }
    // Everything that is not a plain number between separators: rare, so clarity over speed.
    const std::string_view cell = TakeCell(rest, separator_);
    more = separator_ == ' ' ? !rest.empty() : cell.data() + cell.size() != end;
    values[column] = meanings_[column] == Meaning::kIgnored ? kMissing : Number(cell, column + 1);
  }
  if (column < column_count_) {
    Problem(RecordingProblem::kTruncatedRow, column,
            fmt::format("the row has {} of {} values", column, column_count_));
    for (; column < column_count_; ++column) values[column] = kMissing;
  } else if (more && !Trimmed(rest).empty()) {
    Problem(RecordingProblem::kRowTooLong, column_count_ + 1,
            fmt::format("the row has more than {} values", column_count_));
  }
}

double CsvReader::Number(std::string_view cell, std::size_t column) {
  std::string text(Unquoted(cell).substr(0, 64));
  if (separator_ != ',') std::ranges::replace(text, ',', '.');
  if (text.empty()) {
    if (handling_ != ProblemHandling::kAllowMissing) {
      Problem(RecordingProblem::kMissingValue, column, "the value is missing");
    }
    return kMissing;
  }
  std::optional<double> value = NumberOrMissing(text);
  if (!value && meanings_[column - 1] == Meaning::kTime) {
    value = SecondsOfText(text);
    if (!value) {
      Problem(RecordingProblem::kNoTime, column, Quoted(cell) + " is neither a date nor a clock");
      return kMissing;
    }
  }
  if (!value) {
    Problem(RecordingProblem::kNotANumber, column, Quoted(cell) + " is not a number");
    return kMissing;
  }
  if (std::isnan(*value)) {
    if (handling_ != ProblemHandling::kAllowMissing) {
      Problem(RecordingProblem::kMissingValue, column,
              fmt::format("the value is missing ({})", text));
    }
    return kMissing;
  }
  if (std::isinf(*value)) {
    Problem(RecordingProblem::kNotFinite, column, Quoted(cell) + " is not a finite number");
    return kMissing;
  }
  return *value;
}

char SeparatorOf(std::string_view text) {
  const std::string line = OutsideQuotes(text);
  for (const char candidate : {';', '\t'}) {
    if (line.find(candidate) != std::string_view::npos) return candidate;
  }
  const bool has_blank = Trimmed(line).find(' ') != std::string_view::npos;
  if (line.find(',') == std::string_view::npos) return has_blank ? ' ' : ',';
  if (!has_blank) return ',';
  const std::vector<std::string_view> cells = SplitCells(line, ' ');
  const auto is_decimal = [](std::string_view cell) {
    return !cell.starts_with(',') && !cell.ends_with(',') && LooksLikeNumber(cell, true);
  };
  return std::ranges::all_of(cells, is_decimal) ? ' ' : ',';
}

CsvReader::Source FileSource(const std::filesystem::path& path) {
  const std::shared_ptr<std::FILE> file(
      std::fopen(InputFile(path).c_str(), "rb"), [](std::FILE* open) {
        if (open != nullptr) std::fclose(open);
      });
  if (file == nullptr) {
    throw UserError({.place = path.string(),
                     .problem = fmt::format("cannot be read: {}", std::strerror(errno))});
  }
  std::setvbuf(file.get(), nullptr, _IONBF, 0);  // the reader has a buffer of its own
  return [file](char* buffer, std::size_t size) { return std::fread(buffer, 1, size, file.get()); };
}

CsvReader::Source TextSource(std::string_view text) {
  return [text](char* buffer, std::size_t size) mutable {
    const std::size_t count = std::min(size, text.size());
    std::memcpy(buffer, text.data(), count);
    text.remove_prefix(count);
    return count;
  };
}

}  // namespace gauntlet::sim
