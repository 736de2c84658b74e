#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/signal.h"
#include "sim/base/text.h"
#include "sim/recordings/keypoints/bone_names.h"
#include "sim/recordings/keypoints/keypoint_layout.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/tables/missing.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr std::string_view kBlanks = " \t\r\n";

// --- The file ------------------------------------------------------------------------------------

/// Words and lines of the text. Empty ones are its end.
class BvhText {
 public:
  BvhText(std::string name, std::string_view text) : name_(std::move(name)), text_(text) {}

  /// The next word. A brace is a word.
  std::string_view Word() {
    SkipBlanks();
    const std::size_t begin = place_;
    place_ = std::min(text_.find_first_of(" \t\r\n{}", begin), text_.size());
    if (place_ == begin && !ended()) ++place_;
    return text_.substr(begin, place_ - begin);
  }
  /// The rest of the line, up to a brace.
  std::string_view Rest() { return Take("\r\n{}"); }
  /// The next line that is not empty.
  std::string_view Line() {
    SkipBlanks();
    return Take("\r\n");
  }
  double Number() {
    const std::string_view word = Word();
    const auto number = controller::ParseNumber(word);
    if (!number) Fail(fmt::format("'{}' must be a number", Shown(word)));
    return *number;
  }
  void Expect(std::string_view wanted) {
    const std::string_view word = Word();
    if (word != wanted && BareName(word) != wanted)
      Fail(fmt::format("'{}' must be '{}'", Shown(word), wanted));
  }
  /// The number of a line `key: number`.
  double Field(std::string_view key) {
    const std::string_view line = Line();
    const std::size_t colon = std::min(line.find(':'), line.size());
    const bool is_key = BareName(line.substr(0, colon)) == BareName(key);
    const auto number =
        controller::ParseNumber(Trimmed(line.substr(std::min(colon + 1, line.size()))));
    if (!is_key || !number) {
      Fail(fmt::format("'{}' must be '{}:' and a number", Shown(line), key));
    }
    return *number;
  }
  /// True if only blanks are left.
  bool ended() const { return text_.find_first_not_of(kBlanks, place_) == std::string_view::npos; }
  bool has_last_line_end() const { return text_.ends_with('\n') || text_.ends_with('\r'); }

  [[noreturn]] void Fail(const std::string& problem) const {
    throw UserError({.place = fmt::format("{}:{}", name_, line_), .problem = problem});
  }

 private:
  void SkipBlanks() {
    const std::size_t begin = place_;
    place_ = std::min(text_.find_first_not_of(kBlanks, begin), text_.size());
    line_ += std::ranges::count(text_.substr(begin, place_ - begin), '\n');
  }
  std::string_view Take(std::string_view ends) {
    const std::size_t begin = place_;
    place_ = std::min(text_.find_first_of(ends, begin), text_.size());
    return Trimmed(text_.substr(begin, place_ - begin));
  }

  std::string name_;
  std::string_view text_;
  std::size_t place_ = 0;
  std::ptrdiff_t line_ = 1;
};

struct BvhJoint {
  std::string name = {};  // empty: the end of a chain
  int parent = -1;
  Vector3d offset = Vector3d::Zero();
  std::vector<int> channels = {};  // 0 to 2: position, 3 to 5: rotation about x, y, z
  std::size_t first_channel = 0;   // among those of all joints
};

struct Bvh {
  std::vector<BvhJoint> joints;
  std::size_t channels = 0;
  double frame_time_s = 0.0;
  std::vector<std::vector<double>> frames;  // values of all channels
  std::vector<std::string> remarks;
};

void ReadChannels(BvhText& text, BvhJoint& joint, std::size_t& channels) {
  constexpr int kMost = 6;
  constexpr std::array<std::string_view, kMost> kNames = {"xposition", "yposition", "zposition",
                                                          "xrotation", "yrotation", "zrotation"};
  if (!joint.channels.empty()) text.Fail("CHANNELS must appear once in a joint");
  const std::string_view word = text.Word();
  const auto count = controller::ParseWholeNumber(word, 0, kMost);
  if (!count) text.Fail(fmt::format("CHANNELS '{}' must be 0 to {}", Shown(word), kMost));
  joint.first_channel = channels;
  for (int i = 0; i < *count; ++i) {
    const std::string_view name = text.Word();
    const auto channel = std::ranges::find(kNames, BareName(name));
    if (channel == kNames.end()) {
      text.Fail(fmt::format("channel '{}' must be Xposition .. Zposition or Xrotation .. Zrotation",
                            Shown(name)));
    }
    joint.channels.push_back(static_cast<int>(channel - kNames.begin()));
  }
  channels += joint.channels.size();
}

void ReadHierarchy(BvhText& text, Bvh& bvh) {
  std::vector<int> open;
  text.Expect("hierarchy");
  while (true) {
    const std::string_view word = text.Word();
    const std::string key = word == "}" ? "}" : BareName(word);
    if (key == "root" || key == "joint" || key == "end") {
      BvhJoint& joint = bvh.joints.emplace_back();
      const std::string_view name = text.Rest();
      if (key != "end") joint.name = OneLine(name, 80);
      if (name.empty()) text.Fail(fmt::format("{} must have a name", Shown(word)));
      if (!open.empty()) joint.parent = open.back();
      text.Expect("{");
      open.push_back(static_cast<int>(std::ssize(bvh.joints) - 1));
    } else if (key == "motion" && open.empty()) {
      return;
    } else if (open.empty() || !IsWordOf("offset channels }", key)) {
      text.Fail(word.empty()
                    ? "the file ends in its HIERARCHY, without MOTION"
                    : fmt::format("'{}' must be {}", Shown(word),
                                  open.empty() ? "ROOT or MOTION"
                                               : "OFFSET, CHANNELS, JOINT, End Site or '}'"));
    } else if (key == "}") {
      open.pop_back();
    } else if (key == "channels") {
      ReadChannels(text, bvh.joints[static_cast<std::size_t>(open.back())], bvh.channels);
    } else {
      for (double& value : bvh.joints[static_cast<std::size_t>(open.back())].offset) {
        value = text.Number();
      }
    }
  }
}

/// The values of a row. None if it is the last one of a file that was cut.
std::optional<std::vector<double>> ValuesOf(std::string_view line, const BvhText& text,
                                            std::size_t channels, double rows_behind) {
  const bool may_be_cut = text.ended() && rows_behind >= 0.0;
  std::vector<double> values;
  for (std::string_view rest = line; !rest.empty();) {
    const std::size_t end = std::min(rest.find_first_of(kBlanks), rest.size());
    const auto value = NumberOrMissing(rest.substr(0, end));
    if (!value && may_be_cut && end == rest.size()) return std::nullopt;
    if (!value) {
      text.Fail(fmt::format("value {} is '{}', must be a number", values.size() + 1,
                            Shown(rest.substr(0, end))));
    }
    values.push_back(*value);
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks, end), rest.size()));
  }
  if (values.size() < channels && may_be_cut) return std::nullopt;
  if (values.size() != channels) {
    text.Fail(
        fmt::format("{} values must be {}, one for each of the CHANNELS", values.size(), channels));
  }
  // The last digits may be missing.
  if (may_be_cut && rows_behind > 0.0 && !text.has_last_line_end()) return std::nullopt;
  return values;
}

Bvh ReadBvh(const std::string& name, std::string_view bytes) {
  constexpr double kLongest_s = 10.0;
  BvhText text(name, WithoutByteOrderMark(bytes));
  Bvh bvh;
  ReadHierarchy(text, bvh);
  const double frames = text.Field("Frames");
  if (!(frames >= 0.0)) text.Fail(fmt::format("Frames is {}, must be at least 0", frames));
  bvh.frame_time_s = text.Field("Frame Time");
  if (!(bvh.frame_time_s > 0.0) || bvh.frame_time_s > kLongest_s) {
    text.Fail(fmt::format("Frame Time is {} s, must be above 0 and at most {}", bvh.frame_time_s,
                          kLongest_s));
  }
  while (!text.ended()) {
    const std::string_view line = text.Line();
    auto values =
        ValuesOf(line, text, bvh.channels, frames - 1.0 - static_cast<double>(bvh.frames.size()));
    if (!values) break;
    bvh.frames.push_back(std::move(*values));
  }
  if (bvh.frames.empty()) text.Fail("the file has no whole row of values");
  if (const auto rows = static_cast<double>(bvh.frames.size()); rows != frames) {
    bvh.remarks.push_back(
        fmt::format("Frames is {}, but the file has {} whole rows, which are read", frames, rows));
  }
  return bvh;
}

// --- Its hands -----------------------------------------------------------------------------------

/// The joints at which the bones of a hand turn.
struct BvhHand {
  std::array<std::vector<int>, kTurnedBones> joints = {};  // one each, if it is right
  std::vector<int> ends = {}, unclear = {};

  int Joint(int digit, int bone) const {
    return joints[static_cast<std::size_t>(TurnedBone(digit, bone))].front();
  }
};

/// The bones of a digit that have angles, from the hand on.
std::array<int, 3> BonesOf(int digit) {
  return digit == 0 ? std::array{0, 1, 3} : std::array{1, 2, 3};
}

std::map<std::string, BvhHand> HandsIn(const Bvh& bvh) {
  std::map<std::string, BvhHand> hands;
  for (int j = 0; j < std::ssize(bvh.joints); ++j) {
    const auto joint = DigitJointOf(bvh.joints[static_cast<std::size_t>(j)].name);
    if (!joint) continue;
    BvhHand& hand = hands[joint->hand];
    if (joint->bone == DigitJoint::kEnd) {
      hand.ends.push_back(j);
    } else if (joint->bone == DigitJoint::kUnclear) {
      hand.unclear.push_back(j);
    } else {
      hand.joints[static_cast<std::size_t>(TurnedBone(joint->digit, joint->bone))].push_back(j);
    }
  }
  for (auto& [side, hand] : hands) {  // thumbs with the names of a finger
    auto* const thumb = hand.joints.data() + TurnedBone(0, 0);
    if (!thumb[0].empty() || thumb[2].empty()) continue;
    std::swap(thumb[0], thumb[1]);
    std::swap(thumb[1], thumb[2]);
  }
  return hands;
}

/// True if a rotation of the joint changes.
bool Moves(const Bvh& bvh, int joint) {
  constexpr double kRounding_deg = 0.01;
  const BvhJoint& of = bvh.joints[static_cast<std::size_t>(joint)];
  for (std::size_t i = 0; i < of.channels.size(); ++i) {
    if (of.channels[i] < 3) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::vector<double>& frame : bvh.frames) {
      low = std::min(low, frame[of.first_channel + i]);
      high = std::max(high, frame[of.first_channel + i]);
    }
    if (high - low > kRounding_deg) return true;
  }
  return false;
}

/// Why the hand is not read; empty if it is.
std::string ProblemOf(const Bvh& bvh, const BvhHand& hand) {
  constexpr double kLeastShare = 0.6;
  constexpr std::string_view kNumbers =
      "1, 2, 3 must be the proximal, middle and distal bone of a finger, or metacarpal, proximal "
      "and distal of a thumb";
  const auto joint = [&bvh](int j) -> const BvhJoint& {
    return bvh.joints[static_cast<std::size_t>(j)];
  };
  if (!hand.unclear.empty()) {
    return fmt::format("{} may be any bone; {}", joint(hand.unclear.front()).name, kNumbers);
  }
  if (!hand.joints[TurnedBone(0, 2)].empty()) return "the thumb has more than three bones";
  for (const int end : hand.ends) {
    if (!Moves(bvh, end)) continue;
    return fmt::format("{} moves, but is the end of a digit by its name; {}", joint(end).name,
                       kNumbers);
  }
  bool moves = false;
  for (int digit = 0; digit < kDigitsOfHand; ++digit) {
    int before = -1;
    for (const int bone : BonesOf(digit)) {
      const auto& joints = hand.joints[static_cast<std::size_t>(TurnedBone(digit, bone))];
      if (joints.empty()) return fmt::format("{} is missing", BoneName(digit, bone));
      const BvhJoint& own = joint(joints.front());
      if (joints.size() > 1) {
        return fmt::format("several joints are {}: {}, {}", BoneName(digit, bone), own.name,
                           joint(joints.back()).name);
      }
      if (before >= 0 && own.parent != before) {
        return fmt::format("{} must be the child of {}", own.name, joint(before).name);
      }
      before = joints.front();
      moves = moves || Moves(bvh, before);
    }
  }
  for (int finger = 1; finger < kDigitsOfHand; ++finger) {
    // From the hand, where several fingers begin, to a knuckle is further than along the next bone.
    const BvhJoint& first = joint(hand.Joint(finger, 1));
    const int other = finger % (kDigitsOfHand - 1) + 1;
    if (joint(hand.Joint(other, 1)).parent != first.parent) continue;
    if (first.offset.norm() < kLeastShare * joint(hand.Joint(finger, 2)).offset.norm()) {
      return fmt::format("{} is a metacarpal by its OFFSETs; {}", first.name, kNumbers);
    }
  }
  return moves ? "" : "it never moves";
}

/// A joint, and the turns from the first bone of its digit to the bone before and to its own one in
/// the rest pose.
struct StraightJoint {
  const BvhJoint* joint = nullptr;
  Quaterniond before = Quaterniond::Identity();
  Quaterniond own = Quaterniond::Identity();
};

/// The joints of a digit. `rest_bend_rad`: largest angle between its bones in the rest pose.
std::array<StraightJoint, 3> StraightDigit(const Bvh& bvh, const BvhHand& hand, int digit,
                                           double& rest_bend_rad) {
  constexpr double kMostOfEnd_rad = 45.0 * kRadPerDeg;  // the end may be a point beside the finger
  std::array<StraightJoint, 3> joints;
  Vector3d along = Vector3d::Zero();
  Quaterniond turn = Quaterniond::Identity();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const int place = hand.Joint(digit, BonesOf(digit)[i]);
    const bool is_last = i + 1 == joints.size();
    const auto next = is_last ? std::ranges::find(bvh.joints, place, &BvhJoint::parent)
                              : bvh.joints.begin() + hand.Joint(digit, BonesOf(digit)[i + 1]);
    const Vector3d bone = next == bvh.joints.end() ? along : next->offset;
    const bool has_both = !along.isZero(0.0) && !bone.isZero(0.0);
    const double bend_rad = has_both ? std::atan2(along.cross(bone).norm(), along.dot(bone)) : 0.0;
    joints[i] = {.joint = &bvh.joints[static_cast<std::size_t>(place)], .before = turn};
    if (bend_rad > 0.0 && (!is_last || bend_rad <= kMostOfEnd_rad)) {
      turn = Quaterniond::FromTwoVectors(along, bone) * turn;
      rest_bend_rad = std::max(rest_bend_rad, bend_rad);
    }
    joints[i].own = turn;
    if (!bone.isZero(0.0)) along = bone;
  }
  return joints;
}

/// Relative to the bone before, none where the two are straight.
Quaterniond RotationOf(const StraightJoint& straight, const std::vector<double>& frame) {
  const BvhJoint& joint = *straight.joint;
  Quaterniond rotation = Quaterniond::Identity();
  for (std::size_t i = 0; i < joint.channels.size(); ++i) {
    if (joint.channels[i] < 3) continue;
    rotation = rotation * Eigen::AngleAxisd(kRadPerDeg * frame[joint.first_channel + i],
                                            Vector3d::Unit(joint.channels[i] - 3));
  }
  return straight.before.conjugate() * rotation * straight.own;
}

}  // namespace

Table TableOfBvh(const std::string& name, std::string_view text) {
  const Bvh bvh = ReadBvh(name, text);
  std::vector<std::string> remarks = bvh.remarks, problems, names = {"time_s"};
  std::vector<StraightJoint> columns;
  for (const auto& [side, hand] : HandsIn(bvh)) {
    const std::string of = side.empty() ? "hand" : side + " hand";
    if (const std::string problem = ProblemOf(bvh, hand); !problem.empty()) {
      problems.push_back(fmt::format("{}: {}", of, problem));
      continue;
    }
    double rest_bend_rad = 0.0;
    for (int digit = 0; digit < kDigitsOfHand; ++digit) {
      std::ranges::copy(StraightDigit(bvh, hand, digit, rest_bend_rad),
                        std::back_inserter(columns));
      for (const int bone : BonesOf(digit)) {
        const std::string bone_name = side + (side.empty() ? "" : "_") + BoneName(digit, bone);
        for (const char component : {'w', 'x', 'y', 'z'}) {
          names.push_back(fmt::format("{}_local_q{}", bone_name, component));
        }
      }
    }
    remarks.push_back(fmt::format(
        "{}: 0 deg is the rest pose of the file; PIP, DIP and thumb are corrected by its OFFSETs, "
        "by up to {:.1f} deg",
        of, kDegPerRad * rest_bend_rad));
  }
  if (columns.empty()) {
    throw UserError(
        {.place = name,
         .problem =
             problems.empty()
                 ? "has no joints of fingers, as RightHandIndex1, RightIndexProximal or "
                   "index.01.R; export the skeleton with its fingers"
                 : fmt::format("has no hand that can be read; {}", fmt::join(problems, "; "))});
  }
  for (const std::string& problem : problems) remarks.push_back("left out: " + problem);
  Table table{.columns = {}, .rows = bvh.frames.size(), .remarks = std::move(remarks)};
  for (std::string& column : names) table.columns.push_back({.name = std::move(column)});
  for (std::size_t k = 0; k < bvh.frames.size(); ++k) {
    auto column = table.columns.begin();
    const auto add = [&column](double value) {
      (column++)->numbers.push_back(std::isfinite(value) ? value : kMissing);
    };
    add(bvh.frame_time_s * static_cast<double>(k));
    for (const StraightJoint& joint : columns) {
      const Quaterniond q = RotationOf(joint, bvh.frames[k]);
      for (const double value : {q.w(), q.x(), q.y(), q.z()}) add(value);
    }
  }
  return table;
}

}  // namespace gauntlet::sim
