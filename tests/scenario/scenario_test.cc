// Every scenario that is shipped loads, says what it asks, and survives being written and read.
#include "sim/study/scenario/scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"
#include "tests/support/ready_scenarios.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

class ShippedScenario : public testing::TestWithParam<fs::path> {};

TEST_P(ShippedScenario, LoadsAndRoundTrips) {
  const Scenario scenario = LoadScenario(GetParam(), {});
  EXPECT_EQ(scenario.name, GetParam().stem());
  EXPECT_FALSE(scenario.question.empty());
  EXPECT_FALSE(scenario.controllers.empty());

  const std::string text = ScenarioToYaml(scenario);
  const fs::path copy = fs::temp_directory_path() /
                        (GetParam().stem().string() + std::to_string(getpid()) + ".resolved.yaml");
  std::ofstream(copy) << text;
  EXPECT_EQ(ScenarioToYaml(LoadScenario(copy, {})), text);
  fs::remove(copy);
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario, testing::ValuesIn(ReadyScenarios()),
                         [](const auto& test) { return test.param.stem().string(); });

TEST(Scenario, OverridesReachControllersByName) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/random_motion.yaml";
  const Scenario scenario = LoadScenario(
      file, {"seed=9", "controllers.raw.filter=moving_average", "controllers.raw.filter.window=7"});
  EXPECT_EQ(scenario.seed, 9);
  const std::string text = ScenarioToYaml(scenario);
  EXPECT_NE(text.find("window: 7"), std::string::npos);
}

TEST(Scenario, AFaultHasTheDefaultsOfItsKind) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/random_motion.yaml";
  const Scenario scenario = LoadScenario(
      file, {"glove.faults=[spikes, {kind: disconnected, rate_per_s: 0.1}, dropouts]"});
  const std::vector<FaultConfig>& faults = scenario.glove.faults;
  ASSERT_EQ(faults.size(), 3u);
  EXPECT_LT(faults[0].when().start_s, 0.0);  // at random
  EXPECT_EQ(faults[1].when().start_s, 5.0);
  EXPECT_EQ(faults[1].when().rate_per_s, 0.1);
  EXPECT_EQ(faults[1].when().duration_ms, 0.0);  // to the end
  EXPECT_EQ(faults[2].when().duration_ms, 50.0);
}

TEST(Scenario, APredictionHasTheKeysOfItsKindOnly) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/hold_still.yaml";
  const auto text_with = [&](const std::string& prediction) {
    return ScenarioToYaml(LoadScenario(file, {"controllers.raw.prediction=" + prediction}));
  };
  EXPECT_THAT(text_with("none"), testing::Not(testing::HasSubstr("horizon_ms")));
  EXPECT_THAT(text_with("linear"), testing::HasSubstr("window_ms: 60"));
  EXPECT_THAT(text_with("{kind: kalman, horizon_ms: 30}"),
              testing::AllOf(testing::HasSubstr("horizon_ms: [30]"),
                             testing::HasSubstr("q_deg2_per_s3: 10000"),
                             testing::Not(testing::HasSubstr("q_deg2_per_s5"))));
  EXPECT_THAT(text_with("{kind: kalman, states: 3}"),
              testing::AllOf(testing::HasSubstr("q_deg2_per_s5: 1000000"),
                             testing::Not(testing::HasSubstr("q_deg2_per_s3"))));
  try {
    text_with("{kind: linear, r_deg2: 1}");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("prediction.r_deg2: unknown key"));
  }
}

TEST(Scenario, ARecordingSaysWhatLiesBetweenItsRows) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/sign_glove.yaml";
  const auto text_with = [&](const std::vector<std::string>& overrides) {
    return ScenarioToYaml(LoadScenario(file, overrides));
  };
  EXPECT_THAT(text_with({}), testing::HasSubstr("resample: hold"));
  EXPECT_THAT(text_with({"glove.motion.use=truth"}), testing::HasSubstr("resample: cubic"));
  EXPECT_THAT(text_with({"glove.motion.resample=cubic"}), testing::HasSubstr("resample: cubic"));
  EXPECT_THAT(text_with({"glove.motion.use=truth", "glove.motion.resample=hold"}),
              testing::HasSubstr("resample: hold"));
}

TEST(Scenario, AnOverrideCannotInventAController) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/random_motion.yaml";
  EXPECT_THROW(LoadScenario(file, {"controllers.rav.filter=none"}), UserError);
}

TEST(Scenario, IsParsedFromATextUnderTheNameOfAFile) {
  const std::string text = "question: q\ncontrollers: {raw: {}}\n";
  EXPECT_EQ(ParseScenario({.file = "some/folder/b\u00e4r.yaml", .text = text}).name, "b\u00e4r");
  EXPECT_EQ(ParseScenario({.file = "x.yaml", .text = text, .overrides = {"name=other"}}).name,
            "other");
  EXPECT_THROW(ParseScenario({.file = "...yaml", .text = text}), UserError);
  EXPECT_EQ(ParseScenario({.file = "...yaml", .text = "name: x\n" + text}).name, "x");
}

TEST(Scenario, ATextIsReadAgainWithOtherOverridesAsIfItWereNew) {
  const std::string text =
      "question: q\nseed: 3\nglove: {motion: &m {kind: hold, duration_s: 2}, faults: [spikes]}\n"
      "repetitions: {glove.noise.variance_scale: [1, 4]}\n"
      "controllers: {raw: &c {filter: none}, two: *c}\n";
  const ScenarioText parsed = ParseScenarioText("s.yaml", text);
  const std::vector<std::vector<std::string>> overrides = {
      {},
      {"controllers.two.filter={kind: exponential}"},
      {"seed=4", "glove.motion.duration_s=5"},
      {"repetitions={}", "glove.faults.0.rate_per_s=2"},
      {"controllers.raw.filter=none"},
      {}};
  for (const std::vector<std::string>& these : overrides) {
    EXPECT_EQ(ScenarioToYaml(ParseScenario(parsed, these)),
              ScenarioToYaml(ParseScenario({.file = "s.yaml", .text = text, .overrides = these})));
  }
  EXPECT_EQ(ParseScenario(parsed, overrides[2]).glove.noise.variance_scale, 4);
  EXPECT_EQ(ParseScenario(parsed, {}).glove.noise.variance_scale, 1);
}

TEST(Scenario, TellsWhereASettingStands) {
  const ScenarioSource source{.file = "s.yaml",
                              .text =
                                  "question: q\nglove:\n  faults: [spikes, {kind: stuck}]\n"
                                  "controllers: {raw: {}}\n",
                              .overrides = {"glove.faults.0.rate_per_s=1"}};
  EXPECT_EQ(PlaceOfSetting(source, "question"), "s.yaml:1:11");
  EXPECT_EQ(PlaceOfSetting(source, "glove.faults[1].kind"), "s.yaml:3:27");
  EXPECT_EQ(PlaceOfSetting(source, "glove.faults[1].channels"), "s.yaml:3:20");  // left out there
  EXPECT_EQ(PlaceOfSetting(source, "glove.faults[0].rate_per_s"),
            "--set glove.faults.0.rate_per_s=1");
  EXPECT_EQ(PlaceOfSetting(source, "glove.faults[0].kind"), "s.yaml:3:12");
  EXPECT_EQ(PlaceOfSetting(source, "hand.servo.travel_deg"), "s.yaml");
}

TEST(Scenario, APathOfTheCommandLineIsRelativeToTheWorkingFolder) {
  const std::string text =
      "question: q\nglove: {motion: {kind: sequence, parts: [{kind: recording, file: a.csv}]}}\n"
      "controllers: {raw: {}}\n";
  const auto yaml = [&text](const std::vector<std::string>& overrides) {
    return ScenarioToYaml(
        ParseScenario({.file = "/data/s.yaml", .text = text, .overrides = overrides}));
  };
  const std::string here = "\"" + (fs::current_path() / "b.csv").string() + "\"";
  EXPECT_THAT(yaml({}), testing::HasSubstr("file: \"/data/a.csv\""));
  EXPECT_THAT(yaml({"glove.motion.parts.0.file=b.csv"}), testing::HasSubstr("file: " + here));
  EXPECT_THAT(yaml({"glove.motion={kind: recording, file: b.csv}"}),
              testing::HasSubstr("file: " + here));
}

TEST(Scenario, AnEventPeriodNeedNotBeAWholeNumberOfSamples) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/random_motion.yaml";
  const LoopTiming timing =
      TimingOf(LoadScenario(file, {"event.period_ms=2.5", "glove.rate_hz=60"}));
  EXPECT_EQ(timing.controller.ticks_per_sample, 17);
  EXPECT_DOUBLE_EQ(timing.tick_rate_hz(), 1020.0);
  EXPECT_DOUBLE_EQ(timing.controller.TicksOf(timing.controller.event_period_ms), 2.55);
  EXPECT_EQ(timing.steps_per_tick, 1);
}

TEST(Scenario, TheBaselineIsWhatIsNamedOrTheFirstThatNeitherFiltersNorPredicts) {
  const test::TemporaryDirectory folder;
  const auto load = [&](const std::string& more, const std::string& controllers) {
    const fs::path file = folder.path() / "some.yaml";
    std::ofstream(file) << "question: Who is the baseline?\n"
                        << more << "controllers:\n"
                        << controllers;
    return LoadScenario(file, {});
  };
  const std::string ahead = "  ahead: {filter: none, prediction: {kind: linear, horizon_ms: 60}}\n";
  const std::string mean = "  mean: {filter: moving_average}\n";
  const std::string raw = "  raw: {filter: none}\n";
  EXPECT_EQ(BaselineOf(load("", ahead + mean + raw)), 2u);
  EXPECT_EQ(BaselineOf(load("", ahead + mean)), std::nullopt);
  EXPECT_EQ(BaselineOf(load("baseline: mean\n", ahead + mean + raw)), 1u);
  try {
    load("baseline: men\n", mean + raw);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("some.yaml:2:11: baseline: men is not a controller of the "
                                   "scenario (did you mean mean?)"));
  }
}

TEST(Scenario, AMeasurementVarianceThatIsLeftOutIsThatOfTheNoise) {
  const fs::path file = fs::path(SourceDir()) / "scenarios/random_motion.yaml";
  const auto r_of = [&](const std::vector<std::string>& overrides) {
    const Scenario scenario = LoadScenario(file, overrides);
    const auto tuned =
        std::ranges::find(scenario.controllers, "tuned_kalman", &NamedController::name);
    return std::get<controller::KalmanConfig>(tuned->config.filters[0].settings).noise.r;
  };
  EXPECT_EQ(r_of({}), controller::PaperMeasurementVariance());
  const std::string two = "glove.channels=[index_mcp, index_pip]";
  EXPECT_EQ(r_of({two}), (std::vector<double>{26.94, 10.08}));  // the paper's, of these channels
  EXPECT_EQ(r_of({two, "glove.noise.variance_scale=2"}), (std::vector<double>{53.88, 20.16}));
  // On angles: index_mcp has 135 deg in 80 % of 1023 counts.
  const double rad_per_count = 135.0 * kRadPerDeg / (0.8 * 1023.0);
  EXPECT_NEAR(r_of({"controllers.tuned_kalman.filter_on=angle"})[4],
              26.94 * rad_per_count * rad_per_count, 1e-12);
  EXPECT_EQ(r_of({two, "controllers.tuned_kalman.filter.r=3"}), std::vector<double>{3.0});
  try {
    r_of({two, "glove.noise.kind=none"});
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("filter[0].r: must be given"));
  }
}

/// A calibration of two channels, with a full covariance, and scenarios that include it.
class IncludedCalibration : public testing::Test {
 protected:
  IncludedCalibration() { Write("glove.yaml", kCalibration); }
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name) << text;
  }
  /// One controller with these keys.
  controller::ControllerConfig Load(const std::string& keys,
                                    const std::vector<std::string>& overrides = {}) {
    Write("scenario.yaml",
          "question: q\nglove: {channels: [index_mcp, index_pip]}\ncontrollers:\n  a: {" + keys +
              "}\n");
    const Scenario scenario = LoadScenario(folder_.path() / "scenario.yaml", overrides);
    EXPECT_EQ(scenario.controllers[0].calibration, "");
    // What is resolved holds the values, not the file.
    Write("resolved.yaml", ScenarioToYaml(scenario));
    EXPECT_EQ(ScenarioToYaml(LoadScenario(folder_.path() / "resolved.yaml", {})),
              ScenarioToYaml(scenario));
    return scenario.controllers[0].config;
  }
  std::string ErrorOf(const std::string& keys) {
    try {
      Load(keys);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  // index_pip stands first: order is by name.
  const std::string kCalibration =
      "linearisation:\n  kind: table\n  channels:\n"
      "    - {channel: index_pip, counts: [100, 900], angle_deg: [0, 100]}\n"
      "    - {channel: index_mcp, counts: [200, 800], angle_deg: [-45, 90]}\n"
      "channels:\n"
      "  - {channel: index_pip, covariance_counts2: [9, 2]}\n"
      "  - {channel: index_mcp, covariance_counts2: [2, 16]}\n";
  test::TemporaryDirectory folder_;
};

template <class Settings>
const Settings& FilterOf(const controller::ControllerConfig& config, std::size_t index = 0) {
  return std::get<Settings>(config.filters.at(index).settings);
}

TEST_F(IncludedCalibration, GivesLinearisationAndRByTheNamesOfChannels) {
  const auto config = Load("calibration: glove.yaml, filter: [hampel, kalman, kalman_steady]");
  EXPECT_EQ(config.linearisation.kind, controller::LinearisationKind::kTable);
  ASSERT_EQ(config.linearisation.channels.size(), 2u);
  EXPECT_EQ(config.linearisation.channels[0].channel, "index_mcp");
  EXPECT_EQ(config.linearisation.channels[0].counts, (std::vector<double>{200, 800}));
  EXPECT_EQ(FilterOf<controller::KalmanConfig>(config, 1).noise.r, (std::vector<double>{16, 9}));
  EXPECT_EQ(FilterOf<controller::KalmanSteadyConfig>(config, 2).noise.r,
            (std::vector<double>{16, 9}));
}

TEST_F(IncludedCalibration, GivesTheDenseFilterTheFullCovariance) {
  const auto config = Load("calibration: glove.yaml, filter: kalman_dense");
  EXPECT_EQ(FilterOf<controller::KalmanDenseConfig>(config).r, (std::vector<double>{16, 2, 2, 9}));
}

TEST_F(IncludedCalibration, TakesRoundingForTheLeastNoise) {
  Write("glove.yaml",
        "channels:\n  - {channel: index_mcp, covariance_counts2: [0, 0]}\n"
        "  - {channel: index_pip, covariance_counts2: [0, 9]}\n");
  const auto config = Load("calibration: glove.yaml, filter: kalman");
  EXPECT_EQ(FilterOf<controller::KalmanConfig>(config).noise.r,
            (std::vector<double>{1.0 / 12.0, 9}));
  EXPECT_EQ(config.linearisation.kind, controller::LinearisationKind::kGlove);  // it has none
}

TEST_F(IncludedCalibration, LosesAgainstTheControllersOwnKeys) {
  const auto config =
      Load("calibration: glove.yaml, filter: [{kind: kalman, r: 5}, kalman], linearisation: glove");
  EXPECT_EQ(config.linearisation.kind, controller::LinearisationKind::kGlove);
  EXPECT_EQ(FilterOf<controller::KalmanConfig>(config, 0).noise.r, std::vector<double>{5});
  EXPECT_EQ(FilterOf<controller::KalmanConfig>(config, 1).noise.r, (std::vector<double>{16, 9}));
  const std::string file = (folder_.path() / "glove.yaml").string();
  EXPECT_EQ(FilterOf<controller::KalmanConfig>(
                Load("filter: kalman",
                     {"controllers.a.calibration=" + file, "controllers.a.filter.r=[3, 4]"}))
                .noise.r,
            (std::vector<double>{3, 4}));
}

TEST_F(IncludedCalibration, NamesThePlaceOfAMistake) {
  using testing::HasSubstr;
  EXPECT_THAT(ErrorOf("calibration: glove.yaml, filter_on: angle, filter: kalman"),
              HasSubstr("scenario.yaml:4:20: controllers.a.calibration: "));
  EXPECT_THAT(ErrorOf("calibration: glove.yaml, filter_on: angle, filter: kalman"),
              HasSubstr("in rad^2"));
  EXPECT_EQ(ErrorOf("calibration: glove.yaml, filter_on: angle, filter: {kind: kalman, r: 1e-4}"),
            "");
  EXPECT_THAT(ErrorOf("calibration: no.yaml"), HasSubstr("no.yaml: no such file"));
  Write("glove.yaml", "channels:\n  - {channel: index_mcp, covariance_counts2: [16]}\n");
  EXPECT_THAT(ErrorOf("calibration: glove.yaml"), HasSubstr("has nothing for channel index_pip"));
  Write("glove.yaml", kCalibration + "chanels: []\n");
  EXPECT_THAT(ErrorOf("calibration: glove.yaml"),
              HasSubstr("glove.yaml:9:1: chanels: unknown key (did you mean channels?)"));
  Write("glove.yaml", "channels:\n  - {channel: index_mcp}\n");
  EXPECT_THAT(ErrorOf("calibration: glove.yaml"), HasSubstr("covariance_counts2: is missing"));
  Write("glove.yaml",
        "channels:\n  - {channel: index_mcp, covariance_counts2: [1]}\n"
        "  - {channel: index_pip, covariance_counts2: [1, 2]}\n");
  EXPECT_THAT(ErrorOf("calibration: glove.yaml"), HasSubstr("has 1 values, must have 2"));
}

/// A chain of three joints, and scenarios that include it.
class IncludedChain : public IncludedCalibration {
 protected:
  IncludedChain() { Write("hand.yaml", kChain); }
  static std::vector<double> HorizonOf(const controller::ControllerConfig& config) {
    return std::get<controller::AdaptivePredictionConfig>(config.prediction.settings).horizon_ms;
  }

  const std::string kChain =
      "horizon_ms: [80, 60, 100]\n"
      "parts: [{part: index_pip}, {part: index_mcp}, {part: wrist_flexion}]\n";
};

TEST_F(IncludedChain, GivesTheHorizonByTheNamesOfChannels) {
  const std::vector<double> by_name = {60, 80};
  EXPECT_EQ(HorizonOf(Load("chain: hand.yaml, prediction: adaptive")), by_name);
  EXPECT_EQ(HorizonOf(Load("chain: hand.yaml, prediction: {kind: adaptive, horizon_ms: auto}")),
            by_name);
  const std::string set = "controllers.a.prediction.horizon_ms=";
  const std::string keys = "chain: hand.yaml, prediction: {kind: adaptive, horizon_ms: 20}";
  EXPECT_EQ(HorizonOf(Load(keys)), std::vector<double>{20});
  EXPECT_EQ(HorizonOf(Load(keys, {set + "auto"})), by_name);
  EXPECT_EQ(HorizonOf(Load("chain: hand.yaml, prediction: adaptive", {set + "[5, 7]"})),
            (std::vector<double>{5, 7}));
}

TEST_F(IncludedChain, AutoIsThatOfEachControllerThatSharesItsPrediction) {
  const std::string text =
      "question: q\nglove: {channels: [index_mcp, index_pip]}\ncontrollers:\n"
      "  a: {chain: hand.yaml, prediction: &p {kind: adaptive, horizon_ms: auto}}\n"
      "  b: {prediction: *p";
  const auto load = [&](const std::string& rest) {
    Write("scenario.yaml", text + rest + "}\n");
    return LoadScenario(folder_.path() / "scenario.yaml", {});
  };
  const Scenario both = load(", chain: hand.yaml");
  EXPECT_EQ(HorizonOf(both.controllers[0].config), (std::vector<double>{60, 80}));
  EXPECT_EQ(HorizonOf(both.controllers[1].config), (std::vector<double>{60, 80}));
  try {
    load("");
    FAIL() << "b has no chain";
  } catch (const UserError& error) {
    EXPECT_EQ(error.key(), "controllers.b.prediction.horizon_ms");
  }
}

TEST_F(IncludedChain, AsksTheJointsThatAChannelMoves) {
  Write("hand.yaml",
        "horizon_ms: [80, 60, 100]\n"
        "parts: [{part: index_pip}, {part: middle_mcp}, {part: wrist_flexion}]\n");
  Write("scenario.yaml",
        "question: q\nglove: {channels: [index_mcp, index_pip]}\n"
        "joint_map: {middle_mcp: {channels: index_mcp}, wrist_flexion: {channels: index_mcp}}\n"
        "controllers:\n  a: {chain: hand.yaml, prediction: adaptive}\n");
  const Scenario scenario = LoadScenario(folder_.path() / "scenario.yaml", {});
  EXPECT_EQ(HorizonOf(scenario.controllers[0].config), (std::vector<double>{80, 80}));
}

TEST_F(IncludedChain, NamesThePlaceOfAMistake) {
  using testing::HasSubstr;
  EXPECT_THAT(ErrorOf("prediction: {kind: adaptive, horizon_ms: auto}"),
              HasSubstr("scenario.yaml:4:48: controllers.a.prediction.horizon_ms: is auto, which "
                        "needs the controller's chain"));
  EXPECT_THAT(ErrorOf("chain: no.yaml, prediction: adaptive"), HasSubstr("no.yaml: no such file"));
  EXPECT_THAT(ErrorOf("chain: hand.yaml"), HasSubstr("scenario.yaml:4:14: controllers.a.chain: "));
  EXPECT_THAT(ErrorOf("chain: hand.yaml, prediction: adaptive, model_predictive: {kind: "
                      "second_order}"),
              HasSubstr("with model_predictive it must be given"));
  EXPECT_THAT(ErrorOf("chain: hand.yaml"), HasSubstr("a prediction of kind none does not take"));
  Write("hand.yaml", "horizon_ms: [80]\nparts: [{part: index_pip}]\n");
  EXPECT_THAT(ErrorOf("chain: hand.yaml, prediction: linear"),
              HasSubstr("has nothing for channel index_mcp"));
  Write("hand.yaml", "horizon_ms: [80, 60]\nparts: [{part: index_pip}]\n");
  EXPECT_THAT(ErrorOf("chain: hand.yaml, prediction: linear"),
              HasSubstr("horizon_ms has 2 values, parts has 1"));
  Write("hand.yaml", "horizon_ms: [1001]\nparts: [{part: index_pip}]\n");
  EXPECT_THAT(ErrorOf("chain: hand.yaml, prediction: linear"),
              HasSubstr("hand.yaml:1:14: horizon_ms"));
}

}  // namespace
}  // namespace gauntlet::sim
