// Jitter against delay of the controllers of a report page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "sim/show/pages/front_chart.h"
#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Scores (delay [ms], jitter [deg]) for each controller.
Summary SummaryOf(const std::vector<std::pair<double, double>>& scores) {
  Summary summary = test::MakeUpStudy({.controllers = static_cast<int>(scores.size())}).summary;
  for (std::size_t c = 0; c < scores.size(); ++c) {
    std::vector<MeanInterval>& means = summary.controllers[c].summary;
    means[MetricIndex("delay_ms")].mean = scores[c].first;
    means[MetricIndex("jitter_rms_deg")].mean = scores[c].second;
  }
  return summary;
}

/// The figure of one width.
std::string FigureOf(const std::string& html, const std::string& width) {
  const std::size_t begin = html.find("<svg class=\"" + width + "\"");
  return html.substr(begin, html.find("</svg>", begin) - begin);
}

std::vector<std::pair<double, double>> PlacesOf(const std::string& svg, const std::string& shape) {
  std::vector<std::pair<double, double>> places;
  const std::regex pattern(shape);
  for (std::sregex_iterator it(svg.begin(), svg.end(), pattern), end; it != end; ++it) {
    places.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return places;
}

TEST(ControllersFront, HasAPointForEachControllerInEachWidth) {
  const std::string html = ControllersFront(SummaryOf({{100.0, 0.3}, {150.0, 0.1}, {kNaN, 0.2}}));
  for (const char* width : {"wide", "narrow"}) {
    const auto points =
        PlacesOf(FigureOf(html, width), "<circle [^>]*cx=\"([^\"]*)\" cy=\"([^\"]*)\"");
    ASSERT_EQ(points.size(), 2u) << width;
    EXPECT_LT(points[0].first, points[1].first);
    EXPECT_LT(points[0].second, points[1].second) << "more jitter is higher";
  }
  EXPECT_THAT(html, HasSubstr("raw: 100 ms"));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(ControllersFront, NamesOfPointsInOnePlaceDoNotCoverEachOther) {
  const std::string svg =
      FigureOf(ControllersFront(SummaryOf({{100.0, 0.3}, {101.0, 0.3}, {102.0, 0.3}})), "narrow");
  const auto names = PlacesOf(svg, "<text class=\"label\" x=\"([^\"]*)\" y=\"([^\"]*)\"");
  ASSERT_EQ(names.size(), 3u);
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const bool other_line = std::abs(names[i].second - names[j].second) >= 15.9;
      const bool other_side = std::abs(names[i].first - names[j].first) > 20.0;
      EXPECT_TRUE(other_line || other_side) << i << " and " << j;
    }
  }
}

TEST(ControllersFront, WithoutADelaySaysWhy) {
  EXPECT_THAT(ControllersFront(SummaryOf({{kNaN, 0.3}})), HasSubstr("did not move"));
}

}  // namespace
}  // namespace gauntlet::sim
