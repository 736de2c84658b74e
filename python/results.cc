#include "python/results.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <type_traits>
#include <variant>

#include "sim/results/html_text.h"

namespace gauntlet::python {
namespace {

namespace py = pybind11;

py::object ObjectOf(const sim::ResultValue& value) {
  return std::visit(
      [](const auto& held) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) {
          return py::none();
        } else {
          return py::cast(held);
        }
      },
      value);
}

/// {"columns": [(key, heading, unit)], "rows": [{..}], "text": .., "html": ..}: rows have the names
/// and values of CSV; None for what is not there.
py::dict DictOf(const sim::ResultTable& table) {
  py::list columns;
  for (const sim::ResultColumn& column : table.columns) {
    columns.append(py::make_tuple(column.key, column.heading, column.unit));
  }
  py::list rows;
  for (const sim::ResultRow& cells : table.rows) {
    py::dict row;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const sim::ResultColumn& column = table.columns[c];
      if (column.key.empty() && column.parts.empty()) continue;
      for (std::size_t part = 0; part < std::max<std::size_t>(column.parts.size(), 1); ++part) {
        const std::string& name = column.parts.empty() ? column.key : column.parts[part].csv;
        if (name.empty()) continue;
        row[py::str(name)] =
            part < cells[c].values.size() ? ObjectOf(cells[c].values[part]) : py::none();
      }
    }
    rows.append(row);
  }
  py::dict dict;
  dict["columns"] = columns;
  dict["rows"] = rows;
  dict["text"] = sim::TextOf(table, sim::TerminalStyle::Unlimited());
  dict["html"] = sim::HtmlOf(table);
  return dict;
}

}  // namespace

void AddText(const sim::ResultText& result, const sim::ResultText& verbose, py::dict& dict) {
  dict["text"] = sim::TextOf(result, {});
  dict["html"] = sim::HtmlOf(result);
  py::list tables;
  for (const auto& part : verbose) {
    if (const auto* table = std::get_if<sim::ResultTable>(&part)) tables.append(DictOf(*table));
  }
  dict["tables"] = tables;
}

}  // namespace gauntlet::python
