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

TEST(JointsByNames, AssumeTheMiddleJointForTheOnlySensorOfAFinger) {
  std::string question;
  EXPECT_THAT(ChannelsOf({"thumb", "index", "ring_pip", "ring", "x"}, question),
              ElementsAre("thumb_ip", "index_pip", "ring_pip", "", ""));
  const auto joints = JointsByNames({"thumb", "ring_pip"}, question);
  EXPECT_EQ(joints[0].basis, JointBasis::kAssumed);
  EXPECT_EQ(joints[1].basis, JointBasis::kName);
  EXPECT_EQ(question, "");
}

TEST(JointsByNames, AskForTheJointsOfSeveralSensorsOfAFinger) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"thumb", "index_1", "index_2"}, {"thumb", "rh_FFJ1", "rh_FFJ2"}}) {
    std::string question;
    EXPECT_THAT(ChannelsOf(names, question), ElementsAre("thumb_ip", "", ""));
    EXPECT_EQ(question, names[1] + " and " + names[2] +
                            " are of one finger, and the joint of each is unknown");
  }
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
