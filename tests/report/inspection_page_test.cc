// The page of an inspection: what its pictures mark, and where.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "sim/show/pages/channel_chart.h"
#include "sim/show/pages/pages.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kRows = 1000;
constexpr int kFirstLost = 400;
constexpr int kLastLost = 449;
constexpr int kRowBeforeGap = 699;
const std::vector<std::size_t> kSpikes = {120, 300, 610, 900};

std::size_t Count(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Sensors that are sound, dead, with spikes, clipped and with lost rows, and a column with HTML.
/// `defects`: false for sound sensors alone.
Inspection InspectSensors(bool defects) {
  const gauntlet::test::TemporaryDirectory folder;
  const std::filesystem::path path = folder.path() / "glove.csv";
  std::ofstream file(path);
  file << "time_s,index_mcp,index_pip,middle_mcp,middle_pip,ring_mcp,little_mcp <b>\n";
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, 2.0);
  double time_s = 0.0;
  for (int k = 0; k < kRows; ++k) {
    file << time_s;
    time_s += defects && k == kRowBeforeGap ? 1.0 : 0.02;
    for (int i = 0; i < 6; ++i) {
      double value = 500.0 + 200.0 * std::sin(0.03 * k + i) + noise(generator);
      if (defects && i == 1) value = 300.0;
      if (defects && i == 2 && std::ranges::count(kSpikes, static_cast<std::size_t>(k)) > 0) {
        value = 1000.0;
      }
      if (defects && i == 3) value = std::min(value, 600.0);
      file << ",";
      if (defects && i == 4 && k >= kFirstLost && k <= kLastLost) continue;
      file << std::lround(value);
    }
    file << "\n";
  }
  file.close();
  return Inspect(path, {});
}

TEST(InspectionPage, MarksDefectsWhereTheyAre) {
  const Inspection inspection = InspectSensors(true);
  const std::vector<HealthFinding> findings = HealthOf(inspection);
  const auto marks = [&](std::size_t column) { return FindDefects(inspection, findings, column); };
  EXPECT_THAT(marks(3).spikes, testing::ElementsAreArray(kSpikes));
  for (const std::size_t c : {1, 2, 4, 5, 6}) EXPECT_THAT(marks(c).spikes, IsEmpty()) << c;

  ASSERT_EQ(marks(5).missing.size(), 1U);
  EXPECT_EQ(marks(5).missing.front().first, static_cast<std::size_t>(kFirstLost));
  EXPECT_EQ(marks(5).missing.front().last, static_cast<std::size_t>(kLastLost));
  EXPECT_THAT(marks(1).missing, IsEmpty());

  ASSERT_EQ(marks(1).gaps.size(), 1U);
  EXPECT_EQ(marks(1).gaps.front().first, static_cast<std::size_t>(kRowBeforeGap));

  EXPECT_THAT(marks(4).clipped, Not(IsEmpty()));
  for (const RowStretch& stretch : marks(4).clipped) {
    for (std::size_t i = stretch.first; i <= stretch.last; ++i) {
      EXPECT_EQ(inspection.picture_values[4][i], 600.0);
    }
  }
  EXPECT_THAT(marks(1).clipped, IsEmpty());
}

TEST(InspectionPage, HasAPictureOfEachSensorAndAllMarks) {
  const std::string page = InspectionPage(InspectSensors(true));
  EXPECT_EQ(Count(page, "<svg class=\"channel\""), 5U);
  EXPECT_EQ(Count(page, "class=\"spike\""), kSpikes.size());
  EXPECT_EQ(Count(page, "class=\"gap\""), 5U);
  EXPECT_EQ(Count(page, "class=\"missing\""), 1U);
  EXPECT_GE(Count(page, "class=\"clipped\""), 4U);
  EXPECT_EQ(Count(page, "class=\"curve dead\""), 1U);
  EXPECT_EQ(Count(page, "class=\"mark "), 4U);  // the legend
  EXPECT_THAT(page, HasSubstr("check its cable"));
  EXPECT_THAT(page, HasSubstr("little_mcp &lt;b&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("little_mcp <b>")));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(InspectionPage, MarksNothingOfSoundSensors) {
  const std::string page = InspectionPage(InspectSensors(false));
  EXPECT_EQ(Count(page, "<svg class=\"channel\""), 5U);
  EXPECT_THAT(page, HasSubstr("No sensor has a defect."));
  for (const char* css : {"spike", "gap", "missing", "clipped", "curve dead", "bad"}) {
    EXPECT_EQ(Count(page, std::string("class=\"") + css), 0U) << css;
  }
  EXPECT_EQ(Count(page, "class=\"mark "), 0U);
}

TEST(InspectionPage, KeepsPeaksOfManyRows) {
  Inspection inspection = InspectSensors(false);
  inspection.picture_values[1][501] = 690.0 + 300.0;
  inspection.columns[1].statistics.high = 990.0;
  const Figure figure = ChannelChart(inspection, {}, 1);
  double highest = figure.height_px;
  std::size_t points = 0;
  for (const FigureShape& shape : figure.shapes) {
    if (shape.ink.css != "curve") continue;
    points = shape.points.size();
    for (const FigurePoint& point : shape.points) highest = std::fmin(highest, point.y);
  }
  EXPECT_LT(points, 700U);
  EXPECT_GT(points, 300U);
  EXPECT_LT(highest, 32.0);  // near the upper edge of the panel
}

}  // namespace
}  // namespace gauntlet::sim
