// Keypoints of a hand of our own, which the physics engine places, in the forms of other people.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/recordings/keypoints/keypoint_angles.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/joint_unit.h"
#include "sim/tables/text_lines.h"
#include "tests/recordings/posed_hand.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kFrames = 240;

/// RMS error [deg] per channel of the angles that points give.
std::map<std::string, double> ErrorsOf(const KeypointAngles& angles) {
  std::map<std::string, double> rms_deg;
  for (std::size_t c = 0; c < angles.channels.size(); ++c) {
    const std::string channel(angles.channels[c]);
    double sum = 0.0;
    for (Eigen::Index k = 0; k < angles.angle_deg.rows(); ++k) {
      const double error = angles.angle_deg(k, static_cast<Eigen::Index>(c)) -
                           AnglesAt(static_cast<int>(k)).at(channel);
      sum += error * error;
    }
    rms_deg[channel] = std::sqrt(sum / static_cast<double>(angles.angle_deg.rows()));
  }
  return rms_deg;
}

TEST(KeypointAngles, AreThoseOfTheHandThatMadeThePoints) {
  const PlacedHand hand = PlaceHand(TrackedPoints(kFrames), 0.0);
  const KeypointAngles angles = AnglesOf(hand);
  ASSERT_EQ(angles.channels.size(), 17U);
  for (std::size_t c = 0; c < angles.channels.size(); ++c) {
    const std::string channel(angles.channels[c]);
    for (int k = 0; k < kFrames; ++k) {
      const auto truth = AnglesAt(k);
      const bool is_held = channel == "finger_spread" &&
                           std::max(truth.at("index_mcp"), truth.at("little_mcp")) > 69.0;
      if (is_held) continue;
      ASSERT_NEAR(angles.angle_deg(k, static_cast<Eigen::Index>(c)), truth.at(channel), 0.5)
          << channel << " " << k;
    }
  }
  EXPECT_LT(angles.residual_m, 5e-4);  // where the spread is held
  EXPECT_LT(hand.bone_spread, 1e-6);
  EXPECT_EQ(hand.implausible, 0U);
  EXPECT_FALSE(hand.is_left);
}

TEST(KeypointAngles, AreTheSameTurnedMirroredAndInOtherUnits) {
  const Eigen::MatrixXd plain = AnglesOf(PlaceHand(TrackedPoints(60), 0.0)).angle_deg;
  for (const Tracker& tracker :
       {Tracker{.turn_rad = 0.1}, Tracker{.is_mirrored = true}, Tracker{.unit = 1e3},
        Tracker{.unit = 100.0, .is_mirrored = true, .turn_rad = -0.2}}) {
    const PlacedHand hand = PlaceHand(TrackedPoints(60, tracker), 0.0);
    EXPECT_LT((AnglesOf(hand).angle_deg - plain).cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_EQ(hand.is_left, tracker.is_mirrored);
    EXPECT_EQ(hand.unit, tracker.unit == 1.0 ? "m" : tracker.unit == 1e3 ? "mm" : "cm");
  }
}

// docs/explanation/recordings.md has these numbers.
TEST(KeypointAngles, HaveTheErrorsThatTheDocumentationStates) {
  const PlacedHand hand = PlaceHand(TrackedPoints(kFrames, {.noise_m = 0.003}), 0.0);
  const KeypointAngles angles = AnglesOf(hand);
  const std::map<std::string, double> rms_deg = ErrorsOf(angles);
  const auto mean_of = [&](std::string_view joint) {
    double sum = 0.0;
    for (const char* finger : {"index", "middle", "ring", "little"}) {
      sum += rms_deg.at(std::string(finger) + std::string(joint)) / 4.0;
    }
    return sum;
  };
  EXPECT_NEAR(mean_of("_mcp"), 7.1, 0.4);
  EXPECT_NEAR(mean_of("_pip"), 13.5, 0.7);
  EXPECT_NEAR(mean_of("_dip"), 18.9, 1.0);
  EXPECT_NEAR(rms_deg.at("thumb_rotation"), 14.3, 0.7);
  EXPECT_NEAR(rms_deg.at("thumb_abduction"), 7.6, 0.4);
  EXPECT_NEAR(rms_deg.at("thumb_mcp"), 13.4, 0.7);
  EXPECT_NEAR(rms_deg.at("thumb_ip"), 18.6, 1.0);
  EXPECT_NEAR(rms_deg.at("finger_spread"), 10.0, 0.5);
  EXPECT_NEAR(1e3 * angles.residual_m, 8.5, 0.5);
  EXPECT_NEAR(100.0 * hand.bone_spread, 9.1, 0.5);
}

/// A name of each of the keypoints, and what stands behind the axis.
struct Skeleton {
  std::string name;
  std::vector<std::string> joints;  // of all, in the order of the file
  std::vector<int> keypoint;        // -1: none of the 21
};

std::vector<int> OrderWithMetacarpals(bool has_palm) {
  std::vector<int> order;
  if (has_palm) order.push_back(-1);
  for (int i = 0; i <= 4; ++i) order.push_back(i);
  for (int finger = 0; finger < 4; ++finger) {
    order.push_back(-1);
    for (int i = 0; i < 4; ++i) order.push_back(5 + 4 * finger + i);
  }
  return order;
}

std::vector<int> OrderOfMediaPipe() {
  std::vector<int> order(kKeypoints);
  for (int i = 0; i < kKeypoints; ++i) order[static_cast<std::size_t>(i)] = i;
  return order;
}

std::vector<std::string> NamesFor(const std::string& wrist, const std::array<std::string, 4>& thumb,
                                  const std::vector<std::string>& finger,
                                  const std::array<std::string, 5>& digits) {
  std::vector<std::string> names = {wrist};
  for (const std::string& joint : thumb) names.push_back(digits[0] + joint);
  for (std::size_t i = 1; i < digits.size(); ++i) {
    for (const std::string& joint : finger) names.push_back(digits[i] + joint);
  }
  return names;
}

std::vector<Skeleton> Skeletons() {
  std::vector<Skeleton> all;
  all.push_back({"MediaPipe",
                 NamesFor("WRIST", {"CMC", "MCP", "IP", "TIP"},
                          {"FINGER_MCP", "FINGER_PIP", "FINGER_DIP", "FINGER_TIP"},
                          {"THUMB_", "INDEX_", "MIDDLE_", "RING_", "PINKY_"}),
                 OrderOfMediaPipe()});
  std::vector<std::string> openxr =
      NamesFor("wrist", {"metacarpal", "proximal", "distal", "tip"},
               {"metacarpal", "proximal", "intermediate", "distal", "tip"},
               {"thumb_", "index_", "middle_", "ring_", "little_"});
  openxr.insert(openxr.begin(), "palm");
  all.push_back({"OpenXR", openxr, OrderWithMetacarpals(true)});
  all.push_back(
      {"WebXR",
       NamesFor("wrist", {"metacarpal", "phalanx-proximal", "phalanx-distal", "tip"},
                {"metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip"},
                {"thumb-", "index-finger-", "middle-finger-", "ring-finger-", "pinky-finger-"}),
       OrderWithMetacarpals(false)});
  all.push_back({"ARKit",
                 NamesFor("wrist", {"Knuckle", "IntermediateBase", "IntermediateTip", "Tip"},
                          {"Metacarpal", "Knuckle", "IntermediateBase", "IntermediateTip", "Tip"},
                          {"thumb", "index", "middle", "ring", "little"}),
                 OrderWithMetacarpals(false)});
  all.push_back({"HoloLens",
                 NamesFor("Wrist", {"MetacarpalJoint", "ProximalJoint", "DistalJoint", "Tip"},
                          {"Metacarpal", "Knuckle", "MiddleJoint", "DistalJoint", "Tip"},
                          {"Thumb", "Index", "Middle", "Ring", "Pinky"}),
                 OrderWithMetacarpals(false)});
  all.push_back({"Manus",
                 NamesFor("Hand", {"MCP", "PIP", "DIP", "TIP"}, {"MCP", "PIP", "IP", "DIP", "TIP"},
                          {"Thumb_", "Index_", "Middle_", "Ring_", "Pinky_"}),
                 OrderWithMetacarpals(false)});
  all.push_back({"names of a finger",
                 NamesFor("wrist", {"mcp", "pip", "dip", "tip"}, {"mcp", "pip", "dip", "tip"},
                          {"thumb_", "index_", "middle_", "ring_", "little_"}),
                 OrderOfMediaPipe()});
  all.push_back({"Rokoko",
                 NamesFor("leftHand", {"Proximal", "Medial", "Distal", "Tip"},
                          {"Proximal", "Medial", "Distal", "Tip"},
                          {"leftThumb", "leftIndex", "leftMiddle", "leftRing", "leftLittle"}),
                 OrderOfMediaPipe()});
  return all;
}

TEST(KeypointLayout, FindsEachKeypointByTheNamesOfEachSkeleton) {
  for (const Skeleton& skeleton : Skeletons()) {
    SCOPED_TRACE(skeleton.name);
    ASSERT_EQ(skeleton.joints.size(), skeleton.keypoint.size());
    std::vector<std::string> names = {"time_s"};
    for (const std::string& joint : skeleton.joints) {
      for (const char* axis : {"_qx", "_qy", "_qz", "_qw", "_x", "_y", "_z"}) {
        names.push_back(joint + axis);
      }
    }
    const KeypointLayout layout = FindKeypoints(names);
    ASSERT_EQ(layout.problem, "");
    ASSERT_EQ(layout.hands.size(), 1U);
    EXPECT_EQ(layout.hands[0].all.size(), names.size() - 1);
    for (std::size_t i = 0; i < skeleton.joints.size(); ++i) {
      if (skeleton.keypoint[i] < 0) continue;
      const auto& position =
          layout.hands[0].position[static_cast<std::size_t>(skeleton.keypoint[i])];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(names[position[axis]], skeleton.joints[i] + "_" + "xyz"[axis]);
      }
    }
  }
}

TEST(KeypointLayout, TakesUnitsHandsAndWorldLandmarksFromNames) {
  std::vector<std::string> names;
  for (const char* stem :
       {"hands_right_landmarks", "hands_right_world_landmarks", "hands_left_world_landmarks"}) {
    for (int i = 1; i <= kKeypoints; ++i) {
      for (const char* end : {"x_mm", "y_mm", "z_mm", "visibility"}) {
        names.push_back(fmt::format("{}_{}_{}", stem, i, end));
      }
    }
  }
  names.emplace_back("hands_right_score");
  const KeypointLayout layout = FindKeypoints(names);
  ASSERT_EQ(layout.hands.size(), 2U) << layout.problem;
  for (const KeypointColumns& hand : layout.hands) {
    EXPECT_EQ(hand.unit_m, 1e-3);
    EXPECT_TRUE(hand.is_named);
    EXPECT_EQ(names[hand.position[8][1]],
              fmt::format("hands_{}_world_landmarks_9_y_mm", hand.hand));
    EXPECT_EQ(hand.confidence.has_value(), hand.hand == "right");
  }
}

TEST(KeypointLayout, NamesWhatAHandLacks) {
  const Skeleton skeleton = Skeletons()[0];
  std::vector<std::string> names;
  for (const std::string& joint : skeleton.joints) {
    for (const char* axis : {"_x", "_y", "_z"}) {
      const bool is_palm = joint == "WRIST";  // of another tracker: no wrist
      names.push_back((is_palm ? "hand" : joint) + axis);
    }
  }
  EXPECT_THAT(FindKeypoints(names).problem, HasSubstr("has no x, y and z of wrist"));
}

TEST(KeypointLayout, LeavesOtherTablesAlone) {
  std::vector<std::string> pose, sensors, angles;
  for (int i = 0; i < 33; ++i) {
    for (const char axis : {'x', 'y', 'z'}) pose.push_back(fmt::format("landmark_{}_{}", i, axis));
  }
  for (int i = 1; i <= 64; ++i) sensors.push_back(fmt::format("ch{}", i));
  for (const char* finger : {"thumb", "index", "middle", "ring", "little"}) {
    for (const char* joint : {"mcp", "pip", "dip", "tip"}) {
      angles.push_back(fmt::format("{}_{}", finger, joint));
    }
  }
  for (const auto& names : {pose, sensors, angles}) {
    EXPECT_TRUE(FindKeypoints(names).hands.empty());
    EXPECT_EQ(FindKeypoints(names).problem, "");
  }
}

TEST(FindKeypoints, TakesAListThatIsCalledLandmarks) {
  std::vector<std::string> names = {"time_s"};
  for (int i = 1; i <= 3 * kKeypoints; ++i) names.push_back(fmt::format("landmarks_{}", i));
  const KeypointLayout layout = FindKeypoints(names);
  ASSERT_EQ(layout.hands.size(), 1U);
  EXPECT_EQ(names[layout.hands[0].position[8][1]], "landmarks_26");
  names.pop_back();
  EXPECT_TRUE(FindKeypoints(names).hands.empty());
}

TEST(FindKeypoints, AsksWhereSeveralHandsHaveNoSide) {
  const auto layout_of = [](const std::vector<std::string>& stems) {
    std::vector<std::string> names;
    for (const std::string& stem : stems) {
      for (int i = 0; i < kKeypoints; ++i) {
        for (const char axis : {'x', 'y', 'z'}) {
          names.push_back(fmt::format("{}_landmark_{}_{}", stem, i, axis));
        }
      }
    }
    return FindKeypoints(names);
  };
  EXPECT_EQ(layout_of({"left", "right"}).hands.size(), 2U);
  for (const std::vector<std::string>& stems : {std::vector<std::string>{"old", "new"},
                                                {"left", "new"},
                                                {"old", "right"},
                                                {"left_old", "left_new"},
                                                {"left", "right", "new"},
                                                {"left", "right_old", "right_new"},
                                                {"old_1", "new_2"}}) {
    const KeypointLayout layout = layout_of(stems);
    EXPECT_TRUE(layout.has_several) << stems.back();
    EXPECT_TRUE(layout.hands.empty()) << stems.back();
    EXPECT_THAT(layout.problem, HasSubstr("has keypoints of several hands or kinds ("))
        << stems.back();
  }
}

TEST(KeypointName, IsThatOfItsJoint) {
  const std::vector<std::string> names = {
      "wrist",      "thumb_cmc",  "thumb_mcp", "thumb_ip",   "thumb_tip",  "index_mcp",
      "index_pip",  "index_dip",  "index_tip", "middle_mcp", "middle_pip", "middle_dip",
      "middle_tip", "ring_mcp",   "ring_pip",  "ring_dip",   "ring_tip",   "little_mcp",
      "little_pip", "little_dip", "little_tip"};
  for (int i = 0; i < kKeypoints; ++i)
    EXPECT_EQ(KeypointName(i), names[static_cast<std::size_t>(i)]);
}

TEST(FindKeypoints, LeavesNumbersWithoutAxesToAQuestion) {
  std::vector<std::string> names = {"time_s"};
  for (int i = 1; i <= 3 * kKeypoints; ++i) names.push_back(fmt::format("value_{}", i));
  EXPECT_TRUE(FindKeypoints(names).hands.empty());
  EXPECT_TRUE(FindKeypoints(std::vector<std::string>(3 * kKeypoints)).hands.empty());
}

// --- Files ---------------------------------------------------------------------------------------

class KeypointFiles : public ::testing::Test {
 protected:
  fs::path Written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
    return folder_.path() / name;
  }
  const std::vector<HandPoints> points_ = TrackedPoints(60, {.turn_rad = 0.02});
  const test::TemporaryDirectory folder_;
};

/// The columns of the table that is made of a file, by name, and its remarks.
struct AngleTable {
  std::map<std::string, std::vector<double>> columns;
  std::string remarks;
};

AngleTable TableOf(const fs::path& file) {
  AngleTable table;
  const std::string text = test::TextOf(TableSource(file));
  std::vector<std::string> names;
  for (const std::string_view line : SplitLines(text)) {
    if (line.starts_with('#')) {
      table.remarks += std::string(line) + "\n";
      continue;
    }
    const auto cells = SplitCells(line);
    if (names.empty()) {
      names.assign(cells.begin(), cells.end());
      continue;
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      table.columns[names.at(c)].push_back(
          controller::ParseNumber(cells[c]).value_or(controller::kNaN));
    }
  }
  return table;
}

void ExpectAngles(const AngleTable& table, const std::string& before = "", int frames = 60) {
  for (const char* channel :
       {"thumb_rotation", "thumb_ip", "index_mcp", "middle_pip", "ring_dip", "little_mcp"}) {
    const auto column = table.columns.find(before + channel + "_deg");
    ASSERT_NE(column, table.columns.end()) << before << channel;
    ASSERT_EQ(std::ssize(column->second), frames);
    for (int k = 0; k < frames; ++k) {
      ASSERT_NEAR(column->second[static_cast<std::size_t>(k)], AnglesAt(k).at(channel), 0.5)
          << channel << " " << k;
    }
  }
}

std::string CellsOf(const HandPoints& points, int keypoint, const char* separator = ",") {
  return fmt::format("{:.7g}{}{:.7g}{}{:.7g}", points(0, keypoint), separator, points(1, keypoint),
                     separator, points(2, keypoint));
}

TEST_F(KeypointFiles, OfTextAreReadInEveryForm) {
  // A column per axis of each joint, of 26 that are numbered as in OpenXR.
  std::string wide = "timestamp_ms";
  const std::vector<int> order = OrderWithMetacarpals(true);
  for (std::size_t i = 0; i < order.size(); ++i)
    wide += fmt::format(",joint_{0}_x,joint_{0}_y,joint_{0}_z", i);
  // A row per joint, as Unity scripts write them, of both hands; the left one is the mirror image.
  std::string rows = "Time,Hand,Joint,Position_X,Position_Y,Position_Z\n";
  // Lines of Hand Tracking Streamer.
  std::string lines;
  for (int k = 0; k < 60; ++k) {
    const HandPoints& frame = points_[static_cast<std::size_t>(k)];
    wide += fmt::format("\n{}", 20 * k);
    for (const int keypoint : order) wide += "," + CellsOf(frame, std::max(keypoint, 0));
    for (const bool is_left : {true, false}) {
      HandPoints points = frame;
      if (is_left) points.row(0) *= -1.0;
      const Skeleton openxr = Skeletons()[1];
      for (std::size_t i = 0; i < openxr.joints.size(); ++i) {
        rows += fmt::format("{:.3f},{},{},{}\n", 0.02 * k, is_left ? "Left" : "Right",
                            openxr.joints[i], CellsOf(points, std::max(openxr.keypoint[i], 0)));
      }
    }
    lines += "Right wrist:, 0, 0, 0, 0, 0, 0, 1\n";
    lines += fmt::format("Right landmarks | f = {} | t = {}:", k, 20000000LL * k);
    for (int i = 0; i < kKeypoints; ++i) {
      lines += ", " + CellsOf(frame, i, ", ");
    }
    lines += "\n";
  }
  ExpectAngles(TableOf(Written("wide.csv", wide + "\n")));
  const AngleTable both = TableOf(Written("rows.csv", rows));
  ExpectAngles(both, "left_");
  ExpectAngles(both, "right_");
  EXPECT_EQ(both.columns.at("Time")[3], 0.06);
  EXPECT_THAT(both.remarks, HasSubstr("keypoints of a left hand"));
  const AngleTable streamed = TableOf(Written("lines.txt", lines));
  ExpectAngles(streamed);
  EXPECT_EQ(streamed.columns.at("timestamp_ns")[2], 4e7);
}

TEST_F(KeypointFiles, OfTwoHandsInOneRowHaveTheirSidesByTheirShape) {
  std::string both = "[", twice = "[";
  for (int k = 0; k < 60; ++k) {
    const HandPoints& frame = points_[static_cast<std::size_t>(k)];
    std::string right, left;
    for (int i = 0; i < kKeypoints; ++i) {
      right += fmt::format("{}[{}]", i > 0 ? "," : "", CellsOf(frame, i));
      left += fmt::format("{}[{},{},{}]", i > 0 ? "," : "", -frame(0, i), frame(1, i), frame(2, i));
    }
    const char* comma = k > 0 ? "," : "";
    both += fmt::format("{}[[{}],[{}]]", comma, left, right);
    twice += fmt::format("{}[[{}],[{}]]", comma, right, right);
  }
  const AngleTable table = TableOf(Written("both.json", both + "]"));
  ExpectAngles(table, "left_");
  ExpectAngles(table, "right_");
  try {
    TableOf(Written("twice.json", twice + "]"));
    FAIL();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("keypoints of two right hands by their shape"));
  }
}

TEST_F(KeypointFiles, OfJsonAreReadInEveryForm) {
  std::string listed, tasks, matrices, axes;
  const Skeleton arkit = Skeletons()[3];
  for (int k = 0; k < 60; ++k) {
    const HandPoints& frame = points_[static_cast<std::size_t>(k)];
    std::string pairs, triples, x, y, z;
    for (int i = 0; i < kKeypoints; ++i) {
      const char* comma = i > 0 ? ", " : "";
      pairs += fmt::format("{}{{\"x\": {}, \"y\": {}, \"z\": {}}}", comma, frame(0, i), frame(1, i),
                           frame(2, i));
      triples += fmt::format("{}[{}]", comma, CellsOf(frame, i));
      x += fmt::format("{}\"{}\": {}", comma, i, frame(0, i));
      y += fmt::format("{}\"{}\": {}", comma, i, frame(1, i));
      z += fmt::format("{}\"{}\": {}", comma, i, frame(2, i));
    }
    // The hand is the second one in every third frame, behind a left one, and lost in one.
    std::string hands =
        fmt::format(R"({{"handedness": "Right", "score": 0.9, "world_landmarks": [{}]}})", pairs);
    if (k % 3 == 0) hands.insert(0, R"({"handedness": "Left", "score": 0.4}, )");
    listed += fmt::format("{}{{\"timestamp\": {}, \"hands\": [{}]}}", k > 0 ? ", " : "[", 0.03 * k,
                          k == 7 ? "" : hands);
    tasks += fmt::format(
        "{{\"timestamp_ms\": {}, \"handedness\": [[{{\"score\": 0.9, "
        "\"categoryName\": \"Right\"}}]], \"landmarks\": [[{}]], "
        "\"worldLandmarks\": [[{}]]}}\n",
        30 * k, triples, pairs);
    matrices += fmt::format("{{\"timestamp\": {}, \"rightHand\": {{", 0.02 * k);
    for (std::size_t i = 0; i < arkit.joints.size(); ++i) {
      matrices += fmt::format("{}\"{}\": [1,0,0,0,0,1,0,0,0,0,1,0,{},1]", i > 0 ? "," : "",
                              arkit.joints[i], CellsOf(frame, std::max(arkit.keypoint[i], 0)));
    }
    matrices += "}}\n";
    axes += fmt::format(
        "{{\"timestamp\": {}, \"landmarks\": {{\"Right\": {{\"x\": {{{}}}, \"y\": "
        "{{{}}}, \"z\": {{{}}}}}}}}}\n",
        1741859037460LL + 20 * k, x, y, z);
  }
  const AngleTable table = TableOf(Written("listed.json", listed + "]"));
  EXPECT_EQ(std::ssize(table.columns.at("index_mcp_deg")), 59);
  EXPECT_NEAR(table.columns.at("index_mcp_deg")[58], AnglesAt(59).at("index_mcp"), 0.5);
  EXPECT_THAT(table.remarks, HasSubstr("1.7 % of the frames lost"));
  ExpectAngles(TableOf(Written("tasks.jsonl", tasks)));
  ExpectAngles(TableOf(Written("matrices.jsonl", matrices)));
  ExpectAngles(TableOf(Written("axes.jsonl", axes)));
}

TEST_F(KeypointFiles, OfNumpyAreReadByTheLengthsOfBones) {
  const auto npy = [](const std::string& shape, const std::vector<float>& values) {
    std::string header =
        fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}", shape);
    header.resize(118, ' ');
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(header.size());
    bytes += '\0';
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(values.data()), 4 * values.size());
    return bytes;
  };
  std::vector<float> values, shuffled;
  for (const HandPoints& frame : points_) {
    for (int i = 0; i < kKeypoints; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        values.push_back(static_cast<float>(frame(axis, i)));
        shuffled.push_back(static_cast<float>(frame(axis, i * 8 % kKeypoints)));
      }
    }
  }
  const AngleTable assumed = TableOf(Written("points.npy", npy("(60, 21, 3)", values)));
  ExpectAngles(assumed);
  EXPECT_THAT(assumed.remarks, HasSubstr("MediaPipe (assumed) [m]"));
  // The shape is one fact, the bones are the other. Without the shape they are so many numbers.
  EXPECT_EQ(TableOf(Written("flat.npy", npy("(60, 63)", values))).columns.size(), 63U);
  // In another order the bones change their lengths: so many sensors of an unknown kind.
  const AngleTable other = TableOf(Written("shuffled.npy", npy("(60, 21, 3)", shuffled)));
  EXPECT_EQ(other.columns.size(), 63U);
}

std::string MediaPipeText(const std::vector<HandPoints>& frames) {
  std::string text = "time_s";
  const Skeleton skeleton = Skeletons()[0];
  for (const std::string& joint : skeleton.joints) {
    text += fmt::format(",{0}_x,{0}_y,{0}_z", joint);
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    text += fmt::format("\n{}", 0.02 * static_cast<double>(k));
    for (int i = 0; i < kKeypoints; ++i) text += "," + CellsOf(frames[k], i);
  }
  return text + "\n";
}

TEST_F(KeypointFiles, LeaveOutLostFrames) {
  std::vector<HandPoints> frames = points_;
  frames[10].setZero();
  frames[20](1, 4) = controller::kNaN;
  for (std::size_t k = 31; k < 40; ++k) frames[k] = frames[30];
  for (std::size_t k = 51; k < 54; ++k) frames[k] = frames[50];  // a slow tracker, not a lost one
  const AngleTable table = TableOf(Written("lost.csv", MediaPipeText(frames)));
  EXPECT_EQ(table.columns.at("time_s").size(), 60U - 11U);
  EXPECT_THAT(table.remarks, HasSubstr("18 % of the frames lost"));
}

TEST_F(KeypointFiles, AreRefusedWhereTheyCannotBeTold) {
  const auto problem = [&](const std::function<void(HandPoints&)>& change) {
    std::vector<HandPoints> frames = points_;
    for (HandPoints& frame : frames) change(frame);
    try {
      test::TextOf(TableSource(Written("refused.csv", MediaPipeText(frames))));
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // As MediaPipe writes landmarks in an image: parts of its width and height, the wrist at depth 0.
  EXPECT_THAT(problem([](HandPoints& frame) {
                frame.row(2).array() -= frame(2, 0);
                frame(2, 0) = 3e-8;
                frame.row(1) *= 1.7;
              }),
              HasSubstr("refused.csv: the wrist has no depth: these are landmarks in an image"));
  EXPECT_THAT(problem([](HandPoints& frame) { frame *= 39.37; }),
              HasSubstr("must be from 0.1 to 0.3 m, cm or mm"));
  EXPECT_THAT(problem([](HandPoints& frame) { frame.setZero(); }),
              HasSubstr("no row has all keypoints"));
  const HandPoints flat = PosedHand().PointsAt([] {
    auto angles = AnglesAt(0);
    for (auto& [joint, angle] : angles) angle = 0.0;
    return angles;
  }());
  EXPECT_THAT(problem([&, k = 0](HandPoints& frame) mutable { frame = flat.array() + 1e-3 * k++; }),
              HasSubstr("the fingers never bend, so the side of the palm is unknown"));
  // Points that do not move with the hand.
  EXPECT_THAT(problem([k = 0](HandPoints& frame) mutable {
                ++k;
                frame.col(0) += 0.1 * Eigen::Vector3d(std::sin(0.9 * k), std::cos(0.9 * k), 0.5);
                for (int i = 5; i < kKeypoints; i += 2) frame.col(i) *= 1.0 + 0.3 * (k % 2);
              }),
              HasSubstr("the bones change their lengths by"));
}

// --- Joints that slide ---------------------------------------------------------------------------

TEST(JointUnit, IsDecidedByTypeThenNameThenValues) {
  const JointTypes types = JointTypesIn(
      "<robot><joint type='prismatic' name=\"lift_left\"/><joint\n  name=\"finger_joint\" "
      "type=\"revolute\"><parent link=\"a\"/></joint><jointed name='x' type='y'/></robot>");
  EXPECT_EQ(UnitOfJoint("lift_left", 1.2, types).suffix, "_m");
  EXPECT_EQ(UnitOfJoint("finger_joint", 0.04, types).suffix, "_rad");
  const JointTypes none;
  struct Case {
    const char* name;
    double largest;
    const char* suffix;
  };
  for (const Case& one : {Case{"panda_finger_joint1", 0.04, ""}, Case{"gripper", 0.8, ""},
                          Case{"left_gripper", 0.05, ""}, Case{"gripper", 0.0, ""},
                          Case{"finger_joint", controller::kNaN, ""},
                          Case{"index_finger_mcp", 0.04, "_rad"}, Case{"ring_mcp", 1.5, "_rad"},
                          Case{"shoulder_pan", 45.0, ""}, Case{"front_wheel", 45.0, "_rad"},
                          Case{"finger_spread", 0.1, "_rad"}, Case{"finger1_joint2", 0.1, "_rad"},
                          Case{"elbow", controller::kNaN, "_rad"}, Case{"elbow_deg", 45.0, ""}}) {
    EXPECT_EQ(UnitOfJoint(one.name, one.largest, none).suffix, one.suffix) << one.name;
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
