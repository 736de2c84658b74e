// What gauntlet export writes drives the same motors as the trials did, bit for bit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "controller/controller.h"
#include "sim/base/random.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/settings/robot_file.h"
#include "sim/study/study.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using sim::Study;
using testing::AllOf;
using testing::HasSubstr;

/// A scenario with a controller of each kind of filter, of the whole glove at 1 kHz.
std::string EveryFilter() {
  std::string text = "question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\ncontrollers:\n";
  for (const controller::FilterKind& kind : controller::FilterKinds()) {
    text += fmt::format("  c_{0}: {{filter: {0}}}\n", kind.name);
  }
  return text;
}

// Ticks of 1000 / (17 60) ms; what the sensors give is on other joints, and looked ahead.
constexpr const char* kFiveChannelsAt60Hz = R"(question: q
glove:
  rate_hz: 60
  channels: [thumb_ip, index_pip, middle_pip, ring_pip, little_pip]
  motion: {kind: hold, duration_s: 0.2}
joint_map:
  index_mcp: {channels: [index_pip], weights: [0.7]}
  ring_mcp: {channels: [ring_pip, little_pip], weights: [0.1, 0.3], offset_deg: 3.3}
  wrist_flexion: {channels: [], offset_deg: 10}
controllers:
  ahead:
    filter: [{kind: one_euro, min_cutoff_hz: 1.7}, {kind: kalman, q: 0.003}]
    prediction: {kind: linear, horizon_ms: 61.3, window_ms: 70}
    motor: {rounding: hysteresis}
)";

class ExportTest : public testing::Test {
 protected:
  ProgramResult Gauntlet(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    ProgramOptions options;
    options.working_directory = folder_.path();
    return RunProgram(arguments, options);
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  /// Runs it into the folder `out`, and builds the same study here.
  Study Run(const std::string& scenario) {
    std::ofstream(In("scenario.yaml")) << scenario;
    const ProgramResult result = Gauntlet({"run", "scenario.yaml", "--out", "out"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    return sim::PrepareStudy(sim::LoadScenario(In("scenario.yaml"), {}));
  }
  void ExpectSameCommands(const Study& study, const sim::NamedController& named);

  TemporaryDirectory folder_;
};

/// Counts that wander over the whole range, with a missing value now and then.
std::vector<double> SomeCounts(sim::RandomStream& random, std::vector<double> counts) {
  for (double& value : counts) {
    if (!std::isfinite(value)) value = 500.0;
    value = std::clamp(std::round(value + random.Uniform(-20.0, 20.0)), 1.0, 1022.0);
    if (random.Uniform() < 0.01) value = std::numeric_limits<double>::quiet_NaN();
  }
  return counts;
}

void ExportTest::ExpectSameCommands(const Study& study, const sim::NamedController& named) {
  const ProgramResult result = Gauntlet({"export", "out", "--controller", named.name});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const std::string file = "out/" + named.name + ".robot.yaml";
  EXPECT_EQ(result.standard_error, "wrote " + file + "\n");
  controller::Controller loaded(sim::LoadRobot(In(file)));
  const sim::TrialSetup setup = sim::SetupOf(study, named);
  const controller::Timing& timing = study.hand->timing().controller;
  controller::Controller built(setup.controller, setup.calibration, study.hand->transmission(),
                               timing, setup.joint_map);
  ASSERT_EQ(loaded.motor_count(), built.motor_count());
  sim::RandomStream random(7, "counts");
  std::vector<double> counts(study.channel_names().size(), 500.0);
  int events = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    const bool fresh = tick % timing.ticks_per_sample == 0;
    if (fresh) counts = SomeCounts(random, counts);
    const controller::Command a =
        fresh ? loaded.Step({.counts = counts, .number = tick + 1}) : loaded.Step();
    const controller::Command b =
        fresh ? built.Step({.counts = counts, .number = tick + 1}) : built.Step();
    ASSERT_EQ(a.event, b.event) << tick;
    ASSERT_TRUE(std::ranges::equal(a.motor_counts, b.motor_counts)) << tick;
    ASSERT_TRUE(std::ranges::equal(loaded.target_angle_rad(), built.target_angle_rad())) << tick;
    events += a.event ? 1 : 0;
  }
  EXPECT_NEAR(events, 2000 / timing.TicksOf(timing.event_period_ms), 1.0);
}

TEST_F(ExportTest, EveryKindOfFilterGivesTheCommandsOfTheStudy) {
  const Study study = Run(EveryFilter());
  for (const sim::NamedController& named : study.scenario.controllers) {
    SCOPED_TRACE(named.name);
    ExpectSameCommands(study, named);
  }
}

TEST_F(ExportTest, FiveChannelsAt60HzOnOtherJointsGiveTheCommandsOfTheStudy) {
  const Study study = Run(kFiveChannelsAt60Hz);
  ASSERT_EQ(study.hand->timing().controller.ticks_per_sample, 17);
  ExpectSameCommands(study, study.scenario.controllers.front());
}

TEST_F(ExportTest, TheCalibrationOfTheTrialsIsInTheFile) {
  const Study study =
      Run("question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\ncontrollers: {calibrated: "
          "{filter: kalman, calibration: " +
          SourceDir() + "/scenarios/calibrations/glove_of_seed_1.yaml}}\n");
  const sim::NamedController& named = study.scenario.controllers.front();
  ASSERT_EQ(named.config.linearisation.kind, controller::LinearisationKind::kTable);
  ExpectSameCommands(study, named);
}

TEST_F(ExportTest, WritesTextAndWhatAMicrocontrollerHolds) {
  Run("question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\ncontrollers:\n"
      "  settled: {filter: kalman_steady}\n  learns: {filter: kalman_adaptive}\n");
  for (const char* form : {"--text", "--embedded", "--header"}) {
    const ProgramResult result = Gauntlet({"export", "out", "--controller", "settled", form});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  }
  for (const char* name : {"settled.robot.txt", "settled.embedded.robot.h", "settled.robot.h"}) {
    EXPECT_TRUE(fs::exists(In("out") / name)) << name;
  }
  const ProgramResult refused = Gauntlet({"export", "out", "--controller", "learns", "--embedded"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.standard_error,
              HasSubstr("--controller learns: controller.filter[0]: is kalman_adaptive, must be "
                        "none, exponential, alpha_beta, alpha_beta_gamma or kalman_steady in the "
                        "embedded form"));
  EXPECT_FALSE(fs::exists(In("out/learns.embedded.robot.h")));
  EXPECT_EQ(
      Gauntlet({"export", "out", "--controller", "settled", "--text", "--embedded"}).exit_code, 2);
  // Another run into the folder is of another scenario.
  Run(kFiveChannelsAt60Hz);
  EXPECT_FALSE(fs::exists(In("out/settled.robot.txt")));
  EXPECT_FALSE(fs::exists(In("out/settled.embedded.robot.h")));
}

TEST_F(ExportTest, WritesWhereItIsToldAndSaysWhereTheFileComesFrom) {
  Run("name: \"two: # words\"\n" + std::string(kFiveChannelsAt60Hz));
  const ProgramResult result =
      Gauntlet({"export", "out", "--controller", "ahead", "--out", "new/robot.yaml"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_output, "");
  EXPECT_EQ(sim::LoadRobot(In("new/robot.yaml")).timing.ticks_per_sample, 17);
  std::ostringstream text;
  text << std::ifstream(In("new/robot.yaml")).rdbuf();
  EXPECT_THAT(text.str(), AllOf(HasSubstr("# Controller ahead of scenario two: # words"),
                                HasSubstr("LoadRobot(\"ahead.robot.yaml\")"),
                                HasSubstr("1020 times per second; a new sample every 17 times")));
}

TEST_F(ExportTest, MistakesAreOneLine) {
  Run(kFiveChannelsAt60Hz);
  const auto expect = [this](const std::vector<std::string>& arguments, const std::string& line) {
    const ProgramResult result = Gauntlet(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.standard_error, "gauntlet: " + line + "\n");
  };
  expect({"export", "out", "--controller", "ahed"},
         "--controller ahed: unknown controller (did you mean ahead?)");
  expect({"export", "nowhere", "--controller", "ahead"}, "nowhere: is not a folder");
  expect({"export", "out", "--controller", "ahead", "--out", "out/scenario.resolved.yaml"},
         "--out out/scenario.resolved.yaml: is the scenario itself");
  expect({"export", "out"}, "--controller is required; see gauntlet export --help");
}

TEST_F(ExportTest, TellsIfTheHandIsNoLongerThatOfTheTrials) {
  Run(kFiveChannelsAt60Hz);
  std::ostringstream text;
  text << std::ifstream(In("out/scenario.resolved.yaml")).rdbuf();
  std::string resolved = text.str();
  const std::size_t hash = resolved.find("model_hash: \"");
  ASSERT_NE(hash, std::string::npos);
  resolved.replace(hash, 15, "model_hash: \"zz");
  std::ofstream(In("out/scenario.resolved.yaml")) << resolved;
  const ProgramResult changed = Gauntlet({"export", "out", "--controller", "ahead"});
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.standard_error,
              HasSubstr("out/scenario.resolved.yaml: is not as its run wrote it"));
  std::filesystem::remove(In("out/manifest.json"));
  const ProgramResult result = Gauntlet({"export", "out", "--controller", "ahead"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.standard_error,
              AllOf(HasSubstr("warning: out has no manifest.json: its files are not checked"),
                    HasSubstr("warning: this scenario was resolved with another hand model"),
                    HasSubstr("the file is for the hand as it is now")));
}

}  // namespace
}  // namespace gauntlet::test
