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

std::string ItemsOf(const test::MadeUpStudy& made) {
  return HtmlOf(PageHead{.numbers = HeadlineDifferences(made.summary)});
}

TEST(Headline, TellsADifferenceInPercentAndADelayInMilliseconds) {
  const test::MadeUpStudy made = Made(-2.0, -40.0, 0.0);
  const std::string name = made.summary.controllers[1].name;
  const std::string baseline = made.summary.controllers[0].name;
  ASSERT_EQ(made.summary.answer.verdict.recommended, name);
  EXPECT_EQ(Headline(made.summary), "Use " + name + " in place of " + baseline + ".");
  const std::string html = ItemsOf(made);
  EXPECT_THAT(html, HasSubstr("<li class=\"good\"><span>tracking error</span> <b>−20 %</b>"));
  EXPECT_THAT(html, HasSubstr("<li class=\"good\"><span>delay</span> <b>−40 ms</b>"));
  EXPECT_THAT(html, HasSubstr("<li><span>jitter</span> <b>equivalent</b>"));
}

TEST(Headline, TellsWhatIsWorse) {
  const test::MadeUpStudy made = Made(-2.0, 30.0, 0.0);
  ASSERT_EQ(made.summary.answer.verdict.recommended, made.summary.controllers[1].name);
  EXPECT_THAT(ItemsOf(made), HasSubstr("<li class=\"warn\"><span>delay</span> <b>+30 ms</b>"));
}

TEST(Headline, EndsWithThePrice) {
  test::MadeUpStudy made = Made(-2.0, -40.0, 0.0);
  const std::size_t aligned = MetricIndex("aligned_rmse_deg");
  made.summary.controllers[1].to_baseline[aligned].judgement = Judgement::kWorse;
  made.summary.comparisons[made.summary.Place(aligned, 1, 0)].judgement = Judgement::kWorse;
  const std::vector<HeadNumber> numbers = HeadlineDifferences(made.summary);
  ASSERT_EQ(numbers.size(), 4u);
  EXPECT_EQ(numbers.back().name, "aligned error");
  EXPECT_EQ(numbers.back().judgement, Judgement::kWorse);
  const std::string html = HtmlOf(PageHead{.numbers = numbers, .of_numbers = "#scores"});
  EXPECT_THAT(html, HasSubstr("<span><a href=\"#scores\">aligned error</a></span>"));
}

TEST(Headline, HasAtMostEightWordsAndNoNumbersWithoutARecommendation) {
  test::MadeUpStudy one = test::MakeUpStudy({.seeds = 1});
  EXPECT_EQ(Headline(one.summary), "One run: no recommendation.");
  EXPECT_TRUE(HeadlineDifferences(one.summary).empty());
  const test::MadeUpStudy alike = Made(0.0, 0.0, 0.0);
  EXPECT_TRUE(HeadlineDifferences(alike.summary).empty());
  for (const test::MadeUpStudy& made : {Made(-2.0, -40.0, 0.0), Made(5.0, 80.0, 1.0), alike}) {
    const std::string headline = Headline(made.summary);
    EXPECT_LE(std::ranges::count(headline, ' '), 7) << headline;
  }
}

PageHead HeadOf(const Verdict& verdict) {
  PageHead head;
  SetAnswer(verdict, head);
  return head;
}

TEST(PageHead, BeginsWithTheBeginningOfTheTerminalsSentence) {
  Verdict verdict{.recommended = "b"};
  verdict.AddHeadline("best_by", "Use b", ": tracking error 2 deg RMS.");
  verdict.AddWarning("without_hand", "Filters <only>.");
  EXPECT_EQ(HeadOf(verdict).headline, "Use b.");
  EXPECT_EQ(HeadOf(verdict).answer, "Use b: tracking error 2 deg RMS.");
  EXPECT_THAT(HtmlOf(HeadOf(verdict)),
              HasSubstr("<p class=\"note warn\">Filters &lt;only&gt;.</p>"));
  verdict.AddUndecided({"c", "d"}, "More seeds can decide it.", "setting");
  EXPECT_EQ(HeadOf(verdict).headline, "No recommendation.");
  EXPECT_THAT(HeadOf(verdict).answer, HasSubstr("undecided against 2 other settings."));
}

TEST(PageHead, DoesNotRepeatAHeadlineThatIsAWholeSentence) {
  PageHead head;
  SetAnswer("5 sensors, 50.2 Hz: 1 dead (A3). Two senders.", head);
  EXPECT_EQ(head.headline, "5 sensors, 50.2 Hz: 1 dead (A3).");
  EXPECT_EQ(head.answer, "Two senders.");
  SetAnswer("5 sensors.", head);
  EXPECT_EQ(head.answer, "");
}

}  // namespace
}  // namespace gauntlet::sim
