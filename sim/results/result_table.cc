#include "sim/results/result_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "controller/assert.h"
#include "sim/base/csv_line.h"
#include "sim/base/json.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <class... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

Json JsonOfValue(const ResultValue& value) {
  return std::visit(Overloaded{[](std::monostate) { return Json(); },
                               [](double number) { return NumberOrNull(number); },
                               [](const auto& other) { return Json(other); }},
                    value);
}

std::string CsvOfValue(const ResultValue& value) {
  return std::visit(Overloaded{[](std::monostate) { return std::string(); },
                               [](bool is_true) { return std::string(is_true ? "1" : "0"); },
                               [](std::int64_t number) { return fmt::to_string(number); },
                               [](double number) { return NumberOrNothing(number); },
                               [](const std::string& text) { return text; }},
                    value);
}

std::string TextOfValue(const ResultValue& value) {
  if (const double* number = std::get_if<double>(&value)) return Short(*number);
  return CsvOfValue(value);
}

bool IsThere(const ResultValue& value) { return !std::holds_alternative<std::monostate>(value); }

void AddToJson(const ResultColumn& column, const ResultCell& cell, Json& row) {
  GAUNTLET_ASSERT(cell.values.size() <= std::max<std::size_t>(1, column.parts.size()));
  for (std::size_t i = 0; i < cell.values.size(); ++i) {
    const std::string& name = column.parts.empty() ? column.key : column.parts[i].json;
    if (name.empty() || !IsThere(cell.values[i])) continue;
    Json& object = column.group.empty() ? row : row[column.group];
    Json& value = column.parts.size() > 1 ? object[column.key][name] : object[name];
    value = JsonOfValue(cell.values[i]);
  }
}

}  // namespace

ResultCell::ResultCell(ResultValue value) : text(TextOfValue(value)) {
  values.push_back(std::move(value));
}

ResultCell ResultCell::IfAny(const std::string& text) {
  return text.empty() ? ResultCell() : ResultCell(text);
}

ResultColumn ResultColumn::In(const std::string& object) && {
  group = object;
  return std::move(*this);
}

ResultColumn ResultColumn::Words() && {
  is_words = true;
  return std::move(*this);
}

ResultColumn ForPeople(const std::string& heading, const std::string& unit) {
  return {"", heading, unit};
}
ResultColumn OnlyInCsv(const std::string& key) { return {key, "", "", {{"", key}}}; }
ResultColumn OnlyInJson(const std::string& key) { return {key, "", "", {{key, ""}}}; }

Json JsonOf(const std::vector<ResultColumn>& columns, const ResultRow& row) {
  GAUNTLET_ASSERT(row.size() == columns.size());
  Json object = Json::object();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!columns[c].key.empty()) AddToJson(columns[c], row[c], object);
  }
  return object;
}

Json JsonOf(const ResultTable& table) {
  Json rows = Json::array();
  for (const ResultRow& row : table.rows) rows.push_back(JsonOf(table.columns, row));
  return rows;
}

std::string CsvHead(const std::vector<ResultColumn>& columns) {
  std::vector<std::string> names;
  for (const ResultColumn& column : columns) {
    if (column.parts.empty() && !column.key.empty()) names.push_back(column.key);
    for (const ResultPart& part : column.parts) {
      if (!part.csv.empty()) names.push_back(part.csv);
    }
  }
  return CsvLine(names);
}

std::string CsvRow(const std::vector<ResultColumn>& columns, const ResultRow& row) {
  GAUNTLET_ASSERT(row.size() == columns.size());
  std::vector<std::string> fields;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::string& key = columns[c].key;
    const std::vector<ResultPart>& parts = columns[c].parts;
    const std::vector<ResultValue>& values = row[c].values;
    if (parts.empty() && !key.empty()) {
      fields.push_back(values.empty() ? "" : CsvOfValue(values[0]));
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].csv.empty()) continue;
      fields.push_back(i < values.size() ? CsvOfValue(values[i]) : "");
    }
  }
  return CsvLine(fields);
}

std::string CsvOf(const ResultTable& table) {
  std::string text = CsvHead(table.columns);
  for (const ResultRow& row : table.rows) text += CsvRow(table.columns, row);
  return text;
}

}  // namespace gauntlet::sim
