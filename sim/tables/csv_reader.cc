#include "sim/tables/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "controller/assert.h"
#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/text.h"
#include "sim/tables/missing.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

/// True for two rows with texts and numbers in the same cells, at least one number: the upper one
/// names no columns.
bool HaveNumbersInTheSameCells(std::string_view upper, std::string_view lower, char separator) {
  const std::vector<std::string_view> above = SplitCells(upper, separator);
  const std::vector<std::string_view> below = SplitCells(lower, separator);
  const auto is_number = [separator](std::string_view cell) {
    return !Trimmed(cell).empty() && IsValue(cell, separator);
  };
  return std::ranges::any_of(above, is_number) &&
         std::ranges::equal(above, below, {}, is_number, is_number);
}

}  // namespace

CsvReader::CsvReader(std::string name, TableInput input, ProblemHandling handling,
                     Listener listener, int skipped_lines)
    : name_(std::move(name)),
      lines_(name_, std::holds_alternative<Source>(input) ? std::get<Source>(std::move(input))
                                                          : TextSource("")),
      handling_(handling),
      listener_(std::move(listener)) {
  if (auto* const stream = std::get_if<std::shared_ptr<TableStream>>(&input)) {
    stream_ = std::move(*stream);
    GAUNTLET_ASSERT(!stream_->is_begun());
    if (stream_->table().rows == 0) stream_->Extend();
    table_ = {stream_, &stream_->table()};
  } else if (auto* const table = std::get_if<std::shared_ptr<const Table>>(&input)) {
    table_ = std::move(*table);
  }
  if (table_) {
    UseTable(*table_);
    if (skipped_lines > 0) FailInRow(1, 1, "is no text, so it has no lines to skip");
    return;
  }
  lines_.Skip(skipped_lines);
  ReadFirstLine();
}

void CsvReader::UseTable(const Table& table) {
  header_ = table.names();
  column_count_ = header_.size();
  row_ = 1;
  if (table.rows == 0) FailInRow(1, 1, "the file holds no data");
  first_row_line_ = table.first_line;
  meanings_.assign(column_count_, Meaning::kNumber);
}

/// False at the end.
bool CsvReader::NextRowOfTable() {
  if (rows_read_ == table_->rows) {
    if (!stream_) return false;
    rows_before_ += std::exchange(rows_read_, 0);
    if (!stream_->Advance()) return false;
  }
  row_ = first_row_line_ + rows_before_ + rows_read_++;
  return true;
}

std::string CsvReader::TableCell(std::size_t column) const {
  const TableColumn& is = table_->columns[column];
  return is.texts.empty() ? fmt::format("{}", is.numbers[rows_read_ - 1])
                          : is.texts[rows_read_ - 1];
}

double CsvReader::TableNumber(std::size_t column) {
  const TableColumn& is = table_->columns[column];
  const bool is_number =
      meanings_[column] == Meaning::kNumber || meanings_[column] == Meaning::kTime;
  if (is_number && is.texts.empty() && std::isfinite(is.numbers[rows_read_ - 1])) {
    return is.numbers[rows_read_ - 1];
  }
  return meanings_[column] == Meaning::kIgnored ? kMissing : ValueOf(TableCell(column), column);
}

double CsvReader::ValueOf(std::string_view cell, std::size_t column) {
  switch (meanings_[column]) {
    case Meaning::kIgnored:
      return kMissing;
    case Meaning::kText:
      return TextNumber(cell);
    case Meaning::kKept:
      return is_kept_(Unquoted(cell)) ? 1.0 : 0.0;
    default:
      return Number(cell, column + 1);
  }
}

void CsvReader::Fail(std::size_t column, const std::string& problem) const {
  FailInRow(row_, column, problem);
}

void CsvReader::FailInRow(std::size_t row, std::size_t column, const std::string& problem) const {
  throw UserError({.place = fmt::format("{}:{}:{}", name(), std::max<std::size_t>(row, 1), column),
                   .problem = problem});
}

void CsvReader::Problem(RecordingProblem problem, std::size_t column, const std::string& message) {
  if (!GoesOn(handling_)) Fail(column, message);
  if (listener_) listener_(problem, row_);
}

std::vector<std::string> CsvReader::remarks() const {
  if (!table_) return {};
  std::vector<std::string> remarks = table_->remarks;
  if (table_->is_cut) {
    remarks.emplace_back("the file has no end; what is whole is read");
  }
  return remarks;
}

double CsvReader::share_read() const {
  if (!table_) return controller::kNaN;
  const std::uint64_t rows = stream_ ? stream_->all_rows() : table_->rows;
  if (rows == 0) return controller::kNaN;
  return static_cast<double>(rows_before_ + rows_read_) / static_cast<double>(rows);
}

std::string CsvReader::Quoted(std::string_view cell) const {
  constexpr std::size_t kLongest = 30;
  const bool has_letters =
      std::ranges::any_of(cell, [](unsigned char c) { return std::isalpha(c) != 0 || c >= 0x80; });
  const bool is_shown = !has_letters || (column_count_ > 1 && LooksLikeKey(Unquoted(cell)));
  return fmt::format("'{}'", is_shown ? OneLine(cell, kLongest) : "...");
}

/// The next one that is neither blank nor a comment.
bool CsvReader::NextLine(std::string_view& line) {
  while (lines_.Next(line)) {
    row_ = lines_.number();
    const std::string_view text = Trimmed(line);
    if (!text.empty() && text[0] != '#') return true;
  }
  return false;
}

void CsvReader::ReadFirstLine() {
  std::string_view line;
  if (!NextLine(line)) FailInRow(1, 1, "the file holds no data");
  separator_ = SeparatorOf(line);
  const std::string first(line);
  const std::vector<std::string_view> cells = SplitCells(first, separator_);
  column_count_ = cells.size();
  const std::size_t first_line = row_;
  bool is_row = std::ranges::all_of(cells, [this](auto cell) { return IsValue(cell, separator_); });
  if (!is_row && NextLine(line)) {
    is_row = HaveNumbersInTheSameCells(first, line, separator_);
    lines_.GiveBack({{std::string(line), row_}});
  }
  row_ = first_line;
  if (is_row) {
    first_row_line_ = row_;
    lines_.GiveBack({{first, row_}});
  } else {
    for (const std::string_view cell : cells) header_.emplace_back(Unquoted(cell));
    ReadFirstRowOfData();
  }
  meanings_.assign(column_count_, Meaning::kNumber);
}

void CsvReader::ReadFirstRowOfData() {
  const std::size_t header_line = row_;
  std::string_view line;
  if (!NextLine(line)) return;
  first_row_line_ = row_;
  row_ = header_line;  // where the reader stands, for messages, until the first row is asked for
  const std::vector<std::string_view> cells = SplitCells(line, separator_);
  const std::size_t given = cells.size();
  const bool is_short = given == header_.size() + 1 && !Trimmed(cells.back()).empty();
  lines_.GiveBack({{std::string(line), first_row_line_}});
  if (!is_short) return;
  Problem(RecordingProblem::kShortHeader, header_.size(),
          fmt::format("the header has {} names for {} values", header_.size(), given));
  const bool time_is_first = TimeScaleS(header_.front()).has_value();
  header_.insert(time_is_first ? header_.end() : header_.begin(), std::string());
  column_count_ = header_.size();
}

std::vector<std::string> CsvReader::CellsOf(std::string_view line) const {
  std::vector<std::string_view> cells = SplitCells(line, separator_);
  // A separator behind the last value begins no cell.
  if (cells.size() == column_count_ + 1 && Trimmed(cells.back()).empty()) cells.pop_back();
  std::vector<std::string> texts;
  for (const std::string_view cell : cells) texts.emplace_back(Unquoted(cell));
  return texts;
}

std::vector<std::vector<std::string>> CsvReader::FirstRows(std::size_t most, std::size_t last_line,
                                                           std::size_t most_bytes) {
  const std::size_t row = row_;
  if (table_) {
    std::vector<std::vector<std::string>> rows;
    const std::size_t read = rows_read_;
    for (std::size_t bytes = 0; rows.size() < most && bytes < most_bytes &&
                                (rows_read_ < table_->rows || (stream_ && stream_->Extend()));) {
      ++rows_read_;
      std::vector<std::string>& cells = rows.emplace_back();
      for (std::size_t c = 0; c < column_count_; ++c) {
        cells.push_back(TableCell(c));
        bytes += cells.back().size() + 1;
      }
    }
    rows_read_ = read;
    return rows;
  }
  std::vector<std::vector<std::string>> rows;
  std::vector<TextLine> read;
  std::string_view line;
  while (rows.size() < most && NextLine(line)) {
    read.push_back({std::string(line), row_});
    if (row_ > last_line) break;
    std::vector<std::string> cells = CellsOf(line);
    if (cells.size() == column_count_) rows.push_back(std::move(cells));
  }
  lines_.GiveBack(std::move(read));
  row_ = row;
  return rows;
}

void CsvReader::KeepRows(std::size_t column, std::function<bool(std::string_view text)> is_kept) {
  meanings_.at(column) = Meaning::kKept;
  kept_column_ = column;
  is_kept_ = std::move(is_kept);
}

bool CsvReader::NextRow(std::span<double> values) {
  while (ReadRow(values)) {
    if (!is_kept_ || values[kept_column_] != 0.0) return true;
  }
  return false;
}

bool CsvReader::ReadRow(std::span<double> values) {
  if (values.size() != column_count_) throw std::logic_error("no place for each value of a row");
  if (table_) {
    if (!NextRowOfTable()) return false;
    for (std::size_t c = 0; c < column_count_; ++c) values[c] = TableNumber(c);
    return true;
  }
  std::string_view line;
  if (!NextLine(line)) return false;
  ParseRow(line, values);
  return true;
}

bool CsvReader::NextRow(std::vector<std::string>& cells) {
  if (table_) {
    if (!NextRowOfTable()) return false;
    cells.resize(column_count_);
    for (std::size_t c = 0; c < column_count_; ++c) cells[c] = TableCell(c);
    return true;
  }
  std::string_view line;
  if (!NextLine(line)) return false;
  cells = CellsOf(line);
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
    values[column] = ValueOf(cell, column);
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

double CsvReader::TextNumber(std::string_view cell) {
  constexpr std::size_t kMostTexts = 4096;  // later ones have no number
  const std::string_view text = Unquoted(cell);
  const auto known = text_numbers_.find(text);
  if (known != text_numbers_.end()) return known->second;
  if (text.empty() || text_numbers_.size() == kMostTexts) return kMissing;
  return text_numbers_.emplace(text, static_cast<double>(text_numbers_.size())).first->second;
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

std::shared_ptr<const Table> WholeTable(const TableInput& input) {
  if (const auto* const table = std::get_if<std::shared_ptr<const Table>>(&input)) return *table;
  const auto* const stream = std::get_if<std::shared_ptr<TableStream>>(&input);
  if (stream == nullptr) return nullptr;
  GAUNTLET_ASSERT(!(*stream)->is_begun());
  while ((*stream)->Extend()) {
  }
  return {*stream, &(*stream)->table()};
}

Table TableOfText(CsvReader reader) {
  Table table{.columns = {}, .remarks = {}, .first_line = reader.first_row()};
  for (std::size_t c = 0; c < reader.column_count(); ++c) {
    table.columns.push_back({.name = c < reader.header().size() ? reader.header()[c] : ""});
  }
  std::vector<bool> has_texts(table.columns.size(), false);
  std::vector<std::string> cells;
  for (; reader.NextRow(cells); ++table.rows) {
    for (std::size_t c = 0; c < cells.size(); ++c) {
      std::string number = cells[c];
      if (reader.separator() != ',') std::ranges::replace(number, ',', '.');
      const std::optional<double> value = NumberOrMissing(number);
      if (!value && !cells[c].empty()) has_texts[c] = true;
      table.columns[c].numbers.push_back(value.value_or(kMissing));
      table.columns[c].texts.push_back(std::move(cells[c]));
    }
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (has_texts[c]) {
      table.columns[c].numbers.clear();
    } else {
      table.columns[c].texts.clear();
    }
  }
  return table;
}

Table TableOfText(CsvReader reader, std::optional<std::int64_t> rows, bool has_last_line_end) {
  Table table = TableOfText(std::move(reader));
  table.is_cut = rows > static_cast<std::int64_t>(table.rows) && !has_last_line_end;
  if (table.is_cut && table.rows > 0) {
    // Its last number may lack digits.
    --table.rows;
    for (TableColumn& column : table.columns) {
      if (column.texts.empty()) {
        column.numbers.pop_back();
      } else {
        column.texts.pop_back();
      }
    }
  }
  const auto found = static_cast<std::int64_t>(table.rows);
  if (rows && *rows != found) {
    table.remarks.push_back(
        fmt::format("the header says {} rows, the file has {}, which are read", *rows, found));
  }
  return table;
}

CsvReader::Source FileSource(const std::filesystem::path& path) {
  const std::shared_ptr<std::FILE> file(std::fopen(InputFile(path).c_str(), "rb"),
                                        [](std::FILE* open) {
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
