#include "sim/results/table_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace gauntlet::sim {
namespace {

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Rows of a sweep: what a cell is called, settings, scores.
ResultTable Table() {
  ResultTable table{
      .columns = {ForPeople("cell"), ForPeople("controller")}, .rows = {}, .names = 2};
  for (int c = 0; c < 7; ++c) {
    table.columns.push_back(ForPeople(fmt::format("setting_number_{}", c)));
  }
  for (int r = 0; r < 3; ++r) {
    ResultRow& row = table.rows.emplace_back();
    row = {ResultCell(std::int64_t{100 + r}), ResultCell("tuned_kalman")};
    for (int c = 0; c < 7; ++c) row.emplace_back(fmt::format("value_{}_{}", r, c));
  }
  return table;
}

TEST(TextOf, IsInOnePieceWhereItFits) {
  const std::string whole = TextOf(Table(), TerminalStyle::Unlimited());
  EXPECT_EQ(Lines(whole).size(), 4u);
  EXPECT_EQ(TextOf(Table(), {.table_width = Width(Lines(whole)[0])}), whole);
  EXPECT_NE(TextOf(Table(), {.table_width = Width(Lines(whole)[0]) - 1}), whole);
}

TEST(TextOf, IsInPiecesWithTheNamesAgainWhereItDoesNotFit) {
  for (const std::size_t width : {40, 60, 80, 100}) {
    const std::string text = TextOf(Table(), {.table_width = width});
    for (const std::string& line : Lines(text)) EXPECT_LE(Width(line), width) << line;
    const ResultTable table = Table();
    for (std::size_t c = 2; c < table.columns.size(); ++c) {
      std::vector<std::string> cells = {table.columns[c].heading};
      for (const ResultRow& row : table.rows) cells.push_back(row[c].text);
      for (const std::string& cell : cells) {
        const std::size_t place = text.find(cell);
        ASSERT_NE(place, std::string::npos) << cell;
        EXPECT_EQ(text.find(cell, place + 1), std::string::npos) << "twice: " << cell;
      }
    }
    std::size_t names = 0;
    std::size_t heads = 0;
    for (const std::string& line : Lines(text)) {
      names += line.starts_with("101   tuned_kalman") ? 1 : 0;
      heads += line.starts_with("cell  controller") ? 1 : 0;
    }
    EXPECT_GT(heads, 1u);
    EXPECT_EQ(names, heads);
  }
}

}  // namespace
}  // namespace gauntlet::sim
