#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/glove/glove.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/ready_scenarios.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

class EveryScenario : public ::testing::TestWithParam<fs::path> {};

TEST_P(EveryScenario, GivesAGloveSignalThatIsWhole) {
  const Scenario scenario = LoadScenario(GetParam(), {});
  EXPECT_TRUE(scenario.question.ends_with("?")) << scenario.question;
  EXPECT_FALSE(scenario.controllers.empty());
  const GloveSignal glove = SynthesiseGlove(scenario.glove, 1);
  EXPECT_GE(static_cast<double>(glove.counts.rows()), 2.0 * scenario.glove.rate_hz);
  EXPECT_FALSE(glove.true_angle_rad.hasNaN());
  const auto missing = static_cast<double>(glove.counts.array().isNaN().count());
  EXPECT_LT(missing, 0.2 * static_cast<double>(glove.counts.size()));
}

INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario, ::testing::ValuesIn(ReadyScenarios()),
                         [](const auto& file) { return file.param.stem().string(); });

}  // namespace
}  // namespace gauntlet::sim
