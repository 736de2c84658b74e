#include "sim/fit/retarget/fingertip_motion.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <string>

#include "sim/base/error.h"
#include "sim/fit/retarget/retargeting.h"
#include "tests/retargeting/motions.h"

namespace gauntlet::sim::testing {
namespace {

std::filesystem::path Written(const std::string& name, const std::string& text) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / name;
  std::ofstream(file) << text;
  return file;
}

/// How keypoints are written: mirrored for a left hand, turned and moved by a moving arm.
struct Placement {
  bool is_left = false;
  double turn_rad = 0.0;  // per row
  double unit = 1.0;      // per metre
  std::string suffix = {};
  bool bends = true;
};

/// OpenXR keypoints of hand_arm.xml, whose fingers bend row by row, with radii of its fingertips.
std::string KeypointText(const Placement& placement, int rows) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  std::string text = "time_s";
  std::vector<std::string> names = {"wrist"};
  for (const std::string_view digit : HandKinematics::kFingerNames) {
    const bool is_thumb = digit == "thumb";
    for (const char* joint : {is_thumb ? "metacarpal" : "proximal",
                              is_thumb ? "proximal" : "intermediate", "distal", "tip"}) {
      names.push_back(fmt::format("{}_{}", digit, joint));
    }
  }
  for (const std::string& name : names) {
    for (const char* axis : {"x", "y", "z"})
      text += fmt::format(",{}_{}{}", name, axis, placement.suffix);
  }
  text += "\n";
  for (int row = 0; row < rows; ++row) {
    std::vector<double> angles = hand.NeutralAngles();
    for (std::size_t j = 0; j < angles.size() && placement.bends; ++j) {
      if (hand.joints()[j].name.ends_with("_mcp")) angles[j] = 0.03 * row;
      if (hand.joints()[j].name == "thumb_abduction") angles[j] = 1.0;  // apart from the fingers
    }
    hand.SetAngles(angles);
    std::vector<Eigen::Vector3d> points = {Eigen::Vector3d::Zero()};
    for (int finger = 0; finger < kFingers; ++finger) {
      const Eigen::Vector3d base = hand.digits()[finger].base_m;
      const Eigen::Vector3d tip = hand.Tip(finger);
      const Eigen::Vector3d last = tip - 0.014 * hand.TipDirection(finger);
      points.insert(points.end(), {base, 0.5 * (base + last), last, tip});
    }
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(placement.turn_rad * row, Eigen::Vector3d(1, 2, 3).normalized())
            .toRotationMatrix();
    text += fmt::format("{}", 0.02 * row);
    for (Eigen::Vector3d point : points) {
      if (placement.is_left) point.y() = -point.y();
      point = placement.unit * (turn * point + Eigen::Vector3d(0.1, 1.2 + 0.01 * row, -0.3));
      text += fmt::format(",{},{},{}", point.x(), point.y(), point.z());
    }
    text += "\n";
  }
  return text;
}

TEST(FingertipsOfKeypoints, AreThoseOfTheHandInAnyPlaceAndUnit) {
  const FingertipMotion plain = FingertipsOfKeypoints(Written("a.csv", KeypointText({}, 30)), {});
  for (const Placement& placement :
       {Placement{.is_left = true}, Placement{.turn_rad = 0.1},
        Placement{.is_left = true, .turn_rad = -0.2}, Placement{.unit = 1e3, .suffix = "_mm"},
        Placement{.unit = 1e3}, Placement{.suffix = "_m"}}) {
    const FingertipMotion motion =
        FingertipsOfKeypoints(Written("b.csv", KeypointText(placement, 30)), {});
    ASSERT_EQ(motion.frames.size(), plain.frames.size());
    for (std::size_t k = 0; k < plain.frames.size(); ++k) {
      for (int finger = 0; finger < kFingers; ++finger) {
        EXPECT_LT((motion.frames[k].reach_m[finger] - plain.frames[k].reach_m[finger]).norm(),
                  1e-6);
        EXPECT_NEAR(motion.frames[k].gap_m[finger], plain.frames[k].gap_m[finger], 1e-6);
      }
    }
  }
}

TEST(FingertipsOfKeypoints, GiveTheAnglesOfTheHandThatMadeThem) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  const FingertipMotion motion =
      FingertipsOfKeypoints(Written("c.csv", KeypointText({.turn_rad = 0.1}, 30)), {});
  const RetargetedMotion retargeted = Retarget(motion, hand);
  const auto joint = std::ranges::find(retargeted.joints, "middle_mcp") - retargeted.joints.begin();
  for (int row = 0; row < 30; ++row) {
    // The frame of keypoints is found from the wrist, that of the hand from straight fingers.
    EXPECT_NEAR(retargeted.angle_rad(row, joint), 0.03 * row, 3.0 * kRadPerDeg);
  }
}

/// The message of what is thrown.
template <class Action>
std::string ErrorOf(const Action& action) {
  try {
    action();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(FingertipsOfKeypoints, RefusesWhatItCannotTell) {
  const auto error_of = [](const std::string& text) {
    const auto file = Written("d.csv", text);
    return ErrorOf([&] { FingertipsOfKeypoints(file, {}); });
  };
  EXPECT_NE(error_of(KeypointText({.unit = 1e3, .suffix = "_m"}, 30)).find(" m, must be from 0.1"),
            std::string::npos);
  EXPECT_NE(error_of(KeypointText({.unit = 39.4}, 30)).find("must be from 0.1 to 0.3 m"),
            std::string::npos);
  EXPECT_NE(error_of(KeypointText({.bends = false}, 30)).find("never bend"), std::string::npos);
  std::string text = KeypointText({}, 30);
  text.replace(text.find("ring_tip_y"), 10, "ring_end_y");
  EXPECT_NE(error_of(text).find("has no x, y and z of ring_tip"), std::string::npos);
}

TEST(FingertipsOfAngles, TellsDegreesFromRadiansByTheNameOnly) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  const auto motion_of = [&](const std::string& text) {
    return FingertipsOfAngles(Written("e.csv", text), hand, {});
  };
  const auto degrees = motion_of("time_s,index_mcp\n0,60\n1,30\n");
  const auto radians =
      motion_of("time_s,index_mcp_rad\n0,1.0471975511965976\n1,0.5235987755982988\n");
  EXPECT_LT((degrees.frames[0].reach_m[1] - radians.frames[0].reach_m[1]).norm(), 1e-12);
  EXPECT_NE(ErrorOf([&] { motion_of("time_s,index_mcp\n0,1.04\n1,0.52\n"); }).find("radians"),
            std::string::npos);
}

TEST(FingertipsOfAngles, HasTheDigitsThatWereRecorded) {
  HandKinematics hand = ModelHand("hand_arm.xml");
  const FingertipMotion motion = FingertipsOfAngles(
      Written("f.csv", "time_s,index_mcp,wrist_flexion,note\n0,60,5,\n1,,7,\n2,30,9,\n"), hand,
      {.copied = {"wrist_flexion"}});
  EXPECT_TRUE(motion.has_digit[HandKinematics::kIndex]);
  EXPECT_FALSE(motion.has_digit[HandKinematics::kThumb]);
  EXPECT_EQ(motion.is_missing, (std::vector<bool>{false, true, false}));
  EXPECT_EQ(motion.other_joints, std::vector<std::string>{"wrist_flexion"});
  EXPECT_NEAR(motion.other_angle_rad(2, 0), 9.0 * kRadPerDeg, 1e-12);
  EXPECT_EQ(motion.remarks.size(), 2);  // joints that are held, the column that was left out
}

}  // namespace
}  // namespace gauntlet::sim::testing
