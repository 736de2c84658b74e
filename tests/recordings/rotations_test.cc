// Rotations of the bones of a hand of our own, which the physics engine places, as trackers and
// gloves write them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
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
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/text_lines.h"
#include "tests/recordings/posed_hand.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim::testing {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kFrames = 120;
constexpr std::array<const char*, 5> kDigits = {"thumb", "index", "middle", "ring", "little"};

/// Axes of bones, by those of the bodies: x along the bone, z out of the back of the hand.
struct Axes {
  Matrix3d of_body = Matrix3d::Identity();
  bool is_left_handed = false;
};

/// -z along the bone, y out of the back. Source: OpenXR 1.0, XR_EXT_hand_tracking.
Axes OpenXrAxes() {
  Axes axes;
  axes.of_body << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  return axes;
}

/// How a file has the rotations.
struct Form {
  Axes axes = OpenXrAxes();
  bool is_local = false;
  bool is_left_hand = false;
  double turn_rad = 0.03;                   // of the hand per frame
  std::array<int, 4> order = {0, 1, 2, 3};  // of w, x, y, z
};

/// The four values of each bone, as the file has them.
using Frame = std::array<std::array<double, 4>, kTurnedBones>;

int ParentOf(int bone) {
  const int digit = (bone - 1) / kBonesOfDigit;
  const int place = (bone - 1) % kBonesOfDigit;
  if (place == 0) return 0;
  return digit == 0 && place == 3 ? bone - 2 : bone - 1;
}

std::vector<Frame> Recorded(const Form& form, int frames = kFrames) {
  PosedHand hand;
  std::vector<Frame> all;
  const Matrix3d mirror = Eigen::Vector3d(1, -1, 1).asDiagonal();
  for (int k = 0; k < frames; ++k) {
    std::array<Matrix3d, kTurnedBones> world = hand.RotationsAt(AnglesAt(k));
    const Matrix3d turn =
        Eigen::AngleAxisd(0.4 + form.turn_rad * k, Eigen::Vector3d(1, 2, 3).normalized())
            .toRotationMatrix();
    for (Matrix3d& bone : world) {
      if (form.is_left_hand) bone = mirror * bone * mirror;
      bone = turn * bone * form.axes.of_body;
    }
    Frame& frame = all.emplace_back();
    for (int bone = 0; bone < kTurnedBones; ++bone) {
      const Matrix3d& own = world[static_cast<std::size_t>(bone)];
      const Matrix3d parent =
          bone == 0 ? Matrix3d(turn) : world[static_cast<std::size_t>(ParentOf(bone))];
      Quaterniond q(form.is_local ? Matrix3d(parent.transpose() * own) : own);
      if (k % 3 == 1) q.coeffs() *= -1.0;  // the same rotation
      const double side = form.axes.is_left_handed ? -1.0 : 1.0;
      const std::array<double, 4> wxyz = {q.w(), side * q.x(), side * q.y(), q.z()};
      for (std::size_t i = 0; i < 4; ++i) {
        frame[static_cast<std::size_t>(bone)][i] = wxyz[static_cast<std::size_t>(form.order[i])];
      }
    }
  }
  return all;
}

/// A name of each bone that a file has, and which it is.
using Names = std::vector<std::pair<std::string, int>>;

Names OpenXrNames() {
  Names names = {{"palm", 0}, {"wrist", 0}};
  for (int digit = 0; digit < kDigitsOfHand; ++digit) {
    const std::string name = kDigits[static_cast<std::size_t>(digit)];
    names.emplace_back(name + "_metacarpal", TurnedBone(digit, 0));
    names.emplace_back(name + "_proximal", TurnedBone(digit, 1));
    if (digit > 0) names.emplace_back(name + "_intermediate", TurnedBone(digit, 2));
    names.emplace_back(name + "_distal", TurnedBone(digit, 3));
    names.emplace_back(name + "_tip", TurnedBone(digit, 3));
  }
  return names;
}

Names ManusNames() {
  Names names = {{"Hand", 0}};
  for (int digit = 0; digit < kDigitsOfHand; ++digit) {
    std::string name = kDigits[static_cast<std::size_t>(digit)];
    name[0] = static_cast<char>(std::toupper(name[0]));
    names.emplace_back(name + "_MCP", TurnedBone(digit, 0));
    names.emplace_back(name + "_PIP", TurnedBone(digit, 1));
    if (digit > 0) names.emplace_back(name + "_IP", TurnedBone(digit, 2));
    names.emplace_back(name + "_DIP", TurnedBone(digit, 3));
    names.emplace_back(name + "_TIP", TurnedBone(digit, 3));
  }
  return names;
}

/// A column per component, with what stands behind the name of the bone.
std::string CsvOf(const std::vector<Frame>& frames, const Names& names,
                  const std::array<const char*, 4>& ends) {
  std::string text = "time_s";
  for (const auto& [name, bone] : names) {
    for (const char* end : ends) text += fmt::format(",{}{}", name, end);
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    text += fmt::format("\n{:.2f}", 0.02 * static_cast<double>(k));
    for (const auto& [name, bone] : names) {
      for (const double value : frames[k][static_cast<std::size_t>(bone)]) {
        text += fmt::format(",{:.6f}", value);
      }
    }
  }
  return text + "\n";
}

constexpr std::array<const char*, 4> kWFirst = {"_qw", "_qx", "_qy", "_qz"};
constexpr std::array<const char*, 4> kLocal = {"_local_qw", "_local_qx", "_local_qy", "_local_qz"};
constexpr std::array<const char*, 4> kWorld = {"_world_qw", "_world_qx", "_world_qy", "_world_qz"};

class RotationFiles : public ::testing::Test {
 protected:
  fs::path Written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
    return folder_.path() / name;
  }
  /// What a file is read as.
  std::string Read(const std::string& text, const std::string& name = "hand.csv") const {
    return test::TextOf(TableSource(Written(name, text)));
  }
  std::string ProblemOf(const std::string& text) const {
    try {
      Read(text);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryDirectory folder_;
};

std::map<std::string, std::vector<double>> ColumnsOf(const std::string& text) {
  std::map<std::string, std::vector<double>> columns;
  std::vector<std::string> names;
  for (const std::string_view line : SplitLines(text)) {
    if (line.starts_with('#')) continue;
    const auto cells = SplitCells(line);
    if (names.empty()) {
      names.assign(cells.begin(), cells.end());
      continue;
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      columns[names.at(c)].push_back(controller::ParseNumber(cells[c]).value_or(controller::kNaN));
    }
  }
  return columns;
}

const std::vector<std::string> kOfAnyAxes = {
    "thumb_mcp",  "thumb_ip", "index_mcp", "index_pip", "index_dip",  "middle_mcp", "middle_pip",
    "middle_dip", "ring_mcp", "ring_pip",  "ring_dip",  "little_mcp", "little_pip", "little_dip"};
const std::vector<std::string> kOfKnownAxes = {"thumb_rotation", "thumb_abduction",
                                               "finger_spread"};

/// The angles that the hand was posed by, and no others.
void ExpectAngles(const std::string& text, bool has_known_axes, const std::string& before = "") {
  const auto columns = ColumnsOf(text);
  std::vector<std::string> channels = kOfAnyAxes;
  if (has_known_axes) channels.insert(channels.end(), kOfKnownAxes.begin(), kOfKnownAxes.end());
  const std::size_t hands = before.empty() ? 1 : 2;
  EXPECT_EQ(columns.size(), hands * channels.size() + 1) << text.substr(0, 900);
  for (const std::string& channel : channels) {
    const auto column = columns.find(before + channel + "_deg");
    ASSERT_NE(column, columns.end()) << before << channel << text.substr(0, 900);
    ASSERT_EQ(std::ssize(column->second), kFrames);
    for (int k = 0; k < kFrames; ++k) {
      ASSERT_NEAR(column->second[static_cast<std::size_t>(k)], AnglesAt(k).at(channel), 0.5)
          << channel << " " << k;
    }
  }
}

TEST_F(RotationFiles, GiveTheAnglesThatTheHandWasPosedBy) {
  const std::string openxr = Read(CsvOf(Recorded({}), OpenXrNames(), kWFirst));
  ExpectAngles(openxr, true);
  EXPECT_THAT(openxr,
              HasSubstr("relative to the world (as OpenXR has them); 0 % of the frames lost"));
  EXPECT_THAT(openxr, HasSubstr("fingers bend about (-1.00, "));
  // Left-handed axes as in Unity: z to the tip.
  Axes unity = OpenXrAxes();
  unity.is_left_handed = true;
  const std::string of_unity =
      Read(CsvOf(Recorded({.axes = unity, .is_local = true}), OpenXrNames(), kLocal));
  ExpectAngles(of_unity, true);
  EXPECT_THAT(of_unity, HasSubstr("relative to the bone before (by the names)"));
  EXPECT_THAT(of_unity, HasSubstr("fingers bend about (1.00, "));
  // x along the bone, z up: as Manus writes with such axes. What is along the bone is not known.
  ExpectAngles(Read(CsvOf(Recorded({.axes = {}, .is_local = true}), ManusNames(), kLocal)), false);
  ExpectAngles(Read(CsvOf(Recorded({.axes = {}}), ManusNames(), kWorld)), false);
}

TEST_F(RotationFiles, AreReadInEveryOrderOfNamedComponents) {
  constexpr std::array<int, 4> kWLast = {1, 2, 3, 0};
  const std::array<const char*, 4> named_last = {".orientation.x", ".orientation.y",
                                                 ".orientation.z", ".orientation.w"};
  ExpectAngles(Read(CsvOf(Recorded({.order = kWLast}), OpenXrNames(), named_last)), true);
  ExpectAngles(Read(CsvOf(Recorded({.order = kWLast}), OpenXrNames(), {"_x", "_y", "_z", "_w"})),
               true);
}

TEST_F(RotationFiles, OfARowPerJointAreRead) {
  std::string rows = "time_s,joint,qx,qy,qz,qw\n";
  const std::vector<Frame> frames = Recorded({});
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (const auto& [name, bone] : OpenXrNames()) {
      const auto& q = frames[k][static_cast<std::size_t>(bone)];
      rows += fmt::format("{:.2f},{},{},{},{},{}\n", 0.02 * static_cast<double>(k), name, q[1],
                          q[2], q[3], q[0]);
    }
  }
  ExpectAngles(Read(rows), true);
}

TEST_F(RotationFiles, OfBothHandsAndOfJsonAreRead) {
  const std::vector<Frame> right = Recorded({}), left = Recorded({.is_left_hand = true});
  std::string wide;
  for (std::size_t k = 0; k < right.size(); ++k) {
    std::string hands;
    for (const bool is_left : {false, true}) {
      std::string bones;
      for (const auto& [name, bone] : OpenXrNames()) {
        const auto& q = (is_left ? left : right)[k][static_cast<std::size_t>(bone)];
        bones += fmt::format(R"({}"{}": {{"rotation": {{"w": {}, "x": {}, "y": {}, "z": {}}}}})",
                             bones.empty() ? "" : ", ", name, q[0], q[1], q[2], q[3]);
      }
      hands += fmt::format(R"(, "{}": {{{}}})", is_left ? "leftHand" : "rightHand", bones);
    }
    wide += fmt::format("{{\"timestamp\": {}{}}}\n", 0.02 * static_cast<double>(k), hands);
  }
  const std::string both = Read(wide, "both.jsonl");
  ExpectAngles(both, true, "left_");
  ExpectAngles(both, true, "right_");
}

TEST_F(RotationFiles, AskWhereTheyCannotBeTold) {
  // Angles relative to the bone before of 0.25 rad per bone, or three bones of as much in the
  // world.
  std::vector<Frame> still;
  for (int k = 0; k < kFrames; ++k) {
    Frame& frame = still.emplace_back();
    for (int bone = 0; bone < kTurnedBones; ++bone) {
      const int place = bone == 0 ? 0 : (bone - 1) % kBonesOfDigit;
      const double half = -0.5 * 0.25 * place * (1.0 + std::sin(0.1 * k));
      frame[static_cast<std::size_t>(bone)] = {std::cos(half), std::sin(half), 0.0, 0.0};
    }
  }
  const auto of = [&](const std::array<const char*, 4>& ends) {
    const auto columns = ColumnsOf(Read(CsvOf(still, OpenXrNames(), ends)));
    return columns.at("index_dip_deg")[5] * kRadPerDeg / (1.0 + std::sin(0.5));
  };
  EXPECT_NEAR(of(kLocal), 0.75, 1e-3);
  EXPECT_NEAR(of(kWorld), 0.25, 1e-3);
  // Names that do not say what rotations are relative to, and names that say the wrong thing.
  EXPECT_THAT(ProblemOf(CsvOf(Recorded({}), ManusNames(), kWFirst)),
              HasSubstr("hand.csv: has rotations of bones, relative to the bone before or to the "
                        "world; write local or world into the names of the columns"));
  EXPECT_THAT(ProblemOf(CsvOf(Recorded({.is_local = true}), OpenXrNames(), kWFirst)),
              HasSubstr("or not relative to the world; write local or world"));
  EXPECT_THAT(ProblemOf(CsvOf(Recorded({}), OpenXrNames(), kLocal)),
              HasSubstr("or not relative to the bone before; write local or world"));
  // A flat hand that only turns.
  std::vector<Frame> flat = Recorded({});
  for (Frame& frame : flat) frame.fill(frame[0]);
  EXPECT_THAT(ProblemOf(CsvOf(flat, OpenXrNames(), kWFirst)),
              HasSubstr("the fingers hardly bend, so the direction of flexion is unknown"));
  // Of other bones than the names say.
  std::vector<Frame> shuffled = Recorded({});
  for (Frame& frame : shuffled) {
    const Frame own = frame;
    for (std::size_t bone = 0; bone < own.size(); ++bone) frame[bone] = own[bone * 8 % own.size()];
  }
  EXPECT_THAT(ProblemOf(CsvOf(shuffled, OpenXrNames(), kWFirst)),
              HasSubstr("do not bend about one axis each"));
  // Without the wrist, rotations in the world have no parent.
  Names names = OpenXrNames();
  std::erase_if(names, [](const auto& name) { return name.second == 0; });
  EXPECT_NE(ProblemOf(CsvOf(Recorded({}), names, kWFirst)), "");
  ExpectAngles(Read(CsvOf(Recorded({.is_local = true}), names, kLocal)), true);
}

TEST_F(RotationFiles, LeaveOutLostFramesAndLeaveOtherTablesAlone) {
  std::vector<Frame> frames = Recorded({});
  frames[10].fill({0.0, 0.0, 0.0, 0.0});
  for (std::size_t k = 31; k < 40; ++k) frames[k] = frames[30];
  const std::string read = Read(CsvOf(frames, OpenXrNames(), kWFirst));
  EXPECT_EQ(ColumnsOf(read).at("time_s").size(), static_cast<std::size_t>(kFrames) - 10U);
  EXPECT_THAT(read, HasSubstr("8.3 % of the frames lost"));
  // Numbers that are no unit quaternions.
  std::vector<Frame> others = Recorded({});
  for (Frame& frame : others) {
    for (auto& quaternion : frame) quaternion[0] += 2.0;
  }
  const std::string text = CsvOf(others, OpenXrNames(), kWFirst);
  EXPECT_EQ(Read(text), text);
  // One motion sensor per finger.
  Names sensors;
  for (int digit = 0; digit < kDigitsOfHand; ++digit) {
    for (int i = 0; i < 4; ++i)
      sensors.emplace_back(fmt::format("{}_{}", kDigits[static_cast<std::size_t>(digit)], i), 5);
  }
  const std::string motion = CsvOf(Recorded({}), sensors, kWFirst);
  EXPECT_EQ(Read(motion), motion);
}

}  // namespace
}  // namespace gauntlet::sim::testing
