// Tables whose columns have types, and their way through a pipe.
#include "sim/tables/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/table_layout.h"
#include "sim/tables/table_pipe.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsNan;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::shared_ptr<const Table> Mixed() {
  Table table{.columns = {}, .rows = 3, .remarks = {"made here"}};
  table.columns.push_back({.name = "time", .texts = {"00:00:01", "00:00:02.5", "late"}});
  table.columns.push_back({.name = "a", .numbers = {0.1, std::nan(""), kInfinity}});
  table.columns.push_back({.name = "hand", .texts = {"left", "right", "left"}});
  return std::make_shared<const Table>(std::move(table));
}

TEST(CsvReader, OfATableGivesNumbersAndReportsWhatIsNone) {
  std::vector<std::pair<RecordingProblem, std::size_t>> problems;
  CsvReader reader(
      "in", Mixed(), ProblemHandling::kRepair,
      [&](RecordingProblem problem, std::size_t row) { problems.emplace_back(problem, row); });
  EXPECT_THAT(reader.header(), ElementsAre("time", "a", "hand"));
  EXPECT_THAT(reader.remarks(), ElementsAre("made here"));
  reader.ReadAsTime(0);
  reader.ReadAsTexts(2);
  std::vector<double> row(3);
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row, ElementsAre(1.0, 0.1, 0.0));
  EXPECT_EQ(reader.row(), 2U);
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row, ElementsAre(2.5, IsNan(), 1.0));
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row, ElementsAre(IsNan(), IsNan(), 0.0));
  EXPECT_FALSE(reader.NextRow(row));
  EXPECT_EQ(problems, (std::vector<std::pair<RecordingProblem, std::size_t>>{
                          {RecordingProblem::kMissingValue, 3},
                          {RecordingProblem::kNoTime, 4},
                          {RecordingProblem::kNotFinite, 4}}));
}

TEST(CsvReader, OfATableIgnoresColumnsAndRefusesSkippedLines) {
  CsvReader reader("in", Mixed(), ProblemHandling::kStrict);
  reader.Ignore(0);
  reader.Ignore(2);
  std::vector<double> row(3);
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row, ElementsAre(IsNan(), 0.1, IsNan()));
  EXPECT_THROW(reader.NextRow(row), UserError);  // the missing value
  const auto error_of = [](std::shared_ptr<const Table> table, int skipped_lines) -> std::string {
    try {
      CsvReader("in", std::move(table), ProblemHandling::kRepair, {}, skipped_lines);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(Mixed(), 0), "");
  EXPECT_EQ(error_of(Mixed(), 1), "in:1:1: is no text, so it has no lines to skip");
  EXPECT_EQ(error_of(std::make_shared<const Table>(), 0), "in:1:1: the file holds no data");
}

/// Rows 0, 1 .. in blocks; `longest`: the most rows that were here at once.
std::shared_ptr<TableStream> Counting(std::size_t rows, std::size_t block, std::size_t& longest) {
  Table head;
  head.columns.push_back({.name = "n"});
  return std::make_shared<TableStream>(head, rows, [=, &longest, next = 0.0](Table& table) mutable {
    for (std::size_t i = 0; i < block && next < static_cast<double>(rows); ++i, ++table.rows) {
      table.columns[0].numbers.push_back(next++);
    }
    longest = std::max(longest, table.rows);
    return table.rows > 0;
  });
}

TEST(CsvReader, OfAStreamHoldsABlockAtATime) {
  constexpr std::size_t kRows = 1000, kBlock = 7;
  std::size_t longest = 0;
  CsvReader reader("in", Counting(kRows, kBlock, longest), ProblemHandling::kStrict);
  std::vector<double> row(1);
  for (std::size_t k = 0; k < kRows; ++k) {
    ASSERT_TRUE(reader.NextRow(row));
    ASSERT_EQ(row[0], static_cast<double>(k));
    ASSERT_EQ(reader.row(), k + 2);
    ASSERT_EQ(reader.share_read(), static_cast<double>(k + 1) / kRows);
  }
  EXPECT_FALSE(reader.NextRow(row));
  EXPECT_FALSE(reader.NextRow(row)) << "behind the end";
  EXPECT_EQ(reader.share_read(), 1.0);
  EXPECT_EQ(longest, kBlock);
}

TEST(CsvReader, OfAStreamGivesTheFirstRowsAgain) {
  std::size_t longest = 0;
  CsvReader reader("in", Counting(100, 7, longest), ProblemHandling::kStrict);
  const auto first = reader.FirstRows(20, 0);
  ASSERT_EQ(first.size(), 20U);
  EXPECT_THAT(first[19], ElementsAre("19"));
  std::vector<double> row(1);
  double sum = 0.0;
  while (reader.NextRow(row)) sum += row[0];
  EXPECT_EQ(sum, 4950.0);
  EXPECT_EQ(longest, 21U);
}

TEST(FindTable, OfATableHasItsFirstRowsAsTextAndGivesThemAgain) {
  FoundTable found = FindTable("in", Mixed(), ProblemHandling::kRepair);
  ASSERT_EQ(found.layout.rows.size(), 3U);
  EXPECT_THAT(found.layout.rows[1], ElementsAre("00:00:02.5", "nan", "right"));
  EXPECT_EQ(KindOf(found.layout, 0), CellKind::kTime);
  EXPECT_EQ(KindOf(found.layout, 1), CellKind::kNumber);
  EXPECT_EQ(KindOf(found.layout, 2), CellKind::kText);
  std::vector<std::string> cells;
  ASSERT_TRUE(found.reader.NextRow(cells));
  EXPECT_THAT(cells, ElementsAre("00:00:01", "0.1", "left"));
}

TEST(CsvReader, OfATableThatIsCutHasItsRowsAndARemark) {
  Table table{.columns = {}, .rows = 2, .is_cut = true, .remarks = {"left out: b"}};
  table.columns.push_back({.name = "t", .numbers = {0.0, 1.0}});
  table.columns.push_back({.name = "a", .numbers = {5.0, 6.0}});
  CsvReader reader("in", std::make_shared<const Table>(table), ProblemHandling::kStrict);
  EXPECT_THAT(reader.remarks(),
              ElementsAre("left out: b", "the file has no end; what is whole is read"));
  std::vector<double> row(2);
  ASSERT_TRUE(reader.NextRow(row));
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row, ElementsAre(1.0, 6.0));
  EXPECT_FALSE(reader.NextRow(row));
  table.is_cut = false;
  EXPECT_THAT(
      CsvReader("in", std::make_shared<const Table>(table), ProblemHandling::kStrict).remarks(),
      ElementsAre("left out: b"));
}

TEST(CsvReader, OfATableTellsHowMuchIsRead) {
  CsvReader reader("in", Mixed(), ProblemHandling::kRepair);
  std::vector<std::string> cells;
  for (const double share : {0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0}) {
    EXPECT_EQ(reader.share_read(), share);
    EXPECT_EQ(reader.NextRow(cells), share < 1.0);
  }
  EXPECT_THAT(CsvReader("in", TextSource("a\n1\n"), ProblemHandling::kRepair).share_read(),
              IsNan());
}

TEST(CsvReader, OfATableGivesItsFirstRowsUpToALimitOfBytes) {
  CsvReader reader("in", Mixed(), ProblemHandling::kRepair);
  EXPECT_EQ(reader.FirstRows(2, 0).size(), 2U);
  // A row is its texts and a byte behind each: `00:00:01`, `0.1`, `left`.
  EXPECT_EQ(reader.FirstRows(9, 0, 18).size(), 1U);
  EXPECT_EQ(reader.FirstRows(9, 0, 19).size(), 2U);
  EXPECT_EQ(reader.FirstRows(9, 0).size(), 3U);
  std::vector<std::string> cells;
  ASSERT_TRUE(reader.NextRow(cells));
  EXPECT_THAT(cells, ElementsAre("00:00:01", "0.1", "left"));
}

TEST(CsvReader, GivesRowsOfAnotherWidthAsTextsOfTheirs) {
  std::vector<RecordingProblem> problems;
  CsvReader reader("in", TextSource("a,b,c\n1,2\n1,2,3,4\n1,2,3,\n"), ProblemHandling::kRepair,
                   [&](RecordingProblem problem, std::size_t) { problems.push_back(problem); });
  std::vector<std::string> cells;
  ASSERT_TRUE(reader.NextRow(cells));
  EXPECT_THAT(cells, ElementsAre("1", "2", ""));
  ASSERT_TRUE(reader.NextRow(cells));
  EXPECT_THAT(cells, ElementsAre("1", "2", "3"));
  ASSERT_TRUE(reader.NextRow(cells));
  EXPECT_FALSE(reader.NextRow(cells));
  EXPECT_THAT(problems,
              ElementsAre(RecordingProblem::kTruncatedRow, RecordingProblem::kRowTooLong));
}

TEST(CsvReader, KeepsRowsByTheirText) {
  for (const bool is_table : {false, true}) {
    const TableInput input =
        is_table ? TableInput(Mixed())
                 : TableInput(TextSource("time,a,hand\n1,1,left\n2,2,right\n3,3,left\n"));
    CsvReader reader("in", input, ProblemHandling::kRepair);
    reader.Ignore(0);
    reader.KeepRows(2, [](std::string_view text) { return text == "right"; });
    std::vector<double> row(3);
    ASSERT_TRUE(reader.NextRow(row));
    EXPECT_EQ(reader.row(), 3U);
    EXPECT_EQ(row[2], 1.0);
    EXPECT_FALSE(reader.NextRow(row));
  }
}

TEST(CsvReader, NumbersTheFirst4096Texts) {
  std::string text = "a,b\n";
  for (int i = 0; i < 4098; ++i) text += "t" + std::to_string(i) + ",1\n";
  text += ",1\nt1,1\n";
  CsvReader reader("in", TextSource(text), ProblemHandling::kRepair);
  reader.ReadAsTexts(0);
  std::vector<double> row(2);
  for (int i = 0; i < 4098; ++i) {
    ASSERT_TRUE(reader.NextRow(row));
    EXPECT_TRUE(i < 4096 ? row[0] == i : std::isnan(row[0])) << i;
  }
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_THAT(row[0], IsNan());
  ASSERT_TRUE(reader.NextRow(row));
  EXPECT_EQ(row[0], 1.0);
}

TEST(CsvReader, ShowsNoLettersOfWhatMayBeNoTable) {
  CsvReader one("in", TextSource("a\n1\n"), ProblemHandling::kRepair);
  CsvReader two("in", TextSource("a,b\n1,2\n"), ProblemHandling::kRepair);
  EXPECT_EQ(one.Quoted("secret"), "'...'");
  EXPECT_EQ(two.Quoted("secret"), "'secret'");
  EXPECT_EQ(two.Quoted("\xc3\xa4 b c"), "'...'");
  EXPECT_EQ(one.Quoted("12-34"), "'12-34'");
  EXPECT_EQ(two.Quoted(std::string(40, '1')).size(), two.Quoted(std::string(31, '1')).size());
  EXPECT_EQ(two.Quoted(std::string(30, '1')), "'" + std::string(30, '1') + "'");
}

TEST(CsvReader, HandlesAMissingValueAsAsked) {
  for (const auto handling : {ProblemHandling::kStrict, ProblemHandling::kRepair,
                              ProblemHandling::kRemove, ProblemHandling::kAllowMissing}) {
    const bool is_refused = handling == ProblemHandling::kStrict;
    for (const char* cell : {"", "nan", "NA"}) {
      int problems = 0;
      const std::string text = std::string("a,b\n1,") + cell + "\n";
      CsvReader reader("in", TextSource(text), handling,
                       [&](RecordingProblem, std::size_t) { ++problems; });
      std::vector<double> row(2);
      if (is_refused) {
        EXPECT_THROW(reader.NextRow(row), UserError);
        continue;
      }
      ASSERT_TRUE(reader.NextRow(row));
      EXPECT_THAT(row[1], IsNan());
      EXPECT_EQ(problems, handling == ProblemHandling::kAllowMissing ? 0 : 1);
    }
    CsvReader other("in", TextSource("a,b\n1,x\n"), handling);
    std::vector<double> row(2);
    if (GoesOn(handling)) {
      EXPECT_TRUE(other.NextRow(row));
    } else {
      EXPECT_THROW(other.NextRow(row), UserError);
    }
  }
}

// The digits that are there may not be all of a number.
TEST(TableOfText, LeavesOutALastRowThatIsCut) {
  const std::string text = "t\ta\n0\t1.5\n1\t2.5\n2\t3";
  const auto read = [&](std::optional<std::int64_t> rows, bool has_end) {
    return TableOfText({"in", TextSource(text), ProblemHandling::kRepair}, rows, has_end);
  };
  const Table cut = read(9, false);
  EXPECT_TRUE(cut.is_cut);
  EXPECT_EQ(cut.rows, 2U);
  EXPECT_THAT(cut.columns[1].numbers, ElementsAre(1.5, 2.5));
  EXPECT_THAT(cut.remarks, ElementsAre("the header says 9 rows, the file has 2, which are read"));
  const std::string texts = "t\ta\n0\tx\n1\ty\n2\tz";
  const Table words = TableOfText({"in", TextSource(texts), ProblemHandling::kRepair}, 9, false);
  EXPECT_THAT(words.columns[1].texts, ElementsAre("x", "y"));
  EXPECT_TRUE(words.columns[1].numbers.empty());
  EXPECT_TRUE(words.columns[0].texts.empty());
  for (const auto& whole : {read(3, false), read(std::nullopt, false), read(9, true)}) {
    EXPECT_FALSE(whole.is_cut);
    EXPECT_THAT(whole.columns[1].numbers, ElementsAre(1.5, 2.5, 3.0));
  }
}

/// Columns of many blocks, and of one value more.
TEST(TableWriter, GivesEveryNumberToTheBit) {
  constexpr std::size_t kRows = 50001;
  std::string bytes;
  PipeWriter out([&bytes](std::span<const char> part) { bytes.append(part.begin(), part.end()); });
  TableWriter writer(out, {"a", "b", "c"}, {"remark"}, 0);
  std::vector<double> rows(3 * kRows);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = 1.0 / static_cast<double>(i + 1);
  const std::span<const double> all(rows);
  writer.Rows(all.first(3 * 7));  // in two parts
  writer.Rows(all.subspan(3 * 7));
  writer.Finish(true);
  std::size_t read = 0;
  PipeReader in([&](std::span<char> part) {
    ASSERT_LE(read + part.size(), bytes.size());
    std::ranges::copy(bytes.substr(read, part.size()), part.begin());
    read += part.size();
  });
  const Table table = ReadTable(in);
  EXPECT_EQ(read, bytes.size());
  EXPECT_TRUE(table.is_cut);
  EXPECT_THAT(table.remarks, ElementsAre("remark"));
  EXPECT_THAT(table.names(), ElementsAre("a", "b", "c"));
  ASSERT_EQ(table.rows, kRows);
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_EQ(table.columns[c].numbers.at(row), rows[3 * row + c]);
    }
  }
}

TEST(PipeReader, RefusesSizesThatNoWriterSends) {
  PipeReader in([](std::span<char> part) { std::ranges::fill(part, '\x7f'); });
  for (int kind = 0; kind < 3; ++kind) {
    try {
      kind == 0 ? (void)in.Text() : kind == 1 ? (void)in.Texts() : (void)ReadTable(in);
      FAIL() << kind;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cannot be read"));
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
