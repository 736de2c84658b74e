// What the error is made of, by trials without one cause after the other.
#include "sim/study/cause_trials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study_run.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using Causes = std::vector<double>;  // in the order of ErrorCause [deg^2]; no link is set

Causes CausesOf(const Scores& scores) {
  Causes causes;
  for (const TrackingErrorPart& part : TrackingErrorParts()) {
    causes.push_back(scores.summary[part.metric]);
  }
  for (const ErrorCause cause : {ErrorCause::kLinkLoss, ErrorCause::kLinkJitter}) {
    double& part = causes[static_cast<std::size_t>(cause)];
    EXPECT_TRUE(std::isnan(part));
    if (std::isfinite(causes.back())) part = 0.0;
  }
  return causes;
}

double Whole(const Causes& causes) { return std::accumulate(causes.begin(), causes.end(), 0.0); }

class CauseTrialsTest : public testing::Test {
 protected:
  StudyResult Run(const std::vector<std::string>& overrides, StudyOptions options = {}) const {
    const auto file = folder_.path() / "scenario.yaml";
    std::ofstream(file) << "question: q\nglove: {" + channels_ +
                               "motion: {kind: random, duration_s: 4}}\n"
                               "controllers:\n" +
                               controllers_;
    if (options.causes == CauseSeeds::kNone && options.scores.empty()) {
      options.causes = CauseSeeds::kFirst;
    }
    options.jobs = 2;
    return RunStudy(PrepareStudy(LoadScenario(file, overrides)), options);
  }
  Causes Found(const std::vector<std::string>& overrides) const {
    return CausesOf(Run(overrides).seeds[0].controllers[0].scores);
  }

  test::TemporaryDirectory folder_;
  std::string channels_;
  std::string controllers_ = "  raw: {filter: none}\n";
};

/// A key of settings for each cause that a person can switch off.
const std::map<ErrorCause, std::vector<std::string>> kSwitches = {
    {ErrorCause::kNoise, {"glove.noise.kind=none"}},
    {ErrorCause::kGlove,
     {"glove.sensor.gain_deviation_percent=0", "glove.sensor.offset_deviation_percent=0",
      "glove.sensor.curvature_deviation_percent=0", "glove.sensor.cross_talk_percent=0",
      "glove.sensor.hysteresis_deg=0"}},
    {ErrorCause::kLink,
     {"event.delay_ms=0", "event.period_ms=1", "hand.servo.frame_ms=0",
      "hand.arm_servo.frame_ms=0"}},
    {ErrorCause::kSaturation, {"hand.motor_limits=false"}},
    {ErrorCause::kFriction,
     {"hand.motor_friction_scale=0", "hand.servo.play_deg=0", "hand.arm_servo.play_deg=0"}},
    {ErrorCause::kServo, {"hand.servo.kind=ideal", "hand.arm_servo.kind=ideal"}}};

/// What is off has no share, and takes at most a tenth of the whole from each of the others. But
/// the servo: an ideal one holds its spool against friction, too, which so loses its share.
TEST_F(CauseTrialsTest, WhatIsSwitchedOffHasNoShareAndLeavesTheOthers) {
  const Causes all_on = Found({});
  const double whole = Whole(all_on);
  for (const auto& [cause, off] : kSwitches) {
    const Causes found = Found(off);
    for (std::size_t i = 0; i < kErrorCauseCount; ++i) {
      const auto other = static_cast<ErrorCause>(i);
      if (other == cause) {
        EXPECT_NEAR(found[i], 0.0, 1e-9 * whole) << i;
      } else if (cause != ErrorCause::kServo) {
        EXPECT_NEAR(found[i], all_on[i], 0.1 * whole) << static_cast<int>(cause) << " " << i;
      }
    }
  }
}

TEST_F(CauseTrialsTest, SumToTheSquareOfEachJointsError) {
  const StudyResult result = Run({});
  for (const std::vector<double>& row : result.seeds[0].controllers[0].scores.channels) {
    const double whole = std::pow(row[MetricIndex("tracking_rmse_deg")], 2);
    if (!std::isfinite(whole)) continue;  // of a motor or cable
    double sum = 0.0;
    for (const TrackingErrorPart& part : TrackingErrorParts()) {
      if (!Metrics()[part.metric].needs_link) sum += row[part.metric];
    }
    EXPECT_NEAR(sum, whole, 1e-9 * whole);
  }
}

TEST_F(CauseTrialsTest, FindsWeakMotorsAFilterAndALateLink) {
  const auto share = [](const Causes& causes, ErrorCause cause) {
    return causes[static_cast<std::size_t>(cause)] / Whole(causes);
  };
  const Causes weak = Found({"hand.servo.torque_scale=0.05", "hand.arm_servo.torque_scale=0.05"});
  EXPECT_GT(share(weak, ErrorCause::kSaturation), 0.8);
  const Causes late = Found({"event.delay_ms=300"});
  EXPECT_GT(share(late, ErrorCause::kLink), 0.75);
  EXPECT_LT(share(late, ErrorCause::kSaturation), 0.05);
  controllers_ = "  slow: {filter: {kind: moving_average, window: 600}}\n";
  EXPECT_GT(share(Found({}), ErrorCause::kController), 0.6);
}

TEST_F(CauseTrialsTest, AreOfTheSeedsThatAreAskedFor) {
  const auto known = [](const TrialOutcome& outcome) {
    return std::isfinite(Whole(CausesOf(outcome.scores)));
  };
  const StudyResult first = Run({}, {.seeds = 2});
  EXPECT_TRUE(known(first.seeds[0].controllers[0]));
  EXPECT_FALSE(known(first.seeds[1].controllers[0]));
  ASSERT_EQ(first.first_others.size(), 1u);
  EXPECT_EQ(first.first_others[0].without[0], first.first_twins[0]->hand_angle_rad);
  const StudyResult all = Run({}, {.seeds = 2, .causes = CauseSeeds::kAll});
  EXPECT_TRUE(known(all.seeds[1].controllers[0]));
  EXPECT_EQ(CausesOf(all.seeds[0].controllers[0].scores),
            CausesOf(first.seeds[0].controllers[0].scores));
  const StudyResult named =
      Run({}, {.seeds = 2, .keep_first_traces = false, .scores = {MetricIndex("error_link_deg2")}});
  EXPECT_EQ(named.seeds[1].controllers[0].scores.summary[MetricIndex("error_link_deg2")],
            all.seeds[1].controllers[0].scores.summary[MetricIndex("error_link_deg2")]);
}

/// What is stored of another run says no more than what was asked for now.
class Kept final : public TrialStore {
 public:
  bool Has(int seed, std::size_t) override { return trials_.contains(seed); }
  std::optional<TrialOutcome> Take(int seed, std::size_t) override {
    if (!trials_.contains(seed)) return std::nullopt;
    ++taken;
    return trials_[seed];
  }
  void Keep(int seed, std::size_t, const TrialOutcome& outcome) override {
    ++kept;
    trials_[seed] = outcome;
  }

  int taken = 0;
  int kept = 0;

 private:
  std::map<int, TrialOutcome> trials_;
};

TEST_F(CauseTrialsTest, DoNotDependOnWhatIsStored) {
  const auto of_second = [this](CauseSeeds causes, TrialStore* store) {
    return CausesOf(
        Run({},
            {.seeds = 2, .jobs = 1, .keep_first_traces = false, .causes = causes, .store = store})
            .seeds[1]
            .controllers[0]
            .scores);
  };
  Kept store;
  EXPECT_THAT(of_second(CauseSeeds::kFirst, &store), testing::Each(testing::IsNan()));
  EXPECT_EQ(store.kept, 2);
  const Causes all = of_second(CauseSeeds::kAll, &store);
  EXPECT_EQ(all, of_second(CauseSeeds::kAll, nullptr));
  EXPECT_EQ(store.kept, 3);  // the first had them
  EXPECT_THAT(of_second(CauseSeeds::kFirst, &store), testing::Each(testing::IsNan()));
  EXPECT_EQ(store.kept, 3);
}

TEST_F(CauseTrialsTest, OfARecordedGloveKnowNeitherNoiseNorItsErrors) {
  std::ofstream table(folder_.path() / "glove.csv");
  table << "time_s,index_pip,ring_pip\n";
  for (int k = 0; k < 200; ++k) {
    table << 0.02 * k << "," << 40 + 20 * std::sin(0.1 * k) << "," << 50 - 0.2 * (k % 50) << "\n";
  }
  table.close();
  channels_ = "channels: [index_pip, ring_pip], noise: none, ";
  const Causes causes = Found({"glove.motion={kind: recording, use: measured, file: " +
                               (folder_.path() / "glove.csv").string() + "}"});
  EXPECT_TRUE(std::isnan(causes[0]));
  EXPECT_TRUE(std::isnan(causes[1]));
  EXPECT_GT(causes[static_cast<std::size_t>(ErrorCause::kLink)], 0.0);
  EXPECT_TRUE(std::isfinite(causes.back()));
}

/// One that filters at events keeps them: without its frames it would be another filter.
TEST_F(CauseTrialsTest, LeaveTheFilterAsItIs) {
  controllers_ = "  slow: {filter: {kind: moving_average, window: 20}, filter_at: event}\n";
  const Causes at_events = Found({});
  controllers_ = "  slow: {filter: {kind: moving_average, window: 400}}\n";
  const Causes at_samples = Found({});
  const auto control = static_cast<std::size_t>(ErrorCause::kController);
  EXPECT_NEAR(at_events[control] / Whole(at_events), at_samples[control] / Whole(at_samples), 0.08);
}

}  // namespace
}  // namespace gauntlet::sim
