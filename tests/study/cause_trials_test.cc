// Causes of the error, by trials without one of them, and without one after the other.
#include "sim/study/cause_trials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
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
  for (const CauseMetric& part : TrackingErrorParts()) {
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
    WriteScenario();
    if (options.causes == CauseSeeds::kNone && options.scores.empty()) {
      options.causes = CauseSeeds::kFirst;
    }
    options.jobs = 2;
    return RunStudy(PrepareStudy(LoadScenario(file(), overrides)), options);
  }
  std::filesystem::path file() const { return folder_.path() / "scenario.yaml"; }
  void WriteScenario() const {
    std::ofstream(file()) << "question: q\nglove: {" + channels_ +
                                 "motion: {kind: random, duration_s: 4}}\n"
                                 "controllers:\n" +
                                 controllers_;
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

double Score(const StudyResult& result, std::string_view key) {
  return result.seeds[0].controllers[0].scores.summary[MetricIndex(key)];
}

/// The trial without one cause is the one that a person runs with the keys of that cause.
TEST_F(CauseTrialsTest, ErrorWithoutOneCauseIsThatOfItsSettings) {
  const StudyResult all_on = Run({});
  EXPECT_EQ(Score(all_on, "error_with_all_deg"), Score(all_on, "tracking_rmse_deg"));
  for (const CauseMetric& error : SwitchedErrors()) {
    const ErrorCause cause = kSwitchedCauses[&error - SwitchedErrors().data()];
    const double plain = Score(Run(kSwitches.at(cause)), "tracking_rmse_deg");
    EXPECT_EQ(Score(all_on, error.key), plain) << error.key;
    // Motors of the project's hand do not saturate in this motion.
    if (cause == ErrorCause::kSaturation) continue;
    EXPECT_GT(std::abs(plain - Score(all_on, "tracking_rmse_deg")), 1e-3) << error.key;
  }
}

/// Rows of all trials for causes; the noise-free one is not for causes alone.
Eigen::Index RowsOfCauses(const StudyResult& result) {
  Eigen::Index rows = 0;
  for (const CauseAngles& angles : result.first_others) {
    for (const Signal& one : angles.switched_off) rows += one.rows();
    for (const Signal& one : angles.without) rows += one.rows();
    rows += angles.arm_at_rest.rows();
  }
  return rows;
}

TEST_F(CauseTrialsTest, TakeAQuarterOfTheSimulatedTimeUnlessTheyAreAskedFor) {
  controllers_ = "  raw: {filter: none}\n  mean: {filter: moving_average}\n";
  const std::string six_s = "glove.motion.duration_s=6";
  const StudyResult cut = Run({six_s}, {.seeds = 8, .causes = CauseSeeds::kAuto});
  const Eigen::Index rows_of_others = 8 * 2 * 2 * 6000;
  EXPECT_EQ(cut.causes.stretch_s, 4.0);
  EXPECT_LE(RowsOfCauses(cut), rows_of_others / 4);
  EXPECT_EQ(RowsOfCauses(cut), 2 * 6 * 4000);
  // They are the begin of the whole trials.
  const StudyResult whole = Run({six_s});
  for (std::size_t i = 0; i < kSwitchedCauseCount; ++i) {
    const Signal& hand = whole.first_others[0].switched_off[i];
    EXPECT_EQ(cut.first_others[0].switched_off[i],
              Signal(hand.topRows(hand.cols() > 0 ? 4000 : 0)));
  }
  EXPECT_EQ(cut.first_others[0].arm_at_rest,
            Signal(whole.first_others[0].arm_at_rest.topRows(4000)));
  // Both errors are of the same time.
  double sum = 0.0;
  for (int joint = 0; joint < 18; ++joint) {
    const auto error = cut.first_traces[0].hand_angle_rad.col(joint).head(4000) -
                       cut.first_reference_rad.col(joint).head(4000);
    sum += kDegPerRad * std::sqrt(error.squaredNorm() / 4000.0);
  }
  EXPECT_NEAR(Score(cut, "error_with_all_deg"), sum / 18.0, 1e-9);
  EXPECT_TRUE(std::isnan(Score(cut, "error_link_deg2")));
  EXPECT_TRUE(std::isnan(cut.seeds[1].controllers[0].scores.summary[ErrorWithAll()]));
}

/// Sensors slip behind the stretch, so the error there says little of the whole.
TEST_F(CauseTrialsTest, AreLeftOutWhereTheErrorOfTheStretchIsNotThatOfTheTrial) {
  const auto found = [this](const std::string& gain) {
    controllers_ = "  raw: {filter: none}\n";
    const StudyResult result =
        Run({"glove.motion.duration_s=6",
             "glove.faults=[{kind: gain_change, start_s: 4.5, gain: " + gain + "}]"},
            {.seeds = 8, .causes = CauseSeeds::kAuto});
    EXPECT_EQ(result.causes.stretch_s, 4.0);
    EXPECT_EQ(RowsOfCauses(result) > 0, std::isfinite(Score(result, "error_with_all_deg")));
    return std::isfinite(Score(result, "error_with_all_deg"));
  };
  EXPECT_TRUE(found("1"));
  EXPECT_FALSE(found("0.2"));
}

TEST_F(CauseTrialsTest, PlanIsOfAllControllersElseOfTheBaselineElseNone) {
  const auto plan = [this](int controllers, int seeds, const std::vector<std::string>& overrides) {
    controllers_.clear();
    for (int c = 0; c < controllers; ++c)
      controllers_ += "  c" + std::to_string(c) + ": {filter: none}\n";
    WriteScenario();
    return PlanCauses(PrepareStudy(LoadScenario(file(), overrides)), seeds, CauseSeeds::kAuto);
  };
  // Six trials for each controller, two others for each controller and seed.
  const CausePlan all = plan(2, 8, {"glove.motion.duration_s=30"});
  EXPECT_EQ(all.stretch_s, 20.0);
  EXPECT_FALSE(all.controller);
  const CausePlan whole = plan(2, 12, {"glove.motion.duration_s=3"});
  EXPECT_TRUE(whole.switched && !whole.ticks && !whole.chain);
  const CausePlan of_one = plan(5, 1, {"glove.motion.duration_s=10", "baseline=c3"});
  EXPECT_EQ(of_one.controller, 3u);
  EXPECT_EQ(of_one.stretch_s, 4.1);
  EXPECT_TRUE(of_one.Has(0, 3) && !of_one.Has(0, 2) && !of_one.Has(1, 3));
  const CausePlan none = plan(4, 1, {"glove.motion.duration_s=10"});
  EXPECT_TRUE(none.is_left_out && !none.switched && none.seeds == 0);
  EXPECT_NEAR(none.cost_of_first, 1.0 + 11.0 / 2.0, 1e-12);
  // The begin of a chirp is slow.
  EXPECT_TRUE(plan(2, 3, {"glove.motion={kind: chirp, duration_s: 20, from_hz: 0.1, to_hz: 4}"})
                  .is_left_out);
}

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
    for (const CauseMetric& part : TrackingErrorParts()) {
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

/// A cut trial is not stored, and a stored whole one is not taken for it.
TEST_F(CauseTrialsTest, OfAStretchDoNotDependOnWhatIsStored) {
  const auto without_link = [this](CauseSeeds causes, TrialStore* store) {
    const StudyResult result =
        Run({"glove.motion.duration_s=5"},
            {.seeds = 10, .keep_first_traces = false, .causes = causes, .store = store});
    EXPECT_EQ(result.causes.ticks.has_value(), causes == CauseSeeds::kAuto);
    return Score(result, "error_without_link_deg");
  };
  const double fresh = without_link(CauseSeeds::kAuto, nullptr);
  Kept store;
  EXPECT_EQ(without_link(CauseSeeds::kAuto, &store), fresh);
  const double whole = without_link(CauseSeeds::kFirst, &store);
  EXPECT_NE(whole, fresh);
  EXPECT_EQ(without_link(CauseSeeds::kFirst, &store), whole);
  EXPECT_EQ(without_link(CauseSeeds::kAuto, &store), fresh);
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
