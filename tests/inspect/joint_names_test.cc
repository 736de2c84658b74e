#include "sim/recordings/inspect/joint_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;

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

std::vector<std::string> ChannelsOf(const std::vector<std::string>& names, std::string& question) {
  std::vector<std::string> channels;
  for (const ColumnJoint& joint : JointsByNames(names, question)) channels.push_back(joint.channel);
  return channels;
}

TEST(ReadJointName, TakesTheGrammarAndNamesOtherWords) {
  const std::pair<const char*, const char*> names[] = {
      {"index_mcp", ""},           {"R_Index_MCP_Flex [deg]", ""},
      {"leftThumbIPAngle", ""},    {"wrist_flexion_rad", ""},
      {"index middle", ""},        {".ring_2", ""},
      {"emg_thumb", "emg"},        {"Pinch_ThumbToIndex", "pinch to pair"},
      {"manus.index_mcp", "manus"}};
  for (const auto& [name, other] : names) {
    EXPECT_TRUE(ReadJointName(name).is_joint) << name;
    EXPECT_EQ(ReadJointName(name).other, other) << name;
  }
  EXPECT_EQ(ReadJointName("R_Index_MCP_Flex").side, "right");
  EXPECT_FALSE(ReadJointName("temperature_2").is_joint);
}

TEST(JointsByNames, TakeSensorsOfAFingerByTheirNumbers) {
  std::string question;
  EXPECT_THAT(ChannelsOf({"thumb_2", "thumb_1", "index_2", "index_1"}, question),
              ElementsAre("thumb_ip", "thumb_mcp", "index_pip", "index_mcp"));
}

TEST(JointsByNames, ShareAFingersSensorsOut) {
  std::string question;
  EXPECT_THAT(
      ChannelsOf({"thumb", "index1", "index2", "ring_1", "ring_2", "ring_3", "x"}, question),
      ElementsAre("thumb_ip", "index_mcp", "index_pip", "ring_mcp", "ring_pip", "ring_dip", ""));
  EXPECT_THAT(ChannelsOf({"LFJ4", "LFJ3", "LFJ2", "LFJ1", "LFJ0"}, question),
              ElementsAre("", "", "little_mcp", "little_pip", "little_dip"));
  EXPECT_THAT(ChannelsOf({"rh_FFJ1", "rh_FFJ2", "rh_FFJ3"}, question),
              ElementsAre("index_dip", "index_pip", "index_mcp"));  // from the tip
  for (const ColumnJoint& joint : JointsByNames({"thumb", "index1", "index2"}, question)) {
    EXPECT_EQ(joint.basis, JointBasis::kAssumed);
  }
  EXPECT_EQ(question, "");
}

TEST(JointsByNames, ShiftAThumbWithNamesOfAFinger) {
  std::string question;
  EXPECT_THAT(ChannelsOf({"thumb_mcp", "thumb_pip", "thumb_dip", "index_mcp"}, question),
              ElementsAre("thumb_rotation", "thumb_mcp", "thumb_ip", "index_mcp"));
  EXPECT_THAT(ChannelsOf({"thumb_mcp", "thumb_pip"}, question),
              ElementsAre("thumb_mcp", "thumb_ip"));
  EXPECT_EQ(question, "");
}

TEST(JointsByNames, AskIfTwoColumnsNameOneJoint) {
  std::string question;
  ChannelsOf({"index_abd", "ring_abd"}, question);
  EXPECT_EQ(question, "");  // the first one drives the spread
  ChannelsOf({"index_mcp", "index_knuckle"}, question);
  EXPECT_EQ(question, "index_mcp and index_knuckle both name index_mcp");
}

}  // namespace
}  // namespace gauntlet::sim
