#include "sim/report/table_text.h"

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
std::vector<std::vector<std::string>> Rows() {
  std::vector<std::vector<std::string>> rows = {{"cell", "controller"}};
  for (int c = 0; c < 7; ++c) rows[0].push_back("setting_number_" + std::to_string(c));
  for (int r = 0; r < 3; ++r) {
    std::vector<std::string>& row = rows.emplace_back();
    row = {std::to_string(100 + r), "tuned_kalman"};
    for (int c = 0; c < 7; ++c) row.push_back(fmt::format("value_{}_{}", r, c));
  }
  return rows;
}

TEST(AlignedTable, IsInOnePieceWhereItFits) {
  const std::string whole = AlignedTable(Rows());
  EXPECT_EQ(AlignedTable(Rows(), TerminalStyle::Unlimited(), 2), whole);
  EXPECT_EQ(AlignedTable(Rows(), {.table_width = Width(Lines(whole)[0])}, 2), whole);
}

TEST(AlignedTable, IsInPiecesWithTheNamesAgainWhereItDoesNotFit) {
  for (const std::size_t width : {40, 60, 80, 100}) {
    const std::string text = AlignedTable(Rows(), {.table_width = width}, 2);
    for (const std::string& line : Lines(text)) EXPECT_LE(Width(line), width) << line;
    const auto rows = Rows();
    for (std::size_t c = 2; c < rows[0].size(); ++c) {
      for (const auto& row : rows) {
        const std::size_t place = text.find(row[c]);
        ASSERT_NE(place, std::string::npos) << row[c];
        EXPECT_EQ(text.find(row[c], place + 1), std::string::npos) << "twice: " << row[c];
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
