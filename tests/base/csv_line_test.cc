#include "sim/base/csv_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

TEST(SplitCells, GivesOneCellMoreThanThereAreSeparators) {
  EXPECT_THAT(SplitCells(""), ElementsAre(""));
  EXPECT_THAT(SplitCells("a"), ElementsAre("a"));
  EXPECT_THAT(SplitCells(",a,,b "), ElementsAre("", "a", "", "b "));
  EXPECT_THAT(SplitCells("a,"), ElementsAre("a", ""));
  EXPECT_THAT(SplitCells("0,5;1", ';'), ElementsAre("0,5", "1"));
}

TEST(SplitCells, LeavesSeparatorsInQuotes) {
  EXPECT_THAT(SplitCells("0,\"fist, slow\",1"), ElementsAre("0", "\"fist, slow\"", "1"));
  EXPECT_THAT(SplitCells(" \"a;\" ;;\"b\"\r", ';'), ElementsAre(" \"a;\" ", "", "\"b\"\r"));
  EXPECT_THAT(SplitCells("\"say \"\"a, b\"\"\",c"), ElementsAre("\"say \"\"a, b\"\"\"", "c"));
  EXPECT_THAT(SplitCells("\"\",\",\","), ElementsAre("\"\"", "\",\"", ""));
  // What does not close, or goes on behind it, is no quote: an inch, a name.
  EXPECT_THAT(SplitCells("5\",\"a,b"), ElementsAre("5\"", "\"a", "b"));
  EXPECT_THAT(SplitCells("\"a\" b,c"), ElementsAre("\"a\" b", "c"));
  EXPECT_THAT(SplitLines("\"a\nb\",c\n"), ElementsAre("\"a", "b\",c"));
}

TEST(SplitCells, TakesAnyBlanksAsOneSeparator) {
  EXPECT_THAT(SplitCells("  1 \t -2  3 ", ' '), ElementsAre("1", "-2", "3"));
}

TEST(TakeCell, LeavesWhatIsBehindTheSeparator) {
  std::string_view rest = "1,2,";
  EXPECT_EQ(TakeCell(rest, ','), "1");
  EXPECT_EQ(rest, "2,");
  EXPECT_EQ(TakeCell(rest, ','), "2");
  EXPECT_EQ(TakeCell(rest, ','), "");
  EXPECT_EQ(rest, "");
}

TEST(SplitLines, TakesLinesOfSpreadsheets) {
  EXPECT_THAT(SplitLines("\xEF\xBB\xBFk,a\r\n\r\n0,1"), ElementsAre("k,a", "", "0,1"));
  EXPECT_THAT(SplitLines(""), ElementsAre());
}

TEST(Unquoted, TakesOnePairOfEqualQuotesAway) {
  EXPECT_EQ(Unquoted(" \"a b\"\r"), "a b");
  EXPECT_EQ(Unquoted("'a'"), "a");
  EXPECT_EQ(Unquoted("\"a'"), "\"a'");
  EXPECT_EQ(Unquoted("\""), "\"");
}

TEST(CsvLine, ReadsBackWhatWasWritten) {
  const std::vector<std::string> cells = {"a", "", "b,c", "say \"no\"", " d "};
  EXPECT_EQ(CsvLine(cells), "a,,\"b,c\",\"say \"\"no\"\"\", d \n");
  std::string_view line = "a,,\"b,c\",\"say \"\"no\"\"\", d ";
  EXPECT_EQ(SplitCells(line).size(), cells.size());
  EXPECT_EQ(CsvLine({}), "\n");
  EXPECT_EQ(NumberOrNothing(0.1), "0.1");
  EXPECT_EQ(NumberOrNothing(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(NumberOrNothing(std::nan("")), "");
}

}  // namespace
}  // namespace gauntlet::sim
