#include "sim/tables/table_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "sim/base/error.h"
#include "sim/recordings/time_guess.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

TableLayout LayoutOf(const std::string& text) {
  return FindTable("in", TextSource(text), ProblemHandling::kRepair).layout;
}

TEST(FindTable, PassesOverWhatASensorsSoftwareWrites) {
  const TableLayout layout = LayoutOf("Glove 2.1\nSerial,17\n\nt,a\n0,1\n1,2\n2,3\n");
  EXPECT_EQ(layout.skipped_lines, 3);
  EXPECT_TRUE(layout.has_header);
  EXPECT_THAT(layout.names, ElementsAre("t", "a"));
  EXPECT_THAT(layout.notes, ElementsAre("Glove 2.1", "Serial,17"));
}

TEST(FindTable, JoinsNamesAndUnitsThatStandBelowThem) {
  const TableLayout layout = LayoutOf("Time\tThumb\n[s]\t[deg]\n0\t1\n1\t2\n2\t3\n");
  EXPECT_EQ(layout.skipped_lines, 2);
  EXPECT_FALSE(layout.has_header);
  EXPECT_THAT(layout.names, ElementsAre("Time [s]", "Thumb [deg]"));
}

TEST(FindTable, ReadsNamesInAComment) {
  const TableLayout layout = LayoutOf("# t a b\n0 1 2\n1 2 3\n2 3 4\n");
  EXPECT_THAT(layout.names, ElementsAre("t", "a", "b"));
  EXPECT_FALSE(layout.has_header);
  EXPECT_EQ(layout.skipped_lines, 0);
}

TEST(FindTable, KeepsAFirstRowWithATextIfNoLineNamesTheColumns) {
  FoundTable table =
      FindTable("in", TextSource("left,0,7\nleft,1,8\nright,2,9\n"), ProblemHandling::kRepair);
  table.reader.Ignore(0);
  std::vector<double> values(3);
  ASSERT_TRUE(table.reader.NextRow(values));
  EXPECT_EQ(values[2], 7.0);
  EXPECT_EQ(table.layout.rows.size(), 3U);
}

TEST(FindTable, NeedsNoHeader) {
  const TableLayout layout = LayoutOf("0,01 1,5\n0,02 1,6\n0,03 1,7\n");
  EXPECT_EQ(layout.separator, ' ');
  EXPECT_TRUE(layout.decimal_comma);
  EXPECT_THAT(layout.names, ElementsAre("", ""));
}

TEST(FindTable, FindsNamesInQuotesThatGoOverLines) {
  const TableLayout layout =
      LayoutOf("Glove 2.1\n\"time\n(s)\",\"index\r\nmcp\",x\n0,1,2\n1,2,3\n2,3,4\n");
  EXPECT_EQ(layout.skipped_lines, 1);
  EXPECT_TRUE(layout.has_header);
  EXPECT_THAT(layout.names, ElementsAre("time (s)", "index mcp", "x"));
  EXPECT_EQ(layout.rows.size(), 3u);
}

TEST(FindTable, HasTheShapeThatItsReaderHas) {
  const std::pair<const char*, std::size_t> columns_of[] = {
      {"t,a\n0,1,\n1,2,\n2,3,\n", 2},               // a separator behind the rows
      {"a\tb\t\n1\t2\n3\t4\n", 2},                  // or behind the names
      {"time a;b\n0,1,2\n1,2,3\n2,3,4\n", 3},       // separators of names that rows have not
      {"5,rest\n0,1,2\n\n1,2,3\n3,4\n\n4,5,6", 3},  // rows apart
      {"x,y\n1,2\n3\n", 2},
  };
  for (const auto& [text, columns] : columns_of) {
    FoundTable table = FindTable("in", TextSource(text), ProblemHandling::kRepair);
    EXPECT_EQ(table.reader.column_count(), columns) << text;
    EXPECT_EQ(table.layout.columns, columns) << text;
    EXPECT_EQ(table.layout.names.size(), columns) << text;
    for (const auto& row : table.layout.rows) EXPECT_EQ(row.size(), columns) << text;
    std::vector<double> values(columns);
    EXPECT_TRUE(table.reader.NextRow(values)) << text;
    EXPECT_EQ(std::to_string(static_cast<int>(values[0])), table.layout.rows[0][0]) << text;
  }
}

TEST(FindTable, RefusesTextsWithoutARow) {
  for (const char* text : {"# glove log\ntime_s,index_mcp\n", "\na\n", "a\n\nb", "t,a\n", ""}) {
    EXPECT_THROW(LayoutOf(text), UserError) << text;
  }
}

/// Units of the columns that are the time, in their order.
std::string TimeOf(const std::string& header, const std::vector<std::string>& times) {
  std::string text = header + "\n";
  for (std::size_t row = 0; row < times.size(); ++row) text += times[row] + ",0.5\n";
  std::string units;
  for (const TimeMapping& part : GuessTime(LayoutOf(text)).parts) units += UnitOfTime(part) + " ";
  return units;
}

TEST(GuessTime, KnowsTheUnitByNameOrDate) {
  EXPECT_EQ(TimeOf("time_ms,a", {"0", "10", "20", "30"}), "ms ");
  EXPECT_EQ(TimeOf("time,a", {"0", "0.01", "0.02", "0.03"}), "s ");
  EXPECT_EQ(TimeOf("X_Value,a", {"0", "0.01", "0.02", "0.03"}), "s ");
  EXPECT_EQ(TimeOf("timestamp,a", {"1700000000", "1700000000.1", "1700000000.2", "1700000000.3"}),
            "s ");
  EXPECT_EQ(TimeOf("timestamp,a", {"1700000000000", "1700000000020", "1700000000040"}), "ms ");
  EXPECT_EQ(TimeOf("x,a", {"1700000000000", "1700000000020", "1700000000040"}), "");
  EXPECT_EQ(TimeOf("Zeit,a", {"1700000000000", "1700000000020", "1700000000040"}), "ms ");
  EXPECT_EQ(TimeOf("sec,nanosec,a", {"5,0", "5,20000000", "5,40000000"}), "s ns ");
  EXPECT_EQ(TimeOf("x,a", {"12:00:00.1", "12:00:00.2", "12:00:00.3"}), "date ");
  EXPECT_EQ(TimeOf("Date,Time,a", {"2024-05-31,12:00:00", "2024-05-31,12:00:01"}), "date date ");
  EXPECT_EQ(TimeOf("frame,a", {"0", "1", "2", "3"}), "");
  EXPECT_EQ(TimeOf("x,a", {"7", "9", "8", "9"}), "");
  EXPECT_EQ(TimeOf("date,recv_timestamp_ms,a",
                   {"2024-05-31,5", "2024-05-31,25", "2024-05-31,45", "2024-05-31,65"}),
            "ms ");
  // The index of pandas without a name, behind reset_index(): in JSON, and in Parquet as it is read.
  EXPECT_EQ(TimeOf("index,a", {"1700000000000", "1700000000020", "1700000000040"}), "ms ");
  EXPECT_EQ(TimeOf("index_time_us,a", {"0", "20000", "40000"}), "us ");
  EXPECT_EQ(TimeOf("index,a", {"1700000000", "1700000100", "1700000200"}), "");
}

TEST(GuessTime, AsksForTheUnitOfOtherTimes) {
  const auto ask = [](const std::string& name, const char* unit) {
    std::string text = name + ",a\n";
    for (int row = 0; row < 5; ++row) text += std::to_string(20 * row) + ",0.5\n";
    const TimeGuess time = GuessTime(LayoutOf(text), unit);
    return time.parts.empty() ? time.question : UnitOfTime(time.parts[0]);
  };
  EXPECT_EQ(ask("time", ""), "column 1 'time' rises by 20 from row to row");
  EXPECT_EQ(ask("clock", ""), "column 1 'clock' rises by 20 from row to row");
  EXPECT_EQ(ask("Zeit", ""), "column 1 'Zeit' rises by 20 from row to row");
  EXPECT_EQ(ask("Zeit", "ms"), "ms");
  EXPECT_EQ(ask("index", ""), "");
  EXPECT_THROW(TimeByName("in", LayoutOf("time,a\n0,1\n20,1\n40,1\n")), UserError);
}

TEST(TimeByName, TakesNoColumnByItsValuesAlone) {
  const auto scales = [](const std::string& text) {
    std::string found;
    for (const TimeMapping& time : TimeByName("in", LayoutOf(text))) {
      found += std::to_string(time.column) + (time.is_text ? "t " : " ");
    }
    return found;
  };
  const std::string rows = "0,0\n0.01,1\n0.02,2\n0.03,3\n";
  EXPECT_EQ(scales("thumb,index\n" + rows), "");
  EXPECT_EQ(scales("thumb,time_s\n" + rows), "1 ");
  EXPECT_EQ(scales("pc_time_s,time_s\n" + rows), "0 ");
  EXPECT_EQ(scales("a,Time\n1,14:10:49.000\n"), "1t ");
}

}  // namespace
}  // namespace gauntlet::sim
