#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gauntlet::sim {

class Json;

/// A value of a result as files have it. std::monostate: there is none. JSON leaves it out, and has
/// null for a number that is not finite; a CSV field is empty in both cases.
using ResultValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

/// How files call one of the values of a cell; an empty name: they do not have it.
struct ResultPart {
  std::string json;  // within the object of the column; a column of one part has no object
  std::string csv;   // the whole name of its column
};

/// A column of a result, described once: the terminal's table, that of a page, CSV and JSON follow.
struct ResultColumn {
  std::string key;      // in JSON; empty: people only
  std::string heading;  // for people; empty: files only
  std::string unit;
  std::vector<ResultPart> parts;  // empty: one value, of which `key` is the name
  std::string group;              // the object of JSON that holds the column
  bool is_words = false;          // on the left of its place in a table

  // NOLINTNEXTLINE(google-explicit-constructor): a table is read more easily without its name
  ResultColumn(std::string its_key, std::string its_heading = {}, std::string its_unit = {},
               std::vector<ResultPart> its_parts = {})
      : key(std::move(its_key)),
        heading(std::move(its_heading)),
        unit(std::move(its_unit)),
        parts(std::move(its_parts)) {}

  ResultColumn In(const std::string& object) &&;  // of JSON
  ResultColumn Words() &&;
};

/// A column that people alone see.
ResultColumn ForPeople(const std::string& heading, const std::string& unit = {});

/// Places at which a text for people may be broken: at kBreak it always is, at kSoftBreak in a
/// table that would be too wide else.
inline constexpr char kBreak = '\n';
inline constexpr char kSoftBreak = '\v';

/// One row's entry in a column.
struct ResultCell {
  std::vector<ResultValue> values = {};  // one per part of the column
  std::string text = {};                 // for people
  char mark = ' ';  // behind a number, colour of a word: * good, ! look at it, ~ undecided
  std::optional<std::uint8_t> terminal_colour = {};  // of a name; of the terminal's 256 (xterm)

  ResultCell() = default;
  ResultCell(std::vector<ResultValue> parts, std::string shown, char its_mark = ' ')
      : values(std::move(parts)), text(std::move(shown)), mark(its_mark) {}
  /// One value, which is its own text; a number has three significant digits for people.
  explicit ResultCell(ResultValue value);
  /// Cell that people alone see.
  static ResultCell Text(std::string_view shown) { return {{}, std::string(shown)}; }
  /// Left out where it is empty.
  static ResultCell IfAny(const std::string& text);
};

using ResultRow = std::vector<ResultCell>;

/// Rows of which each has a cell per column.
struct ResultTable {
  std::vector<ResultColumn> columns;
  std::vector<ResultRow> rows = {};
  std::size_t names = 1;  // so many columns, of those that people see, are the name of a row
};

/// A column of one value in files of one kind alone.
ResultColumn OnlyInCsv(const std::string& key);
ResultColumn OnlyInJson(const std::string& key);

/// A row as an object: {"controller": "raw", "scores": {"delay_ms": {"mean": 3.1}}}.
Json JsonOf(const std::vector<ResultColumn>& columns, const ResultRow& row);
/// All rows as an array.
Json JsonOf(const ResultTable& table);

/// The head and a row of a CSV table, with the end of the line.
std::string CsvHead(const std::vector<ResultColumn>& columns);
std::string CsvRow(const std::vector<ResultColumn>& columns, const ResultRow& row);
std::string CsvOf(const ResultTable& table);

}  // namespace gauntlet::sim
