#include "sim/inspect/table_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/inspect/time_guess.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

TableLayout LayoutOf(const std::string& text) { return FindTable("in", TextSource(text)); }

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

TEST(FindTable, NeedsNoHeader) {
  const TableLayout layout = LayoutOf("0,01 1,5\n0,02 1,6\n0,03 1,7\n");
  EXPECT_EQ(layout.separator, ' ');
  EXPECT_TRUE(layout.decimal_comma);
  EXPECT_THAT(layout.names, ElementsAre("", ""));
}

/// Units of the columns that are the time, in their order.
std::string TimeOf(const std::string& header, const std::vector<std::string>& times) {
  std::string text = header + "\n";
  for (std::size_t row = 0; row < times.size(); ++row) text += times[row] + ",0.5\n";
  std::string units;
  for (const TimePart& part : GuessTime(LayoutOf(text)).parts) units += part.unit + " ";
  return units;
}

TEST(GuessTime, KnowsTheUnitByNameOrSize) {
  EXPECT_EQ(TimeOf("time_ms,a", {"0", "10", "20", "30"}), "ms ");
  EXPECT_EQ(TimeOf("time,a", {"0", "0.01", "0.02", "0.03"}), "s ");
  EXPECT_EQ(TimeOf("time,a", {"0", "10", "20", "30"}), "ms ");
  EXPECT_EQ(TimeOf("timestamp,a", {"0", "10000", "20000", "30000"}), "us ");
  EXPECT_EQ(TimeOf("timestamp,a", {"1700000000", "1700000000.1", "1700000000.2", "1700000000.3"}),
            "s ");
  EXPECT_EQ(TimeOf("timestamp,a", {"1700000000000", "1700000000020", "1700000000040"}), "ms ");
  EXPECT_EQ(TimeOf("sec,nanosec,a", {"5,0", "5,20000000", "5,40000000"}), "s ns ");
  EXPECT_EQ(TimeOf("x,a", {"12:00:00.1", "12:00:00.2", "12:00:00.3"}), "date ");
  EXPECT_EQ(TimeOf("Date,Time,a", {"2024-05-31,12:00:00", "2024-05-31,12:00:01"}), "date date ");
  EXPECT_EQ(TimeOf("frame,a", {"0", "1", "2", "3"}), "");
  EXPECT_EQ(TimeOf("x,a", {"7", "9", "8", "9"}), "");
}

}  // namespace
}  // namespace gauntlet::sim
