#include "sim/tables/table_layout.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

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

/// The problem of a text; empty: it is read.
std::string ProblemOf(const std::string& text) {
  try {
    LayoutOf(text);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(FindTable, TakesNamesFromEveryFormOfHeader) {
  const struct {
    const char* text;
    std::vector<std::string> names;
    int skipped_lines;
    bool has_header;
  } known[] = {
      {"a,b\n0,1\n1,2\n", {"a", "b"}, 0, true},
      {"a\tb\n0\t1\n1\t2\n", {"a", "b"}, 0, true},
      {"x\na,b\n0,1\n1,2\n", {"a", "b"}, 1, true},
      // Groups above names that are not told apart, and above ones that are.
      {"Index,,Thumb,\nx,y,x,y\n0,1,2,3\n1,2,3,4\n",
       {"Index x", "Index y", "Thumb x", "Thumb y"},
       2,
       false},
      {"Index,,Thumb,\nx,y,z,w\n0,1,2,3\n1,2,3,4\n", {"x", "y", "z", "w"}, 1, true},
      // pandas: the name of the index stands alone below those of the columns.
      {",a,b\nt,,\n0,1,2\n1,2,3\n", {"t", "a", "b"}, 2, false},
      {",Index,Index,Thumb,Thumb\n,x,y,x,y\nt,,,,\n0,1,2,3,4\n1,2,3,4,5\n",
       {"t", "Index x", "Index y", "Thumb x", "Thumb y"},
       3,
       false},
      // One name too few: that of the first column, or of the last behind a time.
      {"a,b\n0,1,2\n1,2,3\n", {"", "a", "b"}, 0, true},
      {"time,a\n0,1,2\n1,2,3\n", {"time", "a", ""}, 0, true},
      // One too many.
      {"a,b,c\n0,1\n1,2\n", {"a", "b"}, 1, false},
      // An empty line between names and rows, and above the names.
      {"note\n\na,b\n\n0,1\n1,2\n", {"a", "b"}, 2, true},
      // In comments, with separators of their own.
      {"#a;b\n0,1\n1,2\n", {"a", "b"}, 0, false},
      {"# said by hand\n0,1\n1,2\n", {"", ""}, 0, false},
      {"0,1\n1,2\n", {"", ""}, 0, false},
  };
  for (const auto& [text, names, skipped_lines, has_header] : known) {
    const TableLayout layout = LayoutOf(text);
    EXPECT_EQ(layout.names, names) << text;
    EXPECT_EQ(layout.skipped_lines, skipped_lines) << text;
    EXPECT_EQ(layout.has_header, has_header) << text;
  }
}

TEST(FindTable, TellsWhatIsBesideTheTable) {
  EXPECT_EQ(LayoutOf("a,b,c\n0,1\n1,2\n").extra_name, "c");
  EXPECT_EQ(LayoutOf("a,b,\n0,1\n1,2\n").extra_name, "''");
  EXPECT_EQ(LayoutOf("a,b\n0,1\n1,2\n").extra_name, "");
  EXPECT_EQ(LayoutOf("5,6,7\n8,9,10\nx\na,b\n0,1\n1,2\n2,3\n").rows_before, 2U);
  EXPECT_EQ(LayoutOf("x\na,b\n0,1\n1,2\n").rows_before, 0U);
  // Names inside the table: other ones, half of the known or more, or behind an empty line.
  const std::string head = "a,b,c,d\n0,1,2,3\n1,2,3,4\n";
  EXPECT_EQ(LayoutOf(head + "b,a,x,y\n2,3,4,5\n").second_names_line, 4U);
  EXPECT_EQ(LayoutOf(head + "a,w,x,y\n2,3,4,5\n").second_names_line, 0U);
  EXPECT_EQ(LayoutOf(head + "\nv,w,x,y\n2,3,4,5\n").second_names_line, 5U);
  EXPECT_EQ(LayoutOf(head + "a,b,c,d\n2,3,4,5\n").second_names_line, 0U);  // the same
  EXPECT_EQ(LayoutOf(head + "b,b,a,a\n2,3,4,5\n").second_names_line, 0U);  // not told apart
  EXPECT_EQ(LayoutOf(head + "b,a,x,1\n2,3,4,5\n").second_names_line, 0U);
}

TEST(FindTable, RefusesRowsOfTwoWidthsAndCommasOfTwoMeanings) {
  EXPECT_THAT(ProblemOf("a,b\n1,5,2,5\n1,6,2,6\n"),
              testing::HasSubstr("has 2 names above 4 values; are there decimal commas"));
  EXPECT_EQ(ProblemOf("a,b\n1,5,2\n1,6,2\n"), "");          // one more: a name is missing
  EXPECT_EQ(ProblemOf("a,b\n1,5,2,5,9\n1,6,2,6,9\n"), "");  // more than twice
  EXPECT_EQ(ProblemOf("a,b\n1,5.5,2,5\n1,6.5,2,6\n"), "");  // no whole numbers
  const auto rows = [](int narrow, int wide) {
    std::string text = "t,a,b\n";
    for (int i = 0; i < wide; ++i) text += "0.5,1,2,3,4\n";
    for (int i = 0; i < narrow; ++i) text += "0.5,1,2\n";
    return ProblemOf(text);
  };
  EXPECT_THAT(rows(4, 10),
              testing::HasSubstr("has rows of 3 and of 5 values, and the header names 3"));
  EXPECT_THAT(rows(2, 90), testing::HasSubstr("has rows of 3 and of 5 values"));
  EXPECT_EQ(rows(1, 90), "");  // seldom
}

TEST(FindTable, RefusesARowPerChannel) {
  const auto table = [](int rows, int columns) {
    std::string text;
    for (int row = 0; row < rows; ++row) {
      text += "0";
      for (int c = 1; c < columns; ++c) text += ",1";
      text += "\n";
    }
    return ProblemOf(text);
  };
  EXPECT_THAT(table(63, 257), testing::HasSubstr("has a row per channel (63 rows of 257 values)"));
  EXPECT_EQ(table(64, 257), "");
  EXPECT_EQ(table(63, 256), "");
  std::string named = "a0";
  for (int c = 1; c < 257; ++c) named += ",a" + std::to_string(c);
  std::string row = "0";
  for (int c = 1; c < 257; ++c) row += ",1";
  EXPECT_EQ(ProblemOf(named + "\n" + row + "\n" + row + "\n"), "");
}

TEST(FindTable, BeginsWithTheRowsInWhichMostIsMissing) {
  EXPECT_EQ(LayoutOf("a,b,c,d\n0,,,\n1,,,\n2,5,6,7\n3,5,6,7\n4,5,6,7\n").rows.size(), 5U);
  // Rows with a remark behind them, or without their last value, up to the names.
  EXPECT_EQ(LayoutOf("a,b,c\n0,1,2,x\n1,2,3\n2,3,4\n").skipped_lines, 0);
  EXPECT_EQ(LayoutOf("a,b,c\n0,1\n1,2,3\n2,3,4\n").skipped_lines, 0);
}

TEST(FindTable, FindsDecimalCommas) {
  for (const auto& [text, has_comma] : {std::pair("a;b\n0;1,5\n1;2\n", true),
                                        {"a;b\n0;1.5\n1;2\n", false},
                                        {"a,b\n0,1\n1,2\n", false},
                                        {"a;b\n12:00:00,5;1\n12:00:01,5;2\n", false}}) {
    EXPECT_EQ(LayoutOf(text).decimal_comma, has_comma) << text;
  }
  const TableLayout layout = LayoutOf("a;b\n0;1,5\n1;2\n");
  EXPECT_EQ(NumberIn(layout, "1,5"), 1.5);
}

TEST(KindOf, IsThatOfMostCells) {
  const auto kind = [](const std::vector<std::string>& cells) {
    TableLayout layout;
    for (const std::string& cell : cells) layout.rows.push_back({cell});
    return KindOf(layout, 0);
  };
  EXPECT_EQ(kind({"1", "2", "x"}), CellKind::kNumber);
  EXPECT_EQ(kind({"1", "x"}), CellKind::kNumber);
  EXPECT_EQ(kind({"1", "x", "y"}), CellKind::kText);
  EXPECT_EQ(kind({"12:00", "12:01", "1", "x", "y"}), CellKind::kTime);
  EXPECT_EQ(kind({"12:00", "1"}), CellKind::kNumber);
  EXPECT_EQ(kind({"", "nan", "x"}), CellKind::kText);
  EXPECT_EQ(kind({"", "nan"}), CellKind::kNumber);
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
  // The index of pandas without a name, behind reset_index(): in JSON, and in Parquet as it is
  // read.
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

/// Rows of these columns, each a function of the row.
std::string Rows(const std::string& names, int count,
                 const std::vector<std::function<double(int)>>& columns) {
  std::string text = names + "\n";
  for (int row = 0; row < count; ++row) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      text += (c > 0 ? "," : "") + std::to_string(columns[c](row));
    }
    text += "\n";
  }
  return text;
}

TEST(ClocksBeside, RunAsLongAsTheTimeInSOrMsOrUs) {
  const auto time = [](int row) { return 0.02 * row; };
  const auto clocks = [&](const std::string& name, double per_s, int count = 100,
                          double wave = 0.0) {
    const TableLayout layout = LayoutOf(
        Rows("time_s," + name, count,
             {time, [&](int row) { return 5e3 + per_s * 0.02 * row + wave * std::sin(row); }}));
    return ClocksBeside(TimeByName("in", layout), layout).size();
  };
  for (const double per_s : {1e3, 1e6}) EXPECT_EQ(clocks("x", per_s), 1U) << per_s;
  EXPECT_EQ(clocks("x", 1.0), 0U);  // with fractions, and no name of a time
  EXPECT_EQ(clocks("clock", 1.0), 1U);
  EXPECT_EQ(clocks("x", 1e4), 0U);
  EXPECT_EQ(clocks("x", 1e3, 10), 1U);
  EXPECT_EQ(clocks("x", 1e3, 9), 0U);
  EXPECT_EQ(clocks("clock", 1.03e3), 1U);  // within 2 % and two intervals
  EXPECT_EQ(clocks("clock", 1.05e3), 0U);
  EXPECT_EQ(clocks("clock", 1e3, 100, 50.0), 0U);  // one that goes back
}

TEST(ColumnsAside, AreNumbersOfRowsAndOtherTimesByName) {
  const TableLayout layout =
      LayoutOf(Rows("time_s,frame,index_mcp,label_id,pc_ms", 50,
                    {[](int row) { return 0.02 * row; }, [](int row) { return row; },
                     [](int row) { return 30.0 + 20.0 * std::sin(row); },
                     [](int row) { return row % 3; }, [](int row) { return 20.0 * row + 7.0; }}));
  const std::vector<std::size_t> aside = ColumnsAside(TimeByName("in", layout), layout);
  EXPECT_THAT(aside, testing::IsSupersetOf({std::size_t{1}, std::size_t{4}}));
  EXPECT_THAT(aside, testing::Not(testing::Contains(2U)));
}

TEST(MidnightClock, GoesOnBehindMidnight) {
  MidnightClock clock({TimeMapping{.column = 0, .is_text = true}});
  EXPECT_EQ(clock.Add(86399.0), 86399.0);
  EXPECT_EQ(clock.Add(1.0), 86401.0);
  EXPECT_EQ(clock.Add(86399.5), 2 * 86400.0 - 0.5);
  EXPECT_EQ(clock.Add(0.0), 2 * 86400.0);
  MidnightClock back({TimeMapping{.column = 0, .is_text = true}});
  EXPECT_EQ(back.Add(83000.0), 83000.0);
  EXPECT_EQ(back.Add(200.0), 200.0);  // 23 h are no midnight
  EXPECT_EQ(back.Add(83001.0), 83001.0);
  EXPECT_EQ(back.Add(200.0), 86600.0);
  MidnightClock date({TimeMapping{.column = 0, .is_text = true}});
  EXPECT_EQ(date.Add(90000.0), 90000.0);
  EXPECT_EQ(date.Add(1.0), 1.0);  // a date knows its day
  MidnightClock number({TimeMapping{.column = 0}});
  number.Add(86399.0);
  EXPECT_EQ(number.Add(1.0), 1.0);
}

TEST(GuessTime, KnowsNumbersThatCountFromADate) {
  const auto unit = [](double first, double step) {
    std::string text = "clock,a\n";
    for (int row = 0; row < 5; ++row) text += fmt::format("{:.17g},0.5\n", first + row * step);
    const TimeGuess time = GuessTime(LayoutOf(text));
    return time.parts.empty() ? "" : UnitOfTime(time.parts[0]);
  };
  constexpr double kDay = 1.0 / 86400.0;
  EXPECT_EQ(unit(739000.0, 0.02 * kDay), "day");  // datenum of MATLAB
  EXPECT_EQ(unit(45000.0, 0.02 * kDay), "day");   // of a spreadsheet
  EXPECT_EQ(unit(45000.0, 20.0 * kDay), "");      // no rate of a glove
  EXPECT_EQ(unit(6.38e17, 2e5), "ticks");
  EXPECT_EQ(unit(1.33e17, 2e5), "ticks");
  EXPECT_EQ(unit(1.7e18, 2e7), "ns");
  EXPECT_EQ(unit(1.7e15, 2e4), "us");
  EXPECT_EQ(unit(1.7e12, 20.0), "ms");
  EXPECT_EQ(unit(1.7e9, 0.02), "s");
  EXPECT_EQ(unit(4.9e8, 0.02), "");
  EXPECT_EQ(unit(80000.0, 0.02 * kDay), "");
}

TEST(GuessTime, KnowsTheUnitByEveryNameOfIt) {
  for (const auto& [unit, names] :
       {std::pair("h", "hour hours"),
        {"min", "min mins minute minutes"},
        {"ms", "ms msec msecs millis millisec millisecond milliseconds"},
        {"us", "us usec usecs micros microsec microsecond microseconds"},
        {"ns", "ns nsec nsecs nanos nanosec nanosecond nanoseconds"},
        {"s", "s sec secs second seconds"}}) {
    for (std::string rest = names; !rest.empty();) {
      const std::string word = rest.substr(0, rest.find(' '));
      rest.erase(0, word.size() + 1);
      EXPECT_EQ(TimeOf("elapsed time (" + word + "),a", {"0", "3", "6", "9"}),
                std::string(unit) + " ")
          << word;
    }
  }
  EXPECT_EQ(TimeOf("timestampUs,a", {"0", "3", "6", "9"}), "us ");
  EXPECT_EQ(TimeOf("tms,a", {"0", "3", "6", "9"}), "ms ");
}

// Values that rise make no time of a finger, a joint, a number of rows or another quantity.
TEST(GuessTime, TakesNoOtherQuantityForATime) {
  for (const char* name : {"index_mcp", "pip", "wrist", "spread", "flex_1", "pos", "frame", "id",
                           "nr", "x", "extension", "emg", "force", "temperature", "image"}) {
    EXPECT_EQ(TimeOf(std::string(name) + ",a", {"0", "0.01", "0.02", "0.03"}), "") << name;
  }
  // The first column without a name is one, with s assumed.
  EXPECT_EQ(TimeOf(",a", {"0", "0.01", "0.02", "0.03"}), "s ");
  EXPECT_EQ(TimeOf("Unnamed: 0,a", {"0", "0.01", "0.02", "0.03"}), "s ");
  EXPECT_EQ(TimeOf(",a", {"0", "0.5", "1", "1.5"}), "");  // no rate of a glove
  EXPECT_EQ(TimeOf(",a", {"0", "1e-5", "2e-5", "3e-5"}), "");
  EXPECT_EQ(TimeOf(",a", {"0", "0.4", "0.8", "1.2"}), "s ");
}

TEST(GuessTime, AddsPartsByTheirNames) {
  EXPECT_EQ(TimeOf("hour,minute,second,a", {"1,2,3.00", "1,2,3.02", "1,2,3.04"}), "h min s ");
  EXPECT_EQ(TimeOf("day,hh,mm,ss,ms,a", {"1,1,2,3,0", "1,1,2,3,20", "1,1,2,3,40"}),
            "day h min s ms ");
  EXPECT_EQ(TimeOf("min,sec,a", {"1,2.00", "1,2.02", "1,2.04"}), "min s ");
  EXPECT_EQ(TimeOf("day,sec,nsec,a", {"1,2,0", "1,2,20000000", "1,2,40000000"}), "s ns ");
}

}  // namespace
}  // namespace gauntlet::sim
