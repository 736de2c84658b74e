#include "sim/tables/table_pipe.h"

#include <algorithm>
#include <utility>

#include "controller/assert.h"
#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

constexpr std::uint64_t kMostTexts = std::uint64_t{1} << 20;
constexpr std::uint64_t kMostLetters = std::uint64_t{1} << 20;
constexpr std::size_t kBlockValues = std::size_t{1} << 15;

[[noreturn]] void Fail() { throw UserError("has a table that cannot be read"); }

}  // namespace

std::size_t RowsOfBlock(std::size_t columns) {
  return std::max<std::size_t>(kBlockValues / std::max<std::size_t>(columns, 1), 1);
}

void PipeWriter::Count(std::uint64_t count) {
  send_({reinterpret_cast<const char*>(&count), sizeof count});
}

void PipeWriter::Numbers(std::span<const double> numbers) {
  send_({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
}

void PipeWriter::Text(std::string_view text) {
  text = text.substr(0, kMostLetters);
  Count(text.size());
  send_(text);
}

void PipeWriter::Texts(const std::vector<std::string>& texts) {
  Count(texts.size());
  for (const std::string& text : texts) Text(text);
}

std::uint64_t PipeReader::Count(std::uint64_t most) {
  std::uint64_t count = 0;
  fill_({reinterpret_cast<char*>(&count), sizeof count});
  if (count > most) Fail();
  return count;
}

double PipeReader::Number() {
  double number = 0.0;
  Numbers({&number, 1});
  return number;
}

void PipeReader::Numbers(std::span<double> numbers) {
  fill_({reinterpret_cast<char*>(numbers.data()), numbers.size_bytes()});
}

std::string PipeReader::Text() {
  std::string text(Count(kMostLetters), '\0');
  fill_(text);
  return text;
}

std::vector<std::string> PipeReader::Texts() {
  std::vector<std::string> texts;
  for (std::uint64_t left = Count(kMostTexts); left > 0; --left) texts.push_back(Text());
  return texts;
}

TableWriter::TableWriter(PipeWriter& pipe, const std::vector<std::string>& names,
                         const std::vector<std::string>& remarks, std::size_t rows)
    : pipe_(pipe), columns_(names.size()) {
  pipe_.Texts(names);
  pipe_.Texts(remarks);
  pipe_.Count(rows);
}

void TableWriter::Rows(std::span<const double> values) {
  GAUNTLET_ASSERT(columns_ > 0 && values.size() % columns_ == 0);
  const std::size_t whole = RowsOfBlock(columns_) * columns_;
  while (!values.empty()) {
    const std::size_t part = std::min(whole - block_.size(), values.size());
    block_.insert(block_.end(), values.begin(), values.begin() + static_cast<std::ptrdiff_t>(part));
    values = values.subspan(part);
    if (block_.size() == whole) Flush();
  }
}

void TableWriter::Flush() {
  if (block_.empty()) return;
  pipe_.Count(block_.size() / columns_);
  pipe_.Numbers(block_);
  block_.clear();
}

void TableWriter::Finish(bool is_cut, std::span<const double> order) {
  Flush();
  pipe_.Count(0);
  pipe_.Count(is_cut ? 1 : 0);
  pipe_.Count(order.size());
  pipe_.Numbers(order);
}

TableReader::TableReader(PipeReader& pipe) : pipe_(pipe) {
  for (std::string& name : pipe_.Texts()) head_.columns.push_back({.name = std::move(name)});
  head_.remarks = pipe_.Texts();
  known_rows_ = pipe_.Count(UINT64_MAX);
}

bool TableReader::ReadBlock(Table& table) {
  const std::size_t columns = table.columns.size();
  const std::size_t rows = pipe_.Count(RowsOfBlock(columns));
  if (rows == 0) {
    table.is_cut = pipe_.Count(1) > 0;
    return false;
  }
  block_.resize(rows * columns);
  pipe_.Numbers(block_);
  for (std::size_t c = 0; c < columns; ++c) {
    std::vector<double>& numbers = table.columns[c].numbers;
    numbers.resize(table.rows + rows);
    for (std::size_t row = 0; row < rows; ++row) {
      numbers[table.rows + row] = block_[row * columns + c];
    }
  }
  table.rows += rows;
  return true;
}

std::vector<double> TableReader::ReadOrder(const Table& table) {
  std::vector<double> order(pipe_.Count(table.rows));
  pipe_.Numbers(order);
  return order;
}

Table ReadTable(PipeReader& pipe) {
  TableReader reader(pipe);
  Table table = reader.head();
  constexpr std::uint64_t kMostKnownRows = std::uint64_t{1} << 20;
  constexpr std::size_t kMostKnownValues = std::size_t{1} << 27;
  const std::size_t known_rows = std::min(reader.known_rows(), kMostKnownRows);
  if (known_rows * table.columns.size() <= kMostKnownValues) {
    for (TableColumn& column : table.columns) column.numbers.reserve(known_rows);
  }
  while (reader.ReadBlock(table)) {
  }
  const std::vector<double> order = reader.ReadOrder(table);
  if (order.empty()) return table;
  const auto is_row = [&](double place) { return place >= 0.0 && place < table.rows; };
  if (order.size() != table.rows || !std::ranges::all_of(order, is_row)) Fail();
  for (TableColumn& column : table.columns) {
    std::vector<double> numbers(order.size());
    std::ranges::transform(order, numbers.begin(),
                           [&](double place) { return column.numbers[place]; });
    column.numbers = std::move(numbers);
  }
  return table;
}

}  // namespace gauntlet::sim
