#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/tables/csv_reader.h"
#include "sim/tables/table.h"
#include "sim/tables/table_pipe.h"
#include "sim/tables/text_lines.h"

namespace gauntlet::test {

/// Stands for a remark in TextOf().
inline std::string RemarkLine(const std::string& remark) { return fmt::format("# {}\n", remark); }

/// A table as text: names, and a line for each row, with the remarks behind the second one. A text
/// as it is, a stream to its end.
inline std::string TextOf(const sim::TableInput& input) {
  const std::shared_ptr<const sim::Table> table = sim::WholeTable(input);
  if (!table) return sim::BytesOf(std::get<sim::CsvReader::Source>(input));
  std::string text = fmt::format("{}\n", fmt::join(table->names(), ","));
  for (std::size_t row = 0; row < table->rows; ++row) {
    const char* comma = "";
    for (const sim::TableColumn& column : table->columns) {
      text += comma;
      text +=
          column.texts.empty() ? fmt::format("{}", column.numbers.at(row)) : column.texts.at(row);
      comma = ",";
    }
    text += '\n';
    if (row != 1) continue;
    for (const std::string& remark : table->remarks) text += RemarkLine(remark);
  }
  return text;
}

/// The table that `write` writes into a pipe.
template <class Write>
std::string TextFromPipe(const Write& write) {
  std::string bytes;
  sim::PipeWriter writer(
      [&bytes](std::span<const char> part) { bytes.append(part.begin(), part.end()); });
  write(writer);
  std::size_t read = 0;
  sim::PipeReader reader([&](std::span<char> part) {
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(read), part.size(), part.begin());
    read += part.size();
  });
  return TextOf(std::make_shared<const sim::Table>(sim::ReadTable(reader)));
}

}  // namespace gauntlet::test
