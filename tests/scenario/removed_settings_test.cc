// Files of earlier versions list settings that are no more.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/scenario/scenario_tree.h"

namespace gauntlet::sim {
namespace {

using ::testing::HasSubstr;

/// Settings that a finished run of 0.3.0 lists beside those that still exist.
constexpr auto kOld = R"(question: Which?
glove:
  motion:
    kind: sequence
    parts:
      - {kind: grasp, grasp: power, finger_lag_ms: 15}
      - {kind: hold, duration_s: 1}
  tremor: {rms_deg: 0, shared_percent: 50}
  sensor: {low_percent: 10, high_percent: 90, gain_deviation_percent: 2,
           hysteresis_deviation_percent: 20, lag_deviation_percent: 20}
  noise: {kind: galton, walk_counts_per_sqrt_s: 0, recording: "", recording_map: "", recording_rate_hz: 0, recording_scale: 1}
hand:
  cable: {interference: true, backlash_deg: 0.1, stretch: true}
  wear: {slack_mm_per_hour: [0], slack_mm_per_km: [0], snap: {cable: "", at_s: 0}}
link:
  glove: {duplicates_percent: 2, clock_offset_ms: 30, reorders: false, clock_drift_ppm: 0}
event: {jitter_ms: 0, loss_percent: 0}
controllers:
  raw: {filter: none}
)";

std::string ErrorOf(std::string text, const std::string& old, const std::string& replacement) {
  text.replace(text.find(old), old.size(), replacement);
  try {
    ParseScenarioText("old.yaml", text);
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

TEST(RemovedSettings, WithoutEffectAreLeftOutAndNothingElse) {
  const Scenario scenario = ParseScenario({.file = "old.yaml", .text = kOld});
  EXPECT_EQ(scenario.glove.sensor.gain_deviation_percent, 2.0);
  EXPECT_EQ(scenario.hand.cable.backlash_deg, 0.1);
  EXPECT_TRUE(scenario.link && scenario.link->glove);
  YamlNode root = ParseYaml("new.yaml", "controllers:\n  raw: {filter: none}\n");
  const YamlNode before = root;
  LeaveOutRemovedSettings({.file = "new.yaml"}, root);
  EXPECT_TRUE(root.Is(before));
}

TEST(RemovedSettings, WithAnEffectAreRefusedWithWhatToUse) {
  EXPECT_THAT(ErrorOf(kOld, "slack_mm_per_hour: [0]", "slack_mm_per_hour: [2]"),
              HasSubstr("old.yaml:14:29: hand.wear.slack_mm_per_hour: is [2], but this setting was "
                        "removed: compare values of hand.cable.slack_mm"));
  EXPECT_THAT(ErrorOf(kOld, "finger_lag_ms: 15", "finger_lag_ms: 40"),
              HasSubstr("finger_lag_ms: is 40, but this setting was removed"));
  EXPECT_THAT(ErrorOf(kOld, "finger_lag_ms: 15", "finger_lag_ms: 0"),  // not that of a grasp
              HasSubstr("glove.motion.finger_lag_ms: is 0, but this setting was removed"));
  EXPECT_THAT(ErrorOf(kOld, "duration_s: 1", "duration_s: 1, finger_lag_ms: 15"),
              HasSubstr("glove.motion.finger_lag_ms: is 15, but this setting was removed"));
  EXPECT_EQ(ErrorOf(kOld, "duration_s: 1", "duration_s: 1, finger_lag_ms: 0"), "");
  EXPECT_THAT(ErrorOf(kOld, "cable: \"\"", "cable: index_mcp_flexor"),
              HasSubstr("hand.wear.snap.cable: is index_mcp_flexor"));
  EXPECT_EQ(ErrorOf(kOld, "clock_offset_ms: 30", "clock_offset_ms: 7"), "");
  for (const auto& [setting, instead] : std::initializer_list<std::pair<std::string, std::string>>{
           {"hysteresis_deviation_percent: 2", "it is always 20"},
           {"lag_deviation_percent: 2", "it is always 20"},
           {"walk_counts_per_sqrt_s: ", "pink_variance_counts2"},
           {"reorders: ", "in the order in which they were sent"},
           {"clock_drift_ppm: ", "run alike"},
           {"event: {jitter_ms: ", "link.hand.delay"},
           {"loss_percent: ", "link.hand.loss"},
           {"stretch: ", "hand.cable.stiffness_scale: 8"}}) {
    EXPECT_THAT(ErrorOf(kOld, setting, setting + "1"), HasSubstr(instead)) << setting;
  }
}

}  // namespace
}  // namespace gauntlet::sim
