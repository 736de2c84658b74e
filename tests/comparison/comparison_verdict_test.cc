// The sentence that stands first on the page and last below the table.
#include "sim/comparison/comparison_verdict.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace gauntlet::sim {
namespace {

struct Entry {
  std::string name;
  double tracking_deg;
  double jitter_deg;
  bool follows_as_well_as_best;
  bool shakes_as_little_as_least;
};

Summary Of(const std::vector<Entry>& entries) {
  const std::size_t tracking = MetricIndex("tracking_rmse_deg");
  const std::size_t jitter = MetricIndex("jitter_rms_deg");
  Summary summary;
  summary.baseline = 0;
  summary.one_run = false;
  for (const Entry& entry : entries) {
    ControllerSummary& controller = summary.controllers.emplace_back();
    controller.name = entry.name;
    controller.summary.resize(Metrics().size());
    controller.summary[tracking].mean = entry.tracking_deg;
    controller.summary[jitter].mean = entry.jitter_deg;
    controller.rank.assign(Metrics().size(), 1);
    for (const Entry& other : entries) {
      controller.rank[tracking] += other.tracking_deg < entry.tracking_deg;
      controller.rank[jitter] += other.jitter_deg < entry.jitter_deg;
    }
    controller.to_best.resize(Metrics().size());
    controller.as_good_as_best.assign(Metrics().size(), false);
    controller.as_good_as_best[tracking] = entry.follows_as_well_as_best;
    controller.as_good_as_best[jitter] = entry.shakes_as_little_as_least;
  }
  return summary;
}

TEST(Verdict, NamesTheOneThatIsBestInBoth) {
  EXPECT_EQ(
      VerdictOf(Of({{"raw", 5.0, 0.5, false, false}, {"filter", 4.0, 0.2, true, true}})).Text(),
      "filter follows best (4.00 deg RMS) and shakes least (0.200 deg RMS); raw: "
      "5.00 and 0.500.");
}

TEST(Verdict, AmongEqualFollowersTakesTheCalmest) {
  EXPECT_EQ(
      VerdictOf(Of({{"raw", 4.9, 0.5, true, false},
                    {"calm", 5.0, 0.3, true, false},
                    {"late", 6.0, 0.1, false, true}}))
          .Text(),
      "calm follows as well as any (5.00 deg RMS, jitter 0.300); late shakes least (0.100 deg "
      "RMS, tracking 6.00); raw: 4.90 and 0.500.");
}

TEST(Verdict, AdmitsThatNoFilterIsBetter) {
  EXPECT_EQ(
      VerdictOf(Of({{"raw", 4.0, 0.1, true, true}, {"filter", 5.0, 0.2, false, false}})).Text(),
      "raw follows best (4.00 deg RMS) and shakes least (0.100 deg RMS).");
}

TEST(Verdict, SaysWhereItIsUndecided) {
  Summary summary = Of({{"raw", 4.9, 0.5, false, false}, {"calm", 4.8, 0.3, true, true}});
  summary.controllers[0].to_best[MetricIndex("tracking_rmse_deg")].judgement =
      Judgement::kUndecided;
  EXPECT_EQ(VerdictOf(summary).Text(),
            "calm may follow best (4.80 deg RMS) and shakes least (0.300 deg RMS); raw: 4.90 and "
            "0.500.");
}

TEST(Verdict, TellsWhatItCosts) {
  Summary summary = Of({{"raw", 5.0, 0.5, true, false}, {"late", 5.1, 0.2, true, true}});
  summary.controllers[1].to_baseline.resize(Metrics().size());
  summary.controllers[1].to_baseline[MetricIndex("delay_ms")].judgement = Judgement::kWorse;
  summary.controllers[1].summary[MetricIndex("delay_ms")].mean = 80.0;
  EXPECT_EQ(VerdictOf(summary).Text(),
            "late follows as well as any (5.10 deg RMS) and shakes least (0.200 deg RMS); raw: "
            "5.00 and 0.500. late is worse than raw in delay_ms.");
}

TEST(Verdict, RecommendsWhoFollowsBestAndNamesTheOthersThatMayBeTaken) {
  const Summary summary = Of({{"raw", 4.9, 0.5, true, false},
                              {"calm", 5.0, 0.3, true, false},
                              {"late", 6.0, 0.1, false, true},
                              {"bad", 9.0, 0.9, false, false}});
  const Verdict verdict = VerdictOf(summary);
  EXPECT_EQ(verdict.recommended, "calm");
  EXPECT_EQ(verdict.alternatives, (std::vector<std::string>{"raw", "late"}));
  const auto json = nlohmann::json::parse(JsonOf(verdict).dump());
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["recommended"], "calm");
  EXPECT_EQ(json["reasons"][0]["key"], "tracking_and_jitter");
  EXPECT_TRUE(json["warnings"].empty());
}

TEST(Verdict, RecommendsNobodyWhereItIsUndecidedOrOneRun) {
  Summary summary = Of({{"raw", 4.9, 0.5, false, false}, {"calm", 4.8, 0.3, true, true}});
  summary.controllers[0].to_best[MetricIndex("tracking_rmse_deg")].judgement =
      Judgement::kUndecided;
  EXPECT_EQ(VerdictOf(summary).recommended, "");
  EXPECT_EQ(VerdictOf(summary).alternatives, (std::vector<std::string>{"raw", "calm"}));
  EXPECT_TRUE(JsonOf(VerdictOf(summary))["recommended"].is_null());
  summary.one_run = true;
  EXPECT_EQ(VerdictOf(summary).recommended, "");
  EXPECT_TRUE(VerdictOf(summary).alternatives.empty());
}

TEST(Verdict, OfOneRunSpeaksOfThatRunAlone) {
  Summary summary = Of({{"raw", 4.9, 0.5, false, false}, {"calm", 5.0, 0.3, false, false}});
  summary.one_run = true;
  EXPECT_EQ(VerdictOf(summary).Text(),
            "In this one run raw follows nearest (4.90 deg RMS, jitter 0.500); calm shakes least "
            "(0.300 deg RMS, tracking 5.00).");
}

TEST(Verdict, OfOneControllerJudgesNothing) {
  EXPECT_EQ(VerdictOf(Of({{"only", 4.0, 0.1, true, true}})).Text(),
            "only follows within 4.00 deg RMS and shakes by 0.100 deg RMS.");
}

}  // namespace
}  // namespace gauntlet::sim
