// BVH files as motion capture and animation write them, of a hand of our own, which the physics
// engine places.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/error.h"
#include "sim/recordings/keypoints/bone_names.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/file_format.h"
#include "sim/tables/text_lines.h"
#include "tests/recordings/posed_hand.h"
#include "tests/support/program.h"
#include "tests/support/table_text.h"

namespace gauntlet::sim::testing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kRows = 100;
constexpr std::array<const char*, 5> kDigit = {"Thumb", "Index", "Middle", "Ring", "Pinky"};
constexpr std::array<const char*, 4> kBone = {"Metacarpal", "Proximal", "Medial", "Distal"};

const char* DigitName(int digit) { return kDigit[static_cast<std::size_t>(digit)]; }
const char* BoneWord(int bone) { return kBone[static_cast<std::size_t>(bone)]; }
const char* Side(bool is_left) { return is_left ? "Left" : "Right"; }
/// 1, 2, 3 from the hand to the tip, 0 for the metacarpal of a finger.
int NumberOf(int digit, int bone) { return digit == 0 ? (bone == 3 ? 3 : bone + 1) : bone; }

/// How a program writes.
struct Maker {
  std::string order = "ZXY";  // of rotations
  /// Of the bone, or of the end (bone 4); empty: it has no joint.
  std::function<std::string(bool is_left, int digit, int bone)> name;
  Matrix3d axes = Matrix3d::Identity();  // of all joints, by those of the hand: x to the tip
  bool has_positions = false;            // on every joint
  bool has_left = true;
  std::string line_end = "\n";
  std::string before_brace = "\n";
  std::string blank = " ";
};

Matrix3d QuarterTurn(const Vector3d& axis) {
  return Eigen::AngleAxisd(std::numbers::pi / 2, axis).toRotationMatrix();
}

std::string MixamoName(bool is_left, int digit, int bone) {
  if (digit > 0 && bone == 0) return "";
  return fmt::format("mixamorig:{}Hand{}{}", Side(is_left), DigitName(digit),
                     bone == 4 ? 4 : NumberOf(digit, bone));
}

std::map<std::string, Maker> Makers() {
  std::map<std::string, Maker> makers;
  makers["Mixamo"] = {.order = "ZXY", .name = MixamoName};
  makers["Perception Neuron"] = {
      .order = "YXZ",
      .name = [](bool is_left, int digit, int bone) -> std::string {
        if (bone == 4) return "";
        if (digit > 0 && bone == 0)
          return fmt::format("{}InHand{}", Side(is_left), DigitName(digit));
        return fmt::format("{}Hand{}{}", Side(is_left), DigitName(digit), NumberOf(digit, bone));
      },
      .axes = QuarterTurn(Vector3d::UnitZ()),
      .has_positions = true,
      .line_end = "\r\n"};
  makers["Rokoko"] = {.order = "XYZ",
                      .name = [](bool is_left, int digit, int bone) -> std::string {
                        if (bone == 4)
                          return fmt::format("{}Finger{}Tip", Side(is_left), digit + 1);
                        return fmt::format("{}Finger{}{}", Side(is_left), digit + 1,
                                           BoneWord(bone));
                      },
                      .axes = QuarterTurn(Vector3d::UnitY()),
                      .blank = "\t"};
  makers["Rokoko with a thumb named as a finger"] = {
      .order = "ZYX", .name = [](bool is_left, int digit, int bone) -> std::string {
        if (bone == 4 || (digit > 0 && bone == 0)) return "";
        const bool is_thumb_before_end = digit == 0 && bone < 2;
        return fmt::format("{}{}{}", Side(is_left), DigitName(digit),
                           BoneWord(is_thumb_before_end ? bone + 1 : bone));
      }};
  makers["Blender"] = {
      .order = "XYZ",
      .name = [](bool is_left, int digit, int bone) -> std::string {
        if (bone == 4 || (digit > 0 && bone == 0)) return "";
        constexpr std::array<const char*, 5> kNames = {"thumb", "f_index", "f_middle", "f_ring",
                                                       "f_pinky"};
        return fmt::format("DEF-{}.{:02}.{}", kNames[static_cast<std::size_t>(digit)],
                           NumberOf(digit, bone), is_left ? 'L' : 'R');
      },
      // Bones along (-1, -1, -1), turned to x. Quaternion::FromTwoVectors() takes seconds to
      // compile.
      .axes =
          Eigen::AngleAxisd(std::acos(-1.0 / std::sqrt(3.0)), Vector3d(0.0, -1.0, 1.0).normalized())
              .toRotationMatrix(),
      .before_brace = " "};
  makers["Unreal"] = {
      .order = "YZX", .name = [](bool is_left, int digit, int bone) -> std::string {
        if (bone == 4) return "";
        constexpr std::array<const char*, 5> kNames = {"thumb", "index", "middle", "ring", "pinky"};
        const char* name = kNames[static_cast<std::size_t>(digit)];
        const char side = is_left ? 'l' : 'r';
        if (digit > 0 && bone == 0) return fmt::format("{}_metacarpal_{}", name, side);
        return fmt::format("{}_{:02}_{}", name, NumberOf(digit, bone), side);
      }};
  makers["Xsens"] = {.order = "XZY", .name = [](bool is_left, int digit, int bone) -> std::string {
                       if (bone == 4) return "";
                       constexpr std::array<const char*, 5> kNames = {"First", "Second", "Third",
                                                                      "Fourth", "Fifth"};
                       constexpr std::array<const char*, 4> kEnds = {"MC", "PP", "MP", "DP"};
                       return fmt::format("{}{}{}", Side(is_left),
                                          kNames[static_cast<std::size_t>(digit)],
                                          kEnds[static_cast<std::size_t>(bone)]);
                     }};
  makers["digits by number"] = {.order = "ZXY",
                                .name = [](bool is_left, int digit, int bone) -> std::string {
                                  if (bone == 4) return "";
                                  constexpr std::array<const char*, 4> kNames = {
                                      "Metacarpal", "ProximalPhalanx", "MiddlePhalanx",
                                      "DistalPhalanx"};
                                  return fmt::format("{}Digit{}{}", Side(is_left), digit + 1,
                                                     kNames[static_cast<std::size_t>(bone)]);
                                },
                                .has_left = false};
  return makers;
}

/// Angles [deg] of the rotations in the order of the axes: R = R(first) R(second) R(third).
std::array<double, 3> EulerDeg(const Matrix3d& r, const std::string& order) {
  const int i = order[0] - 'X', j = order[1] - 'X', k = order[2] - 'X';
  const double sign = (j - i + 3) % 3 == 1 ? 1.0 : -1.0;
  return {kDegPerRad * std::atan2(-sign * r(j, k), r(k, k)),
          kDegPerRad * std::asin(std::clamp(sign * r(i, k), -1.0, 1.0)),
          kDegPerRad * std::atan2(-sign * r(i, j), r(i, i))};
}

using Poses = std::vector<Matrix3d>;  // of a joint by row

/// Writes joint by joint.
class BvhWriter {
 public:
  explicit BvhWriter(const Maker& maker) : maker_(maker) {}

  void Open(const std::string& name, const Vector3d& offset, const Poses& poses,
            bool has_position = false) {
    has_position = has_position || maker_.has_positions;
    Line(fmt::format("{} {}{}{{", depth_ == 0 ? "ROOT" : "JOINT", name, Brace()));
    ++depth_;
    Offset(offset);
    std::string channels = fmt::format("CHANNELS {}", has_position ? 6 : 3);
    if (has_position) channels += " Xposition Yposition Zposition";
    for (const char axis : maker_.order) channels += fmt::format(" {}rotation", axis);
    Line(channels);
    for (int k = 0; k < kRows; ++k) {
      std::string& row = rows_[static_cast<std::size_t>(k)];
      if (has_position) row += fmt::format("{:.3f} 90.1 {} ", 0.1 * k, -1e-3 * k);
      for (const double angle : EulerDeg(poses[static_cast<std::size_t>(k)], maker_.order)) {
        row += fmt::format("{:.6f}{}", angle, maker_.blank);
      }
    }
  }
  void End(const Vector3d& offset) {
    Line("End Site" + Brace() + "{");
    ++depth_;
    Offset(offset);
    Close();
  }
  void Close() {
    --depth_;
    Line("}");
  }
  std::string Text() {
    std::string text = "HIERARCHY" + maker_.line_end + text_ + "MOTION" + maker_.line_end;
    text += fmt::format("Frames: {}{}Frame Time:\t0.02{}", kRows, maker_.line_end, maker_.line_end);
    for (const std::string& row : rows_) text += row + maker_.line_end;
    return text;
  }

 private:
  std::string Brace() const {
    return maker_.before_brace == "\n" ? maker_.line_end : maker_.before_brace;
  }
  void Line(const std::string& line) {
    text_ += std::string(static_cast<std::size_t>(depth_), '\t') + line + maker_.line_end;
  }
  void Offset(const Vector3d& offset) {
    Line(fmt::format("OFFSET{}{} {} {:e}", maker_.blank, offset.x(), offset.y(), offset.z()));
  }

  const Maker& maker_;
  int depth_ = 0;
  std::string text_;
  std::vector<std::string> rows_ = std::vector<std::string>(kRows);
};

/// A body whose arms and legs move, too.
class BvhBody {
 public:
  BvhBody() {
    PosedHand hand;
    for (int k = 0; k < kRows; ++k) hands_.push_back(hand.RotationsAt(AnglesAt(k)));
  }

  std::string Text(const Maker& maker, const std::function<void(Poses&, int digit)>& change = {}) {
    BvhWriter writer(maker);
    const auto swing = [](double speed, const Vector3d& axis) {
      Poses poses;
      for (int k = 0; k < kRows; ++k) {
        poses.push_back(
            Eigen::AngleAxisd(0.4 * std::sin(speed * k), axis.normalized()).toRotationMatrix());
      }
      return poses;
    };
    writer.Open("Bip01 Hips", {0, 90, 0}, swing(0.01, {1, 2, 3}), true);
    for (const bool is_left : {true, false}) {
      writer.Open(fmt::format("{}UpLeg", Side(is_left)), {10, -5, 0}, swing(0.05, {3, 1, 0}));
      writer.Open(fmt::format("{}ToeIndex1", Side(is_left)), {0, -80, 0}, swing(0.02, {3, 1, 0}));
      writer.End({0, 0, 10});
      writer.Close();
      writer.Close();
    }
    for (const bool is_left : {true, false}) {
      if (is_left && !maker.has_left) continue;
      writer.Open(fmt::format("{}ForeArm", Side(is_left)), {20, 50, 0}, swing(0.03, {0, 1, 3}));
      writer.Open(fmt::format("{}Hand", Side(is_left)), {25, 0, 0}, swing(0.04, {2, 1, 3}));
      for (int digit = 0; digit < kDigitsOfHand; ++digit) {
        WriteDigit(maker, is_left, digit, change, writer);
      }
      writer.Close();
      writer.Close();
    }
    writer.Close();
    return writer.Text();
  }

 private:
  void WriteDigit(const Maker& maker, bool is_left, int digit,
                  const std::function<void(Poses&, int digit)>& change, BvhWriter& writer) {
    const Matrix3d mirror = Vector3d(1, -1, 1).asDiagonal();
    const Vector3d along = maker.axes.transpose() * Vector3d::UnitX();
    constexpr std::array<double, 4> kLength = {2.0, 7.0, 4.0, 2.5};
    int open = 0, parent = 0;
    Vector3d offset = 0.5 * along;
    for (int bone = 0; bone < kBonesOfDigit; ++bone) {
      if (digit == 0 && bone == 2) continue;
      const std::string name = maker.name(is_left, digit, bone);
      offset += kLength[static_cast<std::size_t>(bone)] * along;
      if (name.empty()) continue;
      Poses poses;
      for (const auto& world : hands_) {
        const Matrix3d own = world[static_cast<std::size_t>(TurnedBone(digit, bone))];
        Matrix3d local = world[static_cast<std::size_t>(parent)].transpose() * own;
        if (is_left) local = mirror * local * mirror;
        poses.push_back(maker.axes.transpose() * local * maker.axes);
      }
      if (change) change(poses, digit);
      writer.Open(name, offset, poses);
      offset.setZero();
      parent = TurnedBone(digit, bone);
      ++open;
    }
    if (const std::string end = maker.name(is_left, digit, 4); !end.empty()) {
      writer.Open(end, 2.0 * along, Poses(kRows, Matrix3d::Identity()));
      ++open;
    }
    writer.End(2.0 * along);
    for (; open > 0; --open) writer.Close();
  }

  std::vector<std::array<Matrix3d, kTurnedBones>> hands_;
};

class BvhFiles : public ::testing::Test {
 protected:
  /// What a file is read as.
  std::string Read(const std::string& text) const {
    const auto file = folder_.path() / "motion.txt";
    std::ofstream(file, std::ios::binary) << text;
    return test::TextOf(TableSource(file));
  }
  std::string ProblemOf(const std::string& text) const {
    try {
      Read(text);
    } catch (const UserError& error) {
      return std::string(error.what()).substr(folder_.path().string().size() + 1);
    }
    return "";
  }
  BvhBody body_;
  test::TemporaryDirectory folder_;
};

/// Values of a column, in the order of the rows.
std::vector<double> Column(const std::string& table, const std::string& name) {
  CsvReader reader("table", TextSource(table), ProblemHandling::kStrict);
  const auto place = std::ranges::find(reader.header(), name) - reader.header().begin();
  std::vector<double> row(reader.column_count()), values;
  while (reader.NextRow(row)) values.push_back(row.at(static_cast<std::size_t>(place)));
  return values;
}

void ExpectPosedAngles(const std::string& table, const std::string& hand) {
  const std::vector<double> times_s = Column(table, "time_s");
  ASSERT_EQ(std::ssize(times_s), kRows) << table.substr(0, 900);
  EXPECT_NEAR(times_s.back(), 0.02 * (kRows - 1), 1e-9);
  for (const auto& [channel, first] : AnglesAt(0)) {
    if (channel == "thumb_rotation" || channel == "thumb_abduction" || channel == "finger_spread") {
      EXPECT_THAT(table, Not(HasSubstr(channel + "_deg")));
      continue;
    }
    const std::vector<double> angles = Column(table, hand + channel + "_deg");
    for (int k = 0; k < kRows; ++k) {
      ASSERT_NEAR(angles[static_cast<std::size_t>(k)], AnglesAt(k).at(channel), 0.5)
          << hand << channel << " " << k;
    }
  }
}

TEST_F(BvhFiles, OfAllMakersGiveTheAnglesThatTheHandWasPosedBy) {
  for (const auto& [name, maker] : Makers()) {
    SCOPED_TRACE(name);
    const std::string table = Read(body_.Text(maker));
    if (maker.has_left) ExpectPosedAngles(table, "left_");
    ExpectPosedAngles(table, maker.has_left ? "right_" : "");
    EXPECT_THAT(table, HasSubstr("relative to the bone before (by the names); 0 % of the frames "
                                 "lost"));
    EXPECT_THAT(table, HasSubstr("right hand: 0 deg is the rest pose of the file; PIP, DIP and "
                                 "thumb are corrected by its OFFSETs, by up to 0.0 deg"));
  }
}

/// A hand whose joints have one channel each, that turns by 0.4 deg times the place of the joint
/// times the row. Its digits rest bent about x by so much at their second and third joints.
std::string OneChannelText(const std::string& channel, double sign,
                           const std::array<double, 2>& rest_deg = {0.0, 0.0},
                           const std::string& end = "") {
  constexpr int kShort = 12;
  std::string text = "hierarchy\nroot Hand\n{\noffset 0 0 0\nchannels 0\n";
  std::vector<std::string> rows(kShort);
  const auto bone = [](double angle_deg) {
    return fmt::format("0 {} {}", std::cos(angle_deg * kRadPerDeg),
                       std::sin(angle_deg * kRadPerDeg));
  };
  int place = 0;
  for (const char* digit : kDigit) {
    for (int i = 1; i <= 3; ++i) {
      text += fmt::format("joint {}{} {{ offset {} channels 1 {}\n", digit, i,
                          bone(i == 3 ? rest_deg[0] : 0.0), channel);
      ++place;
      for (int k = 0; k < kShort; ++k) {
        rows[static_cast<std::size_t>(k)] += fmt::format(" {}", sign * 0.4 * place * k);
      }
    }
    text += fmt::format("end site {{ offset {} }} }} }} }}\n",
                        end.empty() ? bone(rest_deg[0] + rest_deg[1]) : end);
  }
  text += fmt::format("}} motion\nframes: {}\nframe time: 0.01\n", kShort);
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

/// Each joint has the angle of its channel and that of the rest pose.
void ExpectChannels(const std::string& table, double sign = 1.0,
                    const std::array<double, 2>& rest_deg = {0.0, 0.0}) {
  const std::array<const char*, 14> kInOrder = {
      "thumb_mcp",  "thumb_ip", "index_mcp", "index_pip", "index_dip",  "middle_mcp", "middle_pip",
      "middle_dip", "ring_mcp", "ring_pip",  "ring_dip",  "little_mcp", "little_pip", "little_dip"};
  for (int joint = 0; joint < std::ssize(kInOrder); ++joint) {
    const int place = joint + 2;  // the thumb's metacarpal has no angle
    const double rest = place % 3 == 1 ? 0.0 : rest_deg[place % 3 == 2 ? 0 : 1];
    const std::vector<double> angles =
        Column(table, std::string(kInOrder[static_cast<std::size_t>(joint)]) + "_deg");
    ASSERT_EQ(angles.size(), 12U) << table;
    for (int k = 0; k < 12; ++k) {
      EXPECT_NEAR(angles[static_cast<std::size_t>(k)], rest + sign * 0.4 * place * k, 1e-3)
          << kInOrder[static_cast<std::size_t>(joint)] << " " << k;
    }
  }
}

TEST_F(BvhFiles, WithOneChannelGiveIt) {
  for (const char* channel : {"Xrotation", "YROTATION", "zrotation"}) {
    for (const double sign : {1.0, -1.0}) ExpectChannels(Read(OneChannelText(channel, sign)));
  }
}

TEST_F(BvhFiles, WhoseRestPoseIsBentAreCorrected) {
  const std::array<double, 2> kRest = {50.0, 40.0};
  // Fingers that rest bent and only open: flexion is the other direction.
  const std::string opened = Read(OneChannelText("Xrotation", -1.0, kRest));
  ExpectChannels(opened, -1.0, kRest);
  EXPECT_THAT(opened, HasSubstr("hand: 0 deg is the rest pose of the file; PIP, DIP and thumb are "
                                "corrected by its OFFSETs, by up to 50.0 deg"));
  ExpectChannels(Read(OneChannelText("Xrotation", 1.0, {20.0, 10.0})), 1.0, {20.0, 10.0});
  // The end is beside the finger, or where the joint is. -0 has a direction for atan2().
  for (const char* end : {"1 0 0", "0 0 0", "-0 -0 -0", "0 -0 0"}) {
    ExpectChannels(Read(OneChannelText("Xrotation", 1.0, {20.0, 0.0}, end)), 1.0, {20.0, 0.0});
  }
}

TEST_F(BvhFiles, OfAHandThatDoesNothingLeaveItOut) {
  const Maker mixamo = Makers().at("Mixamo");
  int joint = 0;
  const std::string right = Read(body_.Text(mixamo, [&joint](Poses& poses, int /*digit*/) {
    constexpr int kOfLeft = 15;
    if (joint++ < kOfLeft) poses.assign(kRows, poses.front());
  }));
  EXPECT_THAT(right, HasSubstr("# left out: left hand: it never moves"));
  ExpectPosedAngles(right, "");
  // A hand that only jitters has no direction of flexion.
  joint = 0;
  const std::string also_right = Read(body_.Text(mixamo, [&joint](Poses& poses, int /*digit*/) {
    constexpr int kOfLeft = 15;
    if (joint++ >= kOfLeft) return;
    for (int k = 0; k < kRows; ++k) {
      poses[static_cast<std::size_t>(k)] =
          Eigen::AngleAxisd(0.01 * std::sin(k), Vector3d::UnitY()).toRotationMatrix();
    }
  }));
  EXPECT_THAT(also_right, HasSubstr("# left out: left hand: the fingers hardly bend"));
  ExpectPosedAngles(also_right, "right_");
  EXPECT_THAT(also_right, Not(HasSubstr("left_index")));
  // Neither does, or one finger does not.
  EXPECT_EQ(ProblemOf(body_.Text(
                mixamo, [](Poses& poses, int /*digit*/) { poses.assign(kRows, poses.front()); })),
            "motion.txt: has no hand that can be read; left hand: it never moves; right hand: it "
            "never moves");
  EXPECT_EQ(ProblemOf(body_.Text(mixamo,
                                 [](Poses& poses, int digit) {
                                   if (digit == 3) poses.assign(kRows, Matrix3d::Identity());
                                 })),
            "motion.txt: the fingers hardly bend, so the direction of flexion is unknown; record a "
            "fist, too");
}

TEST_F(BvhFiles, AskWhereTheNamesMayMeanOtherJoints) {
  Maker maker = Makers().at("Mixamo");
  maker.has_left = false;
  const auto problem_with = [&](const std::function<std::string(int digit, int bone)>& name) {
    maker.name = [&](bool, int digit, int bone) { return name(digit, bone); };
    return ProblemOf(body_.Text(maker));
  };
  const std::string right = "motion.txt: has no hand that can be read; right hand: ";
  // Numbers from the metacarpal on: the fourth joint moves, or is none.
  const auto from_metacarpal = [](int digit, int bone) -> std::string {
    if (bone == 4) return "";
    return fmt::format("RightHand{}{}", DigitName(digit), digit == 0 && bone == 3 ? 3 : bone + 1);
  };
  EXPECT_THAT(problem_with(from_metacarpal),
              HasSubstr(right + "RightHandIndex4 moves, but is the end of a digit by its name; 1, "
                                "2, 3 must be the proximal"));
  maker.name = [&](bool, int digit, int bone) { return from_metacarpal(digit, bone); };
  EXPECT_THAT(ProblemOf(body_.Text(maker,
                                   [bone = 0](Poses& poses, int digit) mutable {
                                     bone = digit > 0 ? bone % 4 + 1 : 0;
                                     if (bone == 4) poses.assign(kRows, Matrix3d::Identity());
                                   })),
              HasSubstr(right + "RightHandIndex1 is a metacarpal by its OFFSETs; 1, 2, 3 must be"));
  EXPECT_THAT(problem_with([](int digit, int bone) -> std::string {
                if (bone == 4 || (digit > 0 && bone == 0)) return "";
                return fmt::format("b_r_{}{}", DigitName(digit), NumberOf(digit, bone) - 1);
              }),
              HasSubstr(right + "b_r_Thumb0 may be any bone; 1, 2, 3 must be"));
  EXPECT_EQ(problem_with([](int digit, int bone) {
              return digit == 3 && bone == 2 ? "" : MixamoName(false, digit, bone);
            }),
            right + "ring_middle is missing");
  EXPECT_EQ(problem_with([](int digit, int bone) {
              return MixamoName(false, digit == 2 ? 1 : digit, bone);
            }),
            right +
                "several joints are index_proximal: mixamorig:RightHandIndex1, "
                "mixamorig:RightHandIndex1");
  EXPECT_EQ(problem_with([](int digit, int bone) {  // 2 before 1
              return MixamoName(
                  false, digit,
                  digit == 0 ? bone : std::array{0, 2, 1, 3, 4}[static_cast<std::size_t>(bone)]);
            }),
            right + "mixamorig:RightHandIndex2 must be the child of mixamorig:RightHandIndex1");
  EXPECT_EQ(problem_with([](int digit, int bone) { return fmt::format("Bone{}{}", digit, bone); }),
            "motion.txt: has no joints of fingers, as RightHandIndex1, RightIndexProximal or "
            "index.01.R; export the skeleton with its fingers");
}

TEST_F(BvhFiles, ThatAreDamagedNameTheLine) {
  const std::string good = OneChannelText("Xrotation", 1.0);
  const auto with = [&](const std::string& old_text, const std::string& new_text) {
    std::string text = good;
    const std::size_t place = text.find(old_text);
    EXPECT_NE(place, std::string::npos) << old_text;
    return ProblemOf(text.replace(place, old_text.size(), new_text));
  };
  EXPECT_EQ(with("offset 0 1 0 ", "offset 0 1 "), "motion.txt:6: 'channels' must be a number");
  EXPECT_EQ(with("channels 0", "channels 7"), "motion.txt:5: CHANNELS '7' must be 0 to 6");
  EXPECT_EQ(with("Xrotation", "Wrotation"),
            "motion.txt:6: channel 'Wrotation' must be Xposition .. Zposition or Xrotation .. "
            "Zrotation");
  EXPECT_EQ(with("root Hand\n{", "root Hand\n"), "motion.txt:4: 'offset' must be '{'");
  EXPECT_EQ(with("} } } }", "} } } } }"), "motion.txt:26: '}' must be ROOT or MOTION");
  EXPECT_EQ(with("} } } }", "} } }"),
            "motion.txt:26: 'motion' must be OFFSET, CHANNELS, JOINT, End Site or '}'");
  EXPECT_EQ(with("frames: 12", "frames 12"),
            "motion.txt:27: 'frames 12' must be 'Frames:' and a number");
  EXPECT_EQ(with("frame time: 0.01", "frame time: 0"),
            "motion.txt:28: Frame Time is 0 s, must be above 0 and at most 10");
  EXPECT_EQ(with(" 0.4 ", " 0,4 "), "motion.txt:30: value 1 is '0,4', must be a number");
  EXPECT_EQ(with(" 0.4 ", " "),
            "motion.txt:30: 14 values must be 15, one for each of the CHANNELS");
}

TEST_F(BvhFiles, WithOtherRowsThanFramesAreReadAsFarAsTheyAreWhole) {
  const std::string good = OneChannelText("Xrotation", 1.0);
  const auto rows = [&](std::string text) { return Column(text, "index_mcp_deg").size(); };
  const auto with_frames = [&](const std::string& frames) {
    std::string text = good;
    return text.replace(text.find("frames: 12"), 10, "frames: " + frames);
  };
  EXPECT_THAT(Read(good), Not(HasSubstr("whole rows")));
  const std::string fewer = Read(with_frames("20"));
  EXPECT_EQ(rows(fewer), 12U);
  EXPECT_THAT(fewer, HasSubstr("Frames is 20, but the file has 12 whole rows, which are read"));
  EXPECT_EQ(rows(Read(with_frames("4"))), 12U);
  // The end of a number may be missing where rows are, and else is not.
  const std::string cut = good.substr(0, good.size() - 2);
  EXPECT_EQ(rows(Read(cut)), 12U);
  const std::string cut_before = cut.substr(0, cut.rfind('\n'));
  EXPECT_EQ(rows(Read(cut_before)), 10U);
  EXPECT_EQ(rows(Read(cut_before + "\n")), 11U);
  EXPECT_EQ(rows(Read(cut_before + "\n 1.0 -")), 11U);
}

TEST_F(BvhFiles, ThatEndAnywhereAreReadOrRefusedInOneLine) {
  const std::string good = OneChannelText("Xrotation", 1.0);
  ASSERT_EQ(FormatOfBytes(good), FileFormat::kBvh);
  for (std::size_t size = 12; size < good.size(); size += 5) {
    const std::string cut = good.substr(0, size);
    ASSERT_EQ(FormatOfBytes(cut), FileFormat::kBvh);
    const bool is_whole = size > good.size() * 4 / 5;
    const std::string problem = ProblemOf(cut);
    EXPECT_EQ(problem.find('\n'), std::string::npos) << problem;
    if (size < good.find("motion\n")) {
      EXPECT_THAT(problem, HasSubstr("motion.txt:")) << size;
    }
    if (is_whole) {
      EXPECT_EQ(problem, "") << size;
    }
  }
}

TEST(DigitJoints, AreFoundByTheirNames) {
  const auto found = [](const std::string& name) -> std::string {
    const auto joint = DigitJointOf(name);
    if (!joint) return "none";
    const std::string hand = joint->hand.empty() ? "" : joint->hand + " ";
    if (joint->bone == DigitJoint::kUnclear) return hand + "unclear";
    return hand + BoneName(joint->digit, joint->bone);
  };
  EXPECT_EQ(found("mixamorig1:LeftHandPinky3"), "left little_distal");
  EXPECT_EQ(found("RightHandThumb1"), "right thumb_metacarpal");
  EXPECT_EQ(found("RightHandThumb3"), "right thumb_distal");
  EXPECT_EQ(found("RightHandThumb4"), "right thumb_end");
  EXPECT_EQ(found("RightInHandMiddle"), "right middle_metacarpal");
  EXPECT_EQ(found("rMid1"), "right middle_proximal");
  EXPECT_EQ(found("finger_index_02_r"), "right index_middle");
  EXPECT_EQ(found("finger2-1.L"), "left index_proximal");
  EXPECT_EQ(found("RightMiddleMiddle"), "right middle_middle");
  EXPECT_EQ(found("RightDigit5DistalPhalanx"), "right little_distal");
  EXPECT_EQ(found("LeftFourthMP"), "left ring_middle");
  EXPECT_EQ(found("RightHandIndex4_end"), "right index_end");
  EXPECT_EQ(found("Index_Distal"), "index_distal");
  EXPECT_EQ(found("index_00_r"), "right unclear");
  EXPECT_EQ(found("THUMB_CMC"), "thumb_metacarpal");
  EXPECT_EQ(found("THUMB_IP"), "thumb_distal");
  EXPECT_EQ(found("INDEX_PIP"), "index_middle");
  EXPECT_EQ(found("Index_IP"), "unclear");
  for (const char* other :
       {"RightForeArm", "LeftToeRing1", "RightHand", "Spine1", "RightFootIndex1", "LThumb",
        "LeftHandIndexRight1", "index.01.R.001", "IndexTwist1", "Finger", "Bip01 R Finger11", ""}) {
    EXPECT_EQ(found(other), "none") << other;
  }
}

}  // namespace
}  // namespace gauntlet::sim::testing
