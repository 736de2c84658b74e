// A file that needs too many repairs is refused, with what most likely is wrong with it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <string>

#include "sim/base/error.h"
#include "sim/recordings/recording.h"
#include "sim/tables/recording_problem.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

class RepairBudget : public testing::Test {
 protected:
  /// Three seconds of index_mcp at 100 Hz; `row` writes a row of a time and an angle [deg].
  std::string Refusal(const std::function<std::string(int, double)>& row, double percent = 5.0,
                      const std::string& map = "") {
    const std::string file = (folder_.path() / "in.csv").string();
    {
      std::ofstream rows(file);
      rows << "time_s,index_mcp\n";
      for (int i = 0; i < 300; ++i) rows << row(i, 20.0 + 10.0 * std::sin(0.05 * i)) << '\n';
    }
    RecordingFormat format;
    format.handling = ProblemHandling::kRepair;
    format.repair_budget_percent = percent;
    if (!map.empty()) {
      format.map = (folder_.path() / "map.csv").string();
      std::ofstream(format.map) << map;
    }
    try {
      remarks_ = LoadRecording(file, format).remarks;
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  std::vector<std::string> remarks_;
  test::TemporaryDirectory folder_;
};

TEST_F(RepairBudget, IsForAFewRowsAndAKeyAllowsMore) {
  const auto bad_every = [](int rows) {
    return [rows](int i, double deg) {
      return i % rows == 3 ? fmt::format("{},bad", 0.01 * i) : fmt::format("{},{}", 0.01 * i, deg);
    };
  };
  EXPECT_EQ(Refusal(bad_every(25)), "");
  EXPECT_THAT(
      Refusal(bad_every(10)),
      AllOf(HasSubstr("in.csv: 10 % of its rows would need repair, mostly \"not a number\"; "
                      "at most 5 % may (repair_budget_percent)"),
            HasSubstr("decimal commas")));
  EXPECT_EQ(Refusal(bad_every(10), 11.0), "");
  // What is missing is no repair.
  EXPECT_EQ(Refusal([](int i, double deg) {
              return i % 2 == 0 ? fmt::format("{},{}", 0.01 * i, deg)
                                : fmt::format("{},", 0.01 * i);
            }),
            "");
}

TEST_F(RepairBudget, IsForRowsThatHaveNoTimeToo) {
  const std::string map = "column,channel,unit\ntime_s,time,date\nindex_mcp,index_mcp,deg\n";
  const auto no_time_every = [](int rows) {
    return [rows](int i, double deg) {
      return i % rows == 3 ? fmt::format("soon,{}", deg)
                           : fmt::format("12:00:{:05.2f},{}", 0.01 * i, deg);
    };
  };
  EXPECT_EQ(Refusal(no_time_every(25), 5.0, map), "");
  EXPECT_THAT(remarks_, Contains(HasSubstr("in.csv: no time: 12 times, first in row 5")));
  EXPECT_THAT(Refusal(no_time_every(10), 5.0, map),
              AllOf(HasSubstr("10 % of its rows would need repair, mostly \"no time\""),
                    HasSubstr("is the column of time another?")));
}

TEST_F(RepairBudget, NamesTheLikeliestCause) {
  const auto times_of = [](double step) {
    return [step](int i, double deg) { return fmt::format("{},{}", step * i, deg); };
  };
  EXPECT_THAT(Refusal(times_of(10.0)), HasSubstr("are the times milliseconds, taken for seconds?"));
  EXPECT_THAT(Refusal(times_of(1e4)), HasSubstr("are the times microseconds"));
  EXPECT_THAT(Refusal(times_of(1e7)), HasSubstr("are the times nanoseconds"));
  EXPECT_THAT(Refusal(times_of(0.2)),
              HasSubstr("rows usually come every 200 ms: longest_gap_ms must be above that"));
  EXPECT_THAT(
      Refusal([](int i, double deg) { return fmt::format("{},{}", 0.01 * (i * 37 % 300), deg); }),
      HasSubstr("are the rows shuffled? Sort them by time"));
  EXPECT_THAT(Refusal([](int i, double deg) { return fmt::format("{:.1f},{}", 0.01 * i, deg); }),
              HasSubstr("is the time too coarse?"));
  EXPECT_THAT(Refusal([](int i, double deg) { return fmt::format("0,{:02},{:.0f},5", i, deg); }),
              HasSubstr("decimal commas between commas"));
  EXPECT_THAT(
      Refusal(times_of(0.01), 5.0, "column,channel,unit\ntime_s,time,\nindex_mcp,index_mcp,rad\n"),
      HasSubstr("degrees taken for radians"));
}

TEST_F(RepairBudget, IsNotForAnglesOutsideTheRangeOfTheirJoint) {
  const auto moved_by = [](double more_deg) {
    return [more_deg](int i, double deg) { return fmt::format("{},{}", 0.01 * i, deg + more_deg); };
  };
  EXPECT_EQ(Refusal(moved_by(70.0)), "");
  EXPECT_THAT(Refusal(moved_by(95.0)),
              HasSubstr("in.csv: index_mcp: 100 % of its angles are outside -45 to 90 deg"));
}

TEST_F(RepairBudget, AsksAfterRadiansInColumnsOfDegrees) {
  const auto radians = [](int i, double deg) {
    return fmt::format("{},{}", 0.01 * i, deg / 57.29577951308232);
  };
  EXPECT_EQ(Refusal(radians), "");
  EXPECT_THAT(remarks_, Contains(HasSubstr("no angle is above 0.52 deg: are they radians?")));
}

}  // namespace
}  // namespace gauntlet::sim
