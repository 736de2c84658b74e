// The filters of scenarios/field_presets.yaml have the lag that their sources' settings have.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

/// How far a chain of filters is behind a slow ramp in the end [s].
double LagOnRamp(const std::vector<controller::FilterConfig>& filters, double rate_hz) {
  constexpr double kCountsPerSample = 0.005;  // 0.3 counts/s: what opens at speed stays shut
  constexpr int kSamples = 2000;
  std::vector<std::unique_ptr<controller::Filter>> chain;
  for (const controller::FilterConfig& filter : filters) {
    chain.push_back(controller::MakeFilter(filter, 1, rate_hz));
  }
  double value = 0.0;
  for (int n = 0; n < kSamples; ++n) {
    value = kCountsPerSample * n;
    for (const auto& filter : chain) filter->Step({&value, 1}, {&value, 1});
  }
  return ((kSamples - 1) - value / kCountsPerSample) / rate_hz;
}

TEST(FieldPresets, LagAsTheirSourcesSettingsDo) {
  const Scenario scenario = LoadScenario(SourceDir() + "/scenarios/field_presets.yaml", {});
  // From the settings as they ship: samples / rate, or the time constant itself.
  std::map<std::string, double> lag_s = {
      {"raw", 0.0},
      {"retargeting_60hz", 4.0 / 60.0},
      {"retargeting_30hz", 4.0 / 30.0},
      {"homunculus", 4.5 / 60.0},
      {"shadow", 0.05},
      {"wuji_5hz", 1.0 / (2.0 * M_PI * 5.0)},
      {"wuji_8hz", 1.0 / (2.0 * M_PI * 8.0)},
      {"xr_arm_weights", (0.3 * 1 + 0.2 * 2 + 0.1 * 3) / 60.0},
      {"ruka", 0.5 / 60.0},
      {"axol_without_one_euro", 0.06 + 0.7 / 0.3 / 60.0},
      {"kinesis", 1.0 / (2.0 * M_PI * 2.5)},
      {"kinesis_beta_8", 1.0 / (2.0 * M_PI * 2.5)},
  };
  for (const NamedController& named : scenario.controllers) {
    ASSERT_TRUE(lag_s.contains(named.name)) << named.name;
    EXPECT_NEAR(LagOnRamp(named.config.filters, scenario.glove.rate_hz), lag_s[named.name], 0.002)
        << named.name;
  }
  EXPECT_EQ(scenario.controllers.size(), lag_s.size());
}

}  // namespace
}  // namespace gauntlet::sim
