// Which controller a comparison recommends, and in which words.
#include "sim/answers/compare/comparison_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "sim/base/json.h"
#include "tests/comparison/simulated_comparisons.h"

namespace gauntlet::sim {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A controller by the means of its primary scores. D is 0.5 deg, 5 ms and 0.05 deg.
struct Entry {
  std::string name;
  double tracking_deg;
  double delay_ms;
  double jitter_deg;
};

/// Differences have intervals of +- `half_width` D.
Summary Of(const std::vector<Entry>& entries, double half_width = 0.2) {
  Summary summary;
  summary.baseline = 0;
  summary.one_run = false;
  summary.motions = 25;
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t delay = MetricIndex("delay_ms");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  for (const Entry& entry : entries) {
    ControllerSummary& controller = summary.controllers.emplace_back();
    controller.name = entry.name;
    controller.summary.resize(Metrics().size());
    controller.has_score.assign(Metrics().size(), false);
    controller.to_baseline.resize(Metrics().size());
    for (const auto& [metric, value] : {std::pair{tracking, entry.tracking_deg},
                                        {delay, entry.delay_ms},
                                        {jitter, entry.jitter_deg}}) {
      controller.summary[metric] = {.mean = value, .low = value - 0.01, .high = value + 0.01};
      controller.has_score[metric] = std::isfinite(value);
    }
  }
  summary.comparisons.resize(Metrics().size() * entries.size() * entries.size());
  for (const std::size_t metric : {tracking, delay, jitter}) {
    const double relevant = Metrics()[metric].relevant_difference.absolute;
    for (std::size_t a = 0; a < entries.size(); ++a) {
      for (std::size_t b = 0; b < entries.size(); ++b) {
        const double mean = summary.controllers[a].summary[metric].mean -
                            summary.controllers[b].summary[metric].mean;
        if (a == b || !std::isfinite(mean)) continue;
        const MeanInterval difference{.mean = mean,
                                      .low = mean - half_width * relevant,
                                      .high = mean + half_width * relevant};
        summary.comparisons[summary.Place(metric, a, b)] = {
            .difference = difference,
            .relevant_difference = relevant,
            .judgement = JudgeDifference(difference, relevant, true)};
        if (b == 0) summary.controllers[a].to_baseline[metric] = summary.Of(metric, a, b);
      }
    }
  }
  return summary;
}

std::vector<std::string> Names(const Summary& summary) {
  std::vector<std::string> names;
  for (const std::size_t c : AnswerOf(summary).order) names.push_back(summary.controllers[c].name);
  return names;
}

const std::vector<Entry> kDoor = {{"raw", 6.4, 104, 0.28},
                                  {"mean", 6.6, 116, 0.10},
                                  {"kalman", 6.4, 106, 0.13},
                                  {"prediction", 4.4, 59, 0.21}};

TEST(ComparisonVerdict, RecommendsTheBestTrackerAndNamesThePriceOfLessJitter) {
  const Summary summary = Of(kDoor);
  const Verdict verdict = AnswerOf(summary).verdict;
  EXPECT_EQ(verdict.recommended, "prediction");
  EXPECT_THAT(verdict.alternatives, ElementsAre("kalman"));  // mean is late: dominated
  EXPECT_EQ(verdict.Text(),
            "Use prediction: tracking error 4.40 deg RMS (raw 6.40), delay 59.0 ms (raw 104) and "
            "jitter 0.210 deg RMS (raw 0.280). No score is clearly worse. Use kalman if jitter "
            "matters more: 0.130 deg RMS "
            "instead of 0.210, but tracking error 6.40 deg RMS instead of 4.40 and delay 106 ms "
            "instead of 59.0.");
  EXPECT_THAT(Names(summary), ElementsAre("prediction", "kalman", "raw", "mean"));
  EXPECT_THAT(AnswerOf(summary).roles, ElementsAre("baseline", "", "less jitter", "recommended"));
}

TEST(ComparisonVerdict, ShowsTheBaselineTheRecommendedAndTheFirstAlternative) {
  EXPECT_THAT(AnswerOf(Of(kDoor)).shown, ElementsAre(0, 3, 2));
  Summary one_run = Of(kDoor);
  one_run.one_run = true;
  EXPECT_THAT(AnswerOf(one_run).shown, ElementsAre(0, 3, 2));  // the next by tracking error
}

TEST(ComparisonVerdict, FollowsThePriorityOfTheUser) {
  Summary summary = Of(kDoor);
  summary.priority = ParsePriority("jitter");
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "kalman");
  EXPECT_THAT(AnswerOf(summary).verdict.alternatives, ElementsAre("prediction"));
  summary.priority = ParsePriority("delay");
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "prediction");
  summary.priority = ParsePriority("tracking, jitter_rms_deg<=0.2");
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "kalman");
  summary.priority = ParsePriority("jitter_rms_deg<=0.09, delay_ms<=60");
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "");
  EXPECT_EQ(AnswerOf(summary).verdict.Text(),
            "No controller meets jitter_rms_deg<=0.09 and delay_ms<=60.");
  summary.priority = ParsePriority("jitter_rms_deg<=0.215");  // the interval ends at 0.22
  EXPECT_THAT(
      AnswerOf(summary).verdict.Text(),
      HasSubstr("prediction meets jitter_rms_deg<=0.215 (95 % CI 0.200 to 0.220) in the mean "
                "only."));
}

TEST(ComparisonVerdict, TakesTheLeastJitterOfEquivalentTrackers) {
  const Verdict verdict =
      AnswerOf(Of({{"raw", 5.0, 100, 0.5}, {"a", 4.0, 100, 0.4}, {"b", 4.2, 100, 0.2}})).verdict;
  EXPECT_EQ(verdict.recommended, "b");
  EXPECT_THAT(verdict.alternatives, ElementsAre());
  EXPECT_EQ(verdict.Text(),
            "Use b: tracking error 4.20 deg RMS (raw 5.00) and jitter 0.200 deg RMS (raw 0.500); "
            "delay equivalent. No score is clearly worse.");
}

TEST(ComparisonVerdict, StaysAtTheBaselineWhereNothingIsBetter) {
  const Verdict verdict =
      AnswerOf(Of({{"raw", 5.0, 100, 0.20}, {"a", 4.9, 99, 0.19}, {"late", 4.9, 120, 0.2}}))
          .verdict;
  EXPECT_EQ(verdict.recommended, "raw");
  EXPECT_EQ(verdict.Text(),
            "Use raw, the baseline: tracking error 5.00 deg RMS, delay 100 ms and jitter 0.200 deg "
            "RMS. No other controller is clearly better in tracking error.");
}

TEST(ComparisonVerdict, LeavesTheBaselineOnlyForABetterController) {
  // Both are 0.9 D +- 1 D better in tracking error: undecided. The baseline is within 2 D of them.
  const std::vector<Entry> entries = {
      {"raw", 5.0, 100, 0.20}, {"a", 4.55, 100, 0.20}, {"b", 4.56, 100, 0.19}};
  EXPECT_EQ(AnswerOf(Of(entries, 1.0)).verdict.recommended, "raw");
  // The baseline may be 2.9 D worse, which is too much, and the others are not better for certain.
  const Verdict wide = AnswerOf(Of(entries, 2.0)).verdict;
  EXPECT_EQ(wide.recommended, "");
  EXPECT_THAT(wide.Text(),
              HasSubstr("No recommendation: the tracking error, delay and jitter of raw"));
  // A baseline that breaks a bound cannot be kept.
  Summary bounded = Of({{"raw", 5.0, 100, 0.30}, {"a", 5.0, 100, 0.26}}, 0.1);
  bounded.priority = ParsePriority("tracking, jitter_rms_deg<=0.28");
  EXPECT_EQ(AnswerOf(bounded).verdict.recommended, "a");
}

TEST(ComparisonVerdict, NamesTies) {
  Summary summary = Of(
      {{"raw", 9.0, 100, 0.9}, {"a", 4.0, 100, 0.21}, {"b", 4.1, 101, 0.20}, {"c", 4.1, 99, 0.2}});
  const std::size_t reversals = MetricIndex("command_reversals_per_s");
  for (const auto& [c, value] : {std::pair{1, 14.0}, {2, 20.0}, {3, 16.0}}) {
    summary.controllers[static_cast<std::size_t>(c)].summary[reversals].mean = value;
  }
  Verdict verdict = AnswerOf(summary).verdict;
  EXPECT_EQ(verdict.recommended, "a");
  EXPECT_THAT(verdict.Text(), HasSubstr("Equivalent: b and c."));
  EXPECT_THAT(AnswerOf(summary).roles,
              ElementsAre("baseline", "recommended", "equivalent", "equivalent"));
  // a becomes worse than the baseline in delay, b and c do not.
  summary.comparisons[summary.Place(MetricIndex("delay_ms"), 1, 0)].judgement = Judgement::kWorse;
  verdict = AnswerOf(summary).verdict;
  EXPECT_EQ(verdict.recommended, "c");
  EXPECT_THAT(verdict.Text(), HasSubstr("Equivalent: a and b."));
}

TEST(ComparisonVerdict, WithoutABaselineNamesNoneOfEqualControllers) {
  Summary summary = Of({{"a", 4.0, 100, 0.21}, {"b", 4.1, 101, 0.20}, {"c", 4.1, 99, 0.2}});
  summary.baseline.reset();
  const std::size_t reversals = MetricIndex("command_reversals_per_s");
  for (const auto& [c, value] : {std::pair{0, 14.0}, {1, 20.0}, {2, 16.0}}) {
    summary.controllers[static_cast<std::size_t>(c)].summary[reversals].mean = value;
  }
  const Verdict verdict = AnswerOf(summary).verdict;
  EXPECT_EQ(verdict.recommended, "");
  EXPECT_THAT(verdict.alternatives, ElementsAre("a", "b", "c"));
  EXPECT_EQ(verdict.Text(),
            "Equivalent, use any: a, b and c (tracking error 4.00 to 4.10 deg RMS, delay 99.0 to "
            "101 ms and jitter 0.200 to 0.210 deg RMS).");
  EXPECT_THAT(AnswerOf(summary).roles, ElementsAre("equivalent", "equivalent", "equivalent"));
  // Fewer reversals than one of the two is not enough.
  summary.comparisons[summary.Place(reversals, 0, 1)].judgement = Judgement::kBetter;
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "");
  summary.comparisons[summary.Place(reversals, 0, 2)].judgement = Judgement::kBetter;
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "a");
  EXPECT_THAT(AnswerOf(summary).shown, ElementsAre(0, 1, 2));  // not a alone
  EXPECT_THAT(AnswerOf(summary).verdict.Text(),
              HasSubstr("Equivalent, but with more command reversals per s than a (14.0): b (20.0) "
                        "and c (16.0)."));
}

TEST(ComparisonVerdict, WithoutABaselineRecommendsWhatIsBetterThanEachOther) {
  Summary summary = Of({{"a", 4.0, 100, 0.4}, {"b", 5.0, 100, 0.2}, {"c", 5.0, 100, 0.4}});
  summary.baseline.reset();
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "a");
  EXPECT_THAT(AnswerOf(summary).verdict.alternatives, ElementsAre("b"));
  // With wide intervals a is not better than b in tracking error.
  Summary wide = Of({{"a", 4.0, 100, 0.4}, {"b", 4.6, 100, 0.4}}, 1.3);
  wide.baseline.reset();
  EXPECT_EQ(AnswerOf(wide).verdict.recommended, "");
  EXPECT_THAT(AnswerOf(wide).verdict.Text(),
              HasSubstr("No recommendation: the tracking error, delay and "
                        "jitter of a (4.00 deg RMS) and b (4.60 deg RMS) "
                        "are undecided."));
}

TEST(ComparisonVerdict, SaysThePriceOfTheRecommendedOne) {
  Summary summary = Of({{"raw", 9.0, 100, 0.2}, {"a", 4.0, 100, 0.2}});
  ASSERT_EQ(AnswerOf(summary).verdict.recommended, "a");
  EXPECT_THAT(AnswerOf(summary).verdict.Answer(), testing::Contains("No score is clearly worse."));
  const std::size_t aligned = MetricIndex("aligned_rmse_deg");
  summary.controllers[0].summary[aligned].mean = 2.5;
  summary.controllers[1].summary[aligned].mean = 3.5;
  summary.controllers[1].to_baseline[aligned].judgement = Judgement::kWorse;
  EXPECT_THAT(AnswerOf(summary).verdict.Answer(),
              testing::Contains("Worse: aligned error 3.50 deg RMS (raw 2.50)."));
  // A primary score that is worse stands in the recommendation already.
  const Verdict late = AnswerOf(Of({{"raw", 9.0, 100, 0.2}, {"a", 4.0, 120, 0.2}})).verdict;
  ASSERT_EQ(late.recommended, "a");
  EXPECT_THAT(late.Text(), HasSubstr("but delay 120 ms (raw 100)"));
  EXPECT_THAT(late.Text(), Not(HasSubstr("clearly worse")));
}

TEST(ComparisonVerdict, CountsASmallUndecidedDifferenceAsEquivalentAndSaysSo) {
  // b - a: 0.4 D +- 1.2 D, undecided, at most 1.6 D = 0.8 deg.
  const std::vector<Entry> entries = {
      {"raw", 9.0, 100, 0.9}, {"a", 4.0, 100, 0.9}, {"b", 4.2, 100, 0.2}};
  const Verdict verdict = AnswerOf(Of(entries, 1.2)).verdict;
  EXPECT_EQ(verdict.recommended, "b");
  EXPECT_THAT(verdict.Text(),
              HasSubstr("The tracking error of b is undecided against a (at most 0.800 deg RMS "
                        "worse), and counts as equivalent."));
}

TEST(ComparisonVerdict, RecommendsNothingWhereALargeDifferenceIsPossible) {
  // a and b may differ by up to 3.4 D in both directions.
  const Verdict verdict =
      AnswerOf(Of({{"raw", 9.0, 100, 0.9}, {"a", 4.0, 100, 0.9}, {"b", 4.2, 100, 0.2}}, 3.0))
          .verdict;
  EXPECT_EQ(verdict.recommended, "");
  EXPECT_THAT(verdict.alternatives, ElementsAre("a", "b"));
  EXPECT_THAT(verdict.Text(), HasSubstr("No recommendation: the tracking error and delay of a "
                                        "(4.00 deg RMS) and b (4.20 deg RMS) are undecided."));
  EXPECT_TRUE(JsonOf(verdict)["recommended"].is_null());
}

TEST(ComparisonVerdict, RecommendsNothingAfterOneRun) {
  Summary summary = Of(kDoor);
  summary.one_run = true;
  const Verdict verdict = AnswerOf(summary).verdict;
  EXPECT_EQ(verdict.recommended, "");
  EXPECT_EQ(
      verdict.Text(),
      "One run has no confidence interval, so nothing is recommended. Least tracking error: "
      "prediction (4.40 deg RMS). Least delay: prediction (59.0 ms). Least jitter: mean (0.100 "
      "deg RMS).");
  EXPECT_THAT(AnswerOf(summary).roles, ElementsAre("baseline", "", "", ""));
}

TEST(ComparisonVerdict, LeavesOutAScoreThatAControllerHasNoValueOf) {
  std::vector<Entry> entries = kDoor;
  entries[1].delay_ms = kNone;
  const Summary summary = Of(entries);
  const Verdict verdict = AnswerOf(summary).verdict;
  EXPECT_EQ(verdict.recommended, "prediction");
  EXPECT_THAT(verdict.Text(), HasSubstr("The delay has no value for some controllers, so it is not "
                                        "judged."));
  EXPECT_THAT(verdict.Text(), Not(HasSubstr("59.0 ms")));
  Summary is_short = summary;
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    is_short.no_value.push_back(WhyNoValue(m, 10.0, 0.5));
  }
  EXPECT_THAT(AnswerOf(is_short).verdict.Text(),
              HasSubstr("it is searched in a quarter of the motion, 0.12 s"));
  Summary by_delay = summary;
  by_delay.priority = ParsePriority("delay");
  EXPECT_EQ(AnswerOf(by_delay).verdict.recommended, "");
}

TEST(ComparisonVerdict, DoesNotJudgeWhatFailed) {
  Summary summary = Of(kDoor);
  summary.controllers[3].failed_trials = 1;
  summary.controllers[3].has_score.assign(Metrics().size(), false);
  EXPECT_EQ(AnswerOf(summary).verdict.recommended, "kalman");
  EXPECT_THAT(AnswerOf(summary).roles[3], "failed");
}

TEST(ComparisonVerdict, OfOneControllerGivesItsScores) {
  EXPECT_EQ(AnswerOf(Of({kDoor[0]})).verdict.Text(),
            "raw: tracking error 6.40 deg RMS, delay 104 ms and jitter 0.280 deg RMS.");
}

TEST(ComparisonVerdict, SaysWhatIsAssumedBehindTheAnswer) {
  Summary summary = Of(kDoor);
  summary.assumed = {"a.csv: assumed: joint of index_pip."};
  const Verdict verdict = AnswerOf(summary).verdict;
  EXPECT_THAT(verdict.Text(), testing::StartsWith("Use "));
  ASSERT_FALSE(verdict.Answer().empty());
  EXPECT_EQ(verdict.Answer().back(), "a.csv: assumed: joint of index_pip.");
  EXPECT_EQ(JsonOf(verdict)["warnings"][0]["key"], "assumed");
}

TEST(ComparisonVerdict, WarnsOfAnArmThatMakesMoreThanATenthOfTheFingersJitter) {
  const auto warned = [](double jitter_deg, double first_share, int seeds) {
    Summary summary = Of(kDoor);
    double share = first_share;
    for (ControllerSummary& controller : summary.controllers) {
      controller.summary[MetricIndex("finger_jitter_rms_deg")].mean = jitter_deg;
      MeanInterval& of_arm = controller.summary[MetricIndex("arm_share_of_finger_jitter")];
      of_arm.mean = share;
      summary.causes.seeds = seeds;
      share = 0.04;
    }
    return AnswerOf(summary).verdict.Doubts();
  };
  EXPECT_THAT(warned(0.08, 0.42, 1),
              testing::Contains("The arm makes 4 to 42 % of the finger jitter (first seed)."));
  EXPECT_THAT(warned(0.08, 0.42, 8),
              testing::Contains("The arm makes 4 to 42 % of the finger jitter."));
  EXPECT_THAT(warned(0.08, 0.1, 8), testing::Not(testing::Contains(testing::HasSubstr("arm"))));
  EXPECT_THAT(warned(0.004, 0.42, 8), testing::Not(testing::Contains(testing::HasSubstr("arm"))));
}

TEST(ComparisonVerdict, WarnsOfSaturationInterpenetrationAndOneMotion) {
  Summary summary = Of(kDoor);
  summary.motions = 1;
  for (ControllerSummary& controller : summary.controllers) {
    controller.summary[MetricIndex("digit_overlap_share")].mean = 0.25;
    const bool drops = controller.name == "raw" || controller.name == "mean";
    controller.summary[MetricIndex("object_dropped_share")].mean = drops ? 0.5 : 0.0;
    controller.summary[ErrorWithAll()].mean = 4.0;
    controller.summary[MetricIndex("error_without_saturation_deg")].mean = 3.7;
  }
  EXPECT_THAT(AnswerOf(summary).verdict.Doubts(),
              ElementsAre("One motion: the confidence intervals cover noise only.",
                          "Motors saturate: without their limits, the tracking error of "
                          "prediction is 3.70 deg in place of 4.00.",
                          "Fingers interpenetrate for 25 % of the time (hand.contact).",
                          "The object falls with raw in 50 % of trials and with mean in 50 %."));
}

TEST(ComparisonVerdict, WarnsOfSaturationFromATenthOfTheSquaredErrorOn) {
  const auto warned = [](double without_deg, std::size_t known) {
    Summary summary = Of(kDoor);
    summary.causes.seeds = 1;
    summary.causes.stretch_s = 4.5;
    for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
      std::vector<MeanInterval>& values = summary.controllers[c].summary;
      values[ErrorWithAll()].mean = c == known ? 4.0 : NAN;
      values[MetricIndex("error_without_saturation_deg")].mean = c == known ? without_deg : NAN;
    }
    return AnswerOf(summary).verdict.Doubts();
  };
  const std::size_t baseline = *Of(kDoor).baseline;
  const std::string name = Of(kDoor).controllers[baseline].name;
  EXPECT_THAT(
      warned(3.79, baseline),
      testing::Contains("Motors saturate: without their limits, the tracking error of " + name +
                        " is 3.79 deg in place of 4.00 (first 4.5 s of the first seed)."));
  EXPECT_THAT(warned(3.80, baseline),
              testing::Not(testing::Contains(testing::HasSubstr("Motors saturate"))));
}

TEST(ComparisonVerdict, RarelyRecommendsWhatIsWorseByTwiceTheSmallestRelevantDifference) {
  for (const double scatter : {0.3, 1.0, 3.0}) {
    for (const Scatter shape : {Scatter::kNormal, Scatter::kSkewed}) {
      const RecommendationOutcome outcome = SimulateRecommendations(
          {.truth = Truth::kUniform, .scatter = shape, .scatter_size = scatter, .studies = 1000});
      EXPECT_LE(outcome.too_bad, 0.05) << scatter;
      if (scatter <= 1.0) {
        EXPECT_GE(outcome.recommended, 0.7) << scatter;
      }
    }
  }
}

TEST(ComparisonVerdict, RarelyNamesOneOfEqualControllers) {
  for (const int controllers : {4, 6}) {
    for (const int seeds : {8, 16}) {
      for (const double scatter : {0.3, 0.5, 0.7, 1.0, 1.5}) {
        const ComparisonsShape shape{.truth = Truth::kEqual,
                                     .scatter_size = scatter,
                                     .noises = seeds,
                                     .controllers = controllers,
                                     .studies = 200};
        const RecommendationOutcome with_baseline = SimulateRecommendations(shape);
        const RecommendationOutcome without = SimulateRecommendations(shape, false);
        EXPECT_LE(with_baseline.recommended - with_baseline.baseline, 0.05)
            << controllers << " controllers, " << seeds << " seeds, " << scatter << " D";
        EXPECT_LE(without.recommended, 0.05)
            << controllers << " controllers, " << seeds << " seeds, " << scatter << " D";
        if (scatter <= 0.5) {  // and the baseline is named where the seeds suffice
          EXPECT_GE(with_baseline.baseline, 0.9) << controllers << ' ' << seeds << ' ' << scatter;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
