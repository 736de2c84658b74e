// Links in whole trials: what they change, and what not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "sim/trial/link/frame_draws.h"
#include "sim/trial/link/link_config.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using Overrides = std::vector<std::string>;

class LinkTrials : public testing::Test {
 protected:
  StudyResult Run(const Overrides& overrides, const StudyOptions& options = {}) const {
    const auto file = folder_.path() / "scenario.yaml";
    std::ofstream(file) << "question: q\n"
                           "glove: {channels: [index_mcp, index_pip, wrist_flexion],\n"
                           "        motion: {kind: random, duration_s: 3, range_percent: 60}}\n"
                           "controllers: {raw: {filter: none}}\n";
    return RunStudy(PrepareStudy(LoadScenario(file, overrides)), options);
  }
  static double Score(const StudyResult& result, const char* key) {
    return result.seeds[0].controllers[0].scores.summary[MetricIndex(key)];
  }
  /// The whole motion of the hand.
  Signal HandOf(const Overrides& overrides) const {
    return Run(overrides).first_traces[0].hand_angle_rad;
  }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(LinkTrials, ALinkThatDoesNothingChangesNoBit) {
  const Signal without = HandOf({});
  EXPECT_EQ(HandOf({"link.glove.preset=none"}), without);
  EXPECT_EQ(HandOf({"link.hand.preset=none"}), without);
  EXPECT_EQ(HandOf({"link.glove.receiver={kind: buffer, delay_ms: 0}",
                    "link.hand.receiver={kind: buffer, delay_ms: 0}"}),
            without);
  EXPECT_EQ(HandOf({"link.glove.receiver=queue", "link.hand.receiver=queue"}), without);
  EXPECT_EQ(HandOf({"link.glove.receiver={kind: newest, gap: predict}",
                    "link.hand.receiver={kind: newest, gap: predict}", "link.glove.watchdog=tiers",
                    "link.hand.watchdog=tiers"}),
            without);
}

TEST_F(LinkTrials, ADelayOfTheLinkIsOneOfTheEvent) {
  EXPECT_EQ(HandOf({"event.delay_ms=5", "link.hand.delay={kind: constant, delay_ms: 20}"}),
            HandOf({}));
}

TEST_F(LinkTrials, ScoresOfLinksExistWithALinkAlone) {
  const StudyResult without = Run({});
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    if (!Metrics()[m].needs_link) continue;
    EXPECT_TRUE(std::isnan(without.seeds[0].controllers[0].scores.summary[m])) << Metrics()[m].key;
  }
  EXPECT_EQ(without.first_traces[0].sample_age_s.cols(), 0);
  // A frame is 25 ms old when it arrives, and held for 20 ms. At first none has come.
  const StudyResult with = Run({"link.hand.preset=none"});
  EXPECT_NEAR(Score(with, "sample_age_p50_ms"), 34.5, 1.0);
  EXPECT_NEAR(Score(with, "sample_age_max_ms"), 44.0, 1e-3);
  EXPECT_NEAR(Score(with, "frozen_share"), 25.0 / (3000.0 - 20.0), 1e-9);
  EXPECT_EQ(Score(with, "watchdog_hold_share"), 0.0);
}

TEST_F(LinkTrials, FrozenShareIsThatOfTheLostFrames) {
  EXPECT_NEAR(
      Score(Run({"link.hand.loss={kind: independent, percent: 30}", "glove.motion.duration_s=20"}),
            "frozen_share"),
      0.3, 4.0 * std::sqrt(0.3 * 0.7 / 1000.0));
}

TEST_F(LinkTrials, WatchdogIsInItsTiersForTheirTimes) {
  // One batch a second: 50 ms as usual, then hold until 200 ms, relax until 600 ms, off.
  const std::string tiers =
      "{kind: tiers, hold_after_ms: 50, relax_after_ms: 200, off_after_ms: 600, good_frames: 1}";
  const StudyResult hand =
      Run({"link.hand.batch_ms=1000", "link.hand.watchdog=" + tiers, "glove.motion.duration_s=9"});
  EXPECT_NEAR(Score(hand, "watchdog_hold_share"), 0.15, 0.02);
  EXPECT_NEAR(Score(hand, "watchdog_relax_share"), 0.4, 0.05);
  EXPECT_NEAR(Score(hand, "watchdog_off_share"), 0.4, 0.05);
  EXPECT_TRUE(hand.seeds[0].controllers[0].health.ok);
  const StudyResult glove = Run(
      {"link.glove.batch_ms=1000", "link.glove.watchdog=" + tiers, "glove.motion.duration_s=9"});
  EXPECT_NEAR(Score(glove, "watchdog_hold_share"), 0.15, 0.02);
  EXPECT_NEAR(Score(glove, "watchdog_off_share"), 0.4, 0.05);
}

TEST_F(LinkTrials, TheCommandNeverJumpsFurtherThanTheWatchdogReturns) {
  const Overrides gaps = {
      "link.glove.loss={kind: gilbert_elliott, begin_percent: 0.3, "
      "mean_frames: 400}",
      "glove.motion.duration_s=6"};
  Overrides watched = gaps;
  // Every gap that is seen at all begins with hold: no frame is older than 2 ms otherwise.
  watched.push_back("link.hand.watchdog={kind: tiers, hold_after_ms: 21, return_deg_s: 200}");
  watched.push_back(
      "link.glove.watchdog={kind: tiers, hold_after_ms: 2, relax_after_ms: 100, off_after_ms: 150, "
      "return_deg_s: 200, relax_deg_s: 200}");
  const double jump = Score(Run(watched), "command_jump_deg");
  EXPECT_GT(Score(Run(gaps), "command_jump_deg"), 2.0 * jump);
  // Of one frame and a count of the coarsest servo, or that of the motion itself.
  const double of_motion =
      Score(Run({"link.glove.preset=none", "glove.motion.duration_s=6"}), "command_jump_deg");
  EXPECT_LE(jump, std::max(of_motion, 200.0 * 0.02 + 0.3));
}

TEST_F(LinkTrials, SeedsDifferInTheLinkAlone) {
  const Overrides still = {
      "glove.motion={kind: hold, duration_s: 1}",   "glove.noise.kind=none",
      "glove.sensor.gain_deviation_percent=0",      "glove.sensor.offset_deviation_percent=0",
      "glove.sensor.curvature_deviation_percent=0", "glove.sensor.cross_talk_percent=0"};
  EXPECT_TRUE(Run(still, {.seeds = 2}).seeds_alike);
  Overrides linked = still;
  linked.push_back("link.hand.delay={kind: gamma, mean_ms: 30, deviation_ms: 30}");
  const StudyResult result = Run(linked, {.seeds = 2});
  EXPECT_FALSE(result.seeds_alike);
  ASSERT_EQ(result.seeds.size(), 2u);
  const auto age = [&](std::size_t seed) {
    return result.seeds[seed].controllers[0].scores.summary[MetricIndex("sample_age_max_ms")];
  };
  EXPECT_NE(age(0), age(1));
}

TEST_F(LinkTrials, AreTheSameOnAnyNumberOfThreads) {
  const Overrides wifi = {"link.glove.preset=wifi", "link.hand.preset=wifi",
                          "link.glove.receiver=adaptive_buffer"};
  const StudyResult one = Run(wifi, {.seeds = 4, .jobs = 1});
  const StudyResult many = Run(wifi, {.seeds = 4, .jobs = 3});
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_THAT(one.seeds[i].controllers[0].scores.summary,
                testing::Pointwise(testing::NanSensitiveDoubleEq(),
                                   many.seeds[i].controllers[0].scores.summary));
  }
}

TEST_F(LinkTrials, WithoutTheLinkNothingOfItIsACause) {
  const Overrides late = {"link.glove.delay={kind: constant, delay_ms: 200}"};
  const StudyResult result = Run(late, {.causes = CauseSeeds::kFirst});
  const double whole = std::pow(Score(result, "tracking_rmse_deg"), 2);
  EXPECT_GT(Score(result, "error_link_deg2"), 0.7 * whole);
}

TEST_F(LinkTrials, ErrorWithoutTheLinkIsThatOfAScenarioWithoutOne) {
  const Overrides links = {"link.glove.preset=wifi", "link.hand.preset=wifi", "event.delay_ms=40"};
  const StudyResult with = Run(links, {.causes = CauseSeeds::kFirst});
  const StudyResult without = Run({"event.delay_ms=0", "event.period_ms=1", "hand.servo.frame_ms=0",
                                   "hand.arm_servo.frame_ms=0"});
  EXPECT_EQ(Score(with, "error_without_link_deg"), Score(without, "tracking_rmse_deg"));
  EXPECT_GT(Score(with, "error_with_all_deg"), 1.5 * Score(with, "error_without_link_deg"));
}

/// Loss, jitter and the mean delay are apart, and together with all others they are the whole.
TEST_F(LinkTrials, LossAndJitterAreCausesOfTheirOwn) {
  const auto causes = [&](const Overrides& overrides) {
    const StudyResult result = Run(overrides, {.causes = CauseSeeds::kFirst});
    double sum = 0.0;
    for (const CauseMetric& part : TrackingErrorParts()) {
      const double value = Score(result, std::string(part.key).c_str());
      if (std::isfinite(value)) sum += value;
    }
    double squares = 0.0;
    int joints = 0;
    for (const std::vector<double>& row : result.seeds[0].controllers[0].scores.channels) {
      const double error = row[MetricIndex("tracking_rmse_deg")];
      if (!std::isfinite(error)) continue;
      squares += error * error;
      ++joints;
    }
    EXPECT_NEAR(sum, squares / joints, 1e-9 * sum);
    return std::array{Score(result, "error_link_loss_deg2"),
                      Score(result, "error_link_jitter_deg2"), Score(result, "error_link_deg2"),
                      sum};
  };
  const std::string lost =
      "link.glove.loss={kind: gilbert_elliott, begin_percent: 1, mean_frames: 150}";
  const std::string varied = "link.hand.delay={kind: gamma, mean_ms: 100, deviation_ms: 120}";
  const auto [loss, no_jitter, delay, whole] = causes({lost});
  EXPECT_GT(loss, 0.3 * whole);
  EXPECT_TRUE(std::isnan(no_jitter));
  const auto [no_loss, jitter, mean_delay, all] = causes({varied});
  EXPECT_TRUE(std::isnan(no_loss));
  EXPECT_GT(std::abs(jitter), 0.02 * all);
  EXPECT_GT(mean_delay, delay);
  const auto [same_delay_no_loss, no_change, steady, sum] =
      causes({"link.hand.delay={kind: constant, delay_ms: 100}"});
  EXPECT_TRUE(std::isnan(same_delay_no_loss));
  EXPECT_TRUE(std::isnan(no_change));
  EXPECT_GT(steady, 0.3 * sum);
}

/// The trial without jitter has the mean delay of each distribution.
TEST_F(LinkTrials, WithoutJitterTheDelayIsTheMean) {
  const auto mean_ms = [](const DelaySettings& settings) {
    return TransportConfig{.delay = {settings}}.WithoutJitter().delay.MeanMs();
  };
  const auto drawn_ms = [](const DelaySettings& settings) {
    constexpr int kDraws = 400'000;
    DelayDraw draw({settings}, {1, "a stream"});
    double sum = 0.0;
    for (int i = 0; i < kDraws; ++i) sum += draw.Next();
    return sum / kDraws;
  };
  for (const DelaySettings& settings :
       {DelaySettings(ConstantDelay{.delay_ms = 7.0}),
        DelaySettings(GammaDelay{.mean_ms = 9.0, .deviation_ms = 12.0}),
        DelaySettings(LogNormalDelay{.p50_ms = 13.0, .p99_ms = 47.0}),
        DelaySettings(HistogramDelay{.bucket_ms = 5.0, .counts = {1.0, 0.0, 3.0}})}) {
    EXPECT_NEAR(mean_ms(settings), drawn_ms(settings), 0.01 * drawn_ms(settings));
  }
  EXPECT_DOUBLE_EQ(TransportConfig{.batch_ms = 20.0}.WithoutJitter().delay.MeanMs(), 10.0);
}

TEST_F(LinkTrials, FiltersAloneHaveNoLink) {
  try {
    Run({"link.glove.preset=wifi"}, {.keep_first_traces = false, .physics = false});
    FAIL();
  } catch (const controller::SettingError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("link: "));
  }
}

}  // namespace
}  // namespace gauntlet::sim
