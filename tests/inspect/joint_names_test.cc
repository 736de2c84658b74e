#include "sim/inspect/joint_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

TEST(WordsOf, TakesNamesApart) {
  EXPECT_THAT(WordsOf("IndexPIP_deg2"), ElementsAre("index", "pip", "deg", "2"));
  EXPECT_THAT(WordsOf("R.hand/thumb-ip (V)"), ElementsAre("r", "hand", "thumb", "ip", "v"));
  EXPECT_THAT(WordsOf("q_FFJ3"), ElementsAre("q", "ffj", "3"));
  EXPECT_THAT(WordsOf("ThumbMCPStretch"), ElementsAre("thumb", "mcp", "stretch"));
  EXPECT_THAT(WordsOf(""), ElementsAre());
}

TEST(ReadSensorName, KnowsTheJointsOfManyGloves) {
  const std::pair<const char*, const char*> known[] = {
      {"index_mcp", "index_mcp"},
      {"RightPinkyProximal", "little_mcp"},
      {"middle finger PIP", "middle_pip"},
      {"Thumb CMC", "thumb_rotation"},
      {"thumb_distal", "thumb_ip"},
      {"ring-abduction", "finger_spread"},
      {"ThumbMCPSpread", "thumb_abduction"},
      {"IndexMCPStretch", "index_mcp"},
      {"index inner", "index_mcp"},
      {"index middle", "index_pip"},  // the middle joint of a CyberGlove's index finger
      {"wrist yaw", "wrist_deviation"},
      {"wrist_pitch", "wrist_flexion"},
      {"ElbowAngle", "elbow_flexion"},
  };
  for (const auto& [name, channel] : known)
    EXPECT_EQ(ReadSensorName(name).channel, channel) << name;
}

TEST(NoSensor, TellsMotionSensorsAndLabelsFromFingers) {
  for (const char* name : {"qw", "Acc_X", "gyro.z", "temperature", "label", "EMG3", "mag_1"}) {
    EXPECT_NE(NoSensor(name), "") << name;
  }
  for (const char* name : {"thumb", "flex1", "s7", "wrist_pitch", ""})
    EXPECT_EQ(NoSensor(name), "") << name;
}

TEST(ChannelsByNames, ShareAFingersSensorsOut) {
  std::vector<std::string> why;
  EXPECT_THAT(
      ChannelsByNames({"thumb", "index1", "index2", "ring_1", "ring_2", "ring_3", "x"}, why),
      ElementsAre("thumb_ip", "index_mcp", "index_pip", "ring_mcp", "ring_pip", "ring_dip", ""));
  EXPECT_THAT(ChannelsByNames({"LFJ4", "LFJ3", "LFJ2", "LFJ1", "LFJ0"}, why),
              ElementsAre("", "", "little_mcp", "little_pip", "little_dip"));
  EXPECT_THAT(ChannelsByNames({"index_mcp", "index_mcp_raw"}, why), ElementsAre("index_mcp", ""));
  EXPECT_EQ(why[1], "index_mcp has a column already");
}

}  // namespace
}  // namespace gauntlet::sim
