// Every scenario that is shipped loads, says what it asks, and survives being written and read.
#include "sim/scenario/scenario.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> ShippedScenarios() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(GAUNTLET_SOURCE_DIR) / "scenarios")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

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

INSTANTIATE_TEST_SUITE_P(All, ShippedScenario, testing::ValuesIn(ShippedScenarios()),
                         [](const auto& test) { return test.param.stem().string(); });

TEST(Scenario, OverridesReachControllersByName) {
  const fs::path file = fs::path(GAUNTLET_SOURCE_DIR) / "scenarios/random_motion.yaml";
  const Scenario scenario = LoadScenario(
      file, {"seed=9", "controllers.raw.filter=moving_average", "controllers.raw.filter.window=7"});
  EXPECT_EQ(scenario.seed, 9);
  const std::string text = ScenarioToYaml(scenario);
  EXPECT_NE(text.find("window: 7"), std::string::npos);
}

TEST(Scenario, AnOverrideCannotInventAController) {
  const fs::path file = fs::path(GAUNTLET_SOURCE_DIR) / "scenarios/random_motion.yaml";
  EXPECT_THROW(LoadScenario(file, {"controllers.rav.filter=none"}), UserError);
}

TEST(Scenario, AnEventPeriodIsAWholeNumberOfSamples) {
  const fs::path file = fs::path(GAUNTLET_SOURCE_DIR) / "scenarios/random_motion.yaml";
  EXPECT_THROW(LoadScenario(file, {"event.period_ms=2.5"}), UserError);
  EXPECT_EQ(LoadScenario(file, {"event.period_ms=10"}).controllers[0].config.samples_per_event, 10);
}

}  // namespace
}  // namespace gauntlet::sim
