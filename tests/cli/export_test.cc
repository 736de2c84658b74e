// What gauntlet export writes drives the same motors as the trials did, bit for bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "controller/controller.h"
#include "sim/base/random.h"
#include "sim/settings/robot_file.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/study.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using sim::Study;

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
    return folder_.Run(std::move(arguments));
  }
  fs::path In(const std::string& name) const { return folder_.In(name); }
  /// Runs it into the folder `out`, and builds the same study here.
  Study Run(const std::string& scenario) {
    folder_.Write("scenario.yaml", scenario);
    const ProgramResult result = Gauntlet({"run", "scenario.yaml", "--out", "out"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    return sim::PrepareStudy(sim::LoadScenario(In("scenario.yaml"), {}));
  }
  void ExpectSameCommands(const Study& study, const sim::NamedController& named);

  WorkingFolder folder_{GAUNTLET_PROGRAM};
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
  EXPECT_TRUE(result.standard_error.ends_with("wrote " + file + "\n")) << result.standard_error;
  const bool has_file = named.config.linearisation.kind != controller::LinearisationKind::kGlove;
  EXPECT_EQ(result.standard_error.find("that of the simulated glove") == std::string::npos,
            has_file)
      << result.standard_error;
  controller::Controller loaded(sim::LoadRobot(In(file)));
  const sim::TrialSetup setup = sim::SetupOf(study, named, study.scenario.seed);
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

}  // namespace
}  // namespace gauntlet::test
