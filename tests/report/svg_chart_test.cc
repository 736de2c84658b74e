// Drawings of curves and bars.
#include "sim/show/pages/svg_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <sstream>

namespace gauntlet::sim {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// Points of the first curve.
std::vector<std::pair<double, double>> Points(const std::string& svg) {
  const std::string opening = " d=\"";
  const std::size_t begin = svg.find(opening);
  if (begin == std::string::npos) return {};
  const std::size_t first = begin + opening.size();
  std::istringstream text(svg.substr(first, svg.find('"', first) - first));
  std::vector<std::pair<double, double>> points;
  double x = 0.0, y = 0.0;
  text.get();  // M
  while (text >> x >> y) points.emplace_back(x, y);
  return points;
}

Chart OneCurve(std::vector<double> values) {
  Chart chart;
  chart.title = "a < b";
  chart.curves.push_back({"curve", 0.0, 1.0, std::move(values)});
  return chart;
}

TEST(SvgChart, DrawsUpwardsAndFromLeftToRight) {
  const auto points = Points(SvgChart(OneCurve({0.0, 1.0, 3.0})));
  ASSERT_EQ(points.size(), 3u);
  EXPECT_LT(points[0].first, points[1].first);
  EXPECT_NEAR(points[1].first - points[0].first, points[2].first - points[1].first, 0.11);
  EXPECT_NEAR(points[1].second - points[2].second, 2.0 * (points[0].second - points[1].second),
              0.3);
}

TEST(SvgChart, KeepsAPeakAmongManySamples) {
  std::vector<double> values(94096, 0.0);
  values[50001] = 10.0;
  const auto points = Points(SvgChart(OneCurve(values)));
  EXPECT_LT(points.size(), 2000u);
  const auto highest = std::min_element(points.begin(), points.end(),
                                        [](auto& a, auto& b) { return a.second < b.second; });
  EXPECT_LT(highest->second, points.front().second - 100.0);
  const double share =
      (highest->first - points.front().first) / (points.back().first - points.front().first);
  EXPECT_NEAR(share, 50001.0 / 94096.0, 0.005);
}

TEST(SvgChart, EscapesItsTexts) {
  const std::string svg = SvgChart(OneCurve({1.0, 2.0}));
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  EXPECT_THAT(svg, Not(HasSubstr("a < b")));
}

TEST(SvgChart, ACurveWithoutValuesOnlyTakesAColour) {
  Chart chart = OneCurve({1.0, 2.0});
  chart.curves.insert(chart.curves.begin(), ChartCurve{});
  EXPECT_EQ(Points(SvgChart(chart)).size(), 0u);  // the first curve is the empty one
  EXPECT_THAT(SvgChart(chart), HasSubstr("stroke-width=\"1.4\" class=\"line s1\" d=\"M6"));
  EXPECT_THAT(SvgChart(chart), Not(HasSubstr("nan")));
}

TEST(SvgChart, BarsStandOnZero) {
  Chart chart;
  chart.bars.push_back({"bars", 0.0, 1.0, {1.0, 2.0}});
  const std::string svg = SvgChart(chart);
  const std::regex bar(
      "<rect class=\"bar\" x=\"[0-9.]+\" y=\"([0-9.]+)\" width=\"[0-9.]+\" "
      "height=\"([0-9.]+)\"");
  std::vector<double> bottom, height;
  for (std::sregex_iterator it(svg.begin(), svg.end(), bar), end; it != end; ++it) {
    bottom.push_back(std::stod((*it)[1]) + std::stod((*it)[2]));
    height.push_back(std::stod((*it)[2]));
  }
  ASSERT_GE(height.size(), 2u);
  EXPECT_NEAR(bottom[0], bottom[1], 0.11);  // coordinates have one digit behind the point
  EXPECT_NEAR(height[1], 2.0 * height[0], 0.2);
}

}  // namespace
}  // namespace gauntlet::sim
