#include "sim/show/pages/headline.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "tests/report/made_up_study.h"

namespace gauntlet::sim {
namespace {

using ::testing::HasSubstr;

/// Three controllers of which the second is told apart by these differences to the baseline.
test::MadeUpStudy Made(double tracking_deg, double delay_ms, double jitter_deg) {
  test::MadeUpStudy made = test::MakeUpStudy({});
  const std::pair<const char*, std::array<double, 2>> kScores[] = {
      {"tracking_rmse_deg", {10.0, tracking_deg}},
      {"delay_ms", {100.0, delay_ms}},
      {"jitter_rms_deg", {0.2, jitter_deg}}};
  for (const auto& [name, values] : kScores) {
    for (int s = 0; s < 5; ++s) {
      for (int c = 0; c < 3; ++c) {
        const double difference = c == 1 ? values[1] : 0.0;
        made.result.seeds[s].controllers[c].scores.summary[MetricIndex(name)] =
            values[0] + difference + values[0] * 1e-4 * std::cos(3.1 * s + c);
      }
    }
  }
  made.summary = Summarise(made.study, made.result);
  return made;
}

TEST(Headline, TellsADifferenceInPercentAndADelayInMilliseconds) {
  const test::MadeUpStudy made = Made(-2.0, -40.0, 0.0);
  const std::string name = made.summary.controllers[1].name;
  const std::string baseline = made.summary.controllers[0].name;
  ASSERT_EQ(made.summary.answer.verdict.recommended, name);
  EXPECT_EQ(Headline(made.summary), "Use " + name + " in place of " + baseline + ".");
  const std::string html = HeadlineDifferences(made.summary);
  EXPECT_THAT(html, HasSubstr("<li class=\"good\"><span>tracking error</span> <b>−20 %</b>"));
  EXPECT_THAT(html, HasSubstr("<li class=\"good\"><span>delay</span> <b>−40 ms</b>"));
  EXPECT_THAT(html, HasSubstr("<li><span>jitter</span> <b>equivalent</b>"));
}

TEST(Headline, TellsWhatIsWorse) {
  const test::MadeUpStudy made = Made(-2.0, 30.0, 0.0);
  ASSERT_EQ(made.summary.answer.verdict.recommended, made.summary.controllers[1].name);
  EXPECT_THAT(HeadlineDifferences(made.summary),
              HasSubstr("<li class=\"warn\"><span>delay</span> <b>+30 ms</b>"));
}

TEST(Headline, HasAtMostEightWordsAndNoNumbersWithoutARecommendation) {
  test::MadeUpStudy one = test::MakeUpStudy({.seeds = 1});
  EXPECT_EQ(Headline(one.summary), "One run: no recommendation.");
  EXPECT_EQ(HeadlineDifferences(one.summary), "");
  const test::MadeUpStudy alike = Made(0.0, 0.0, 0.0);
  EXPECT_EQ(HeadlineDifferences(alike.summary), "");
  for (const test::MadeUpStudy& made : {Made(-2.0, -40.0, 0.0), Made(5.0, 80.0, 1.0), alike}) {
    const std::string headline = Headline(made.summary);
    EXPECT_LE(std::ranges::count(headline, ' '), 7) << headline;
  }
}

}  // namespace
}  // namespace gauntlet::sim
