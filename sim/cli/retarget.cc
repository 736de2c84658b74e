
#include <filesystem>
#include <string>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/output_file.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/fit/retarget/fingertip_motion.h"
#include "sim/fit/retarget/retargeting.h"
#include "sim/tables/name_words.h"

namespace gauntlet::sim {
namespace {

constexpr auto kKeypoints = "keypoints";

struct RetargetOptions {
  static constexpr auto kName = "retarget";
  static constexpr auto kPurpose = "Move a recording to another hand, by fingertips";
  static constexpr auto kGroup = Group::kMeasure;
  std::string recording;
  std::string from;
  std::string hand;
  std::string out;  // empty: out/<recording>.retargeted.csv
  FingertipFormat format;
  bool json = false;

  Options Rows() {
    return {
        Argument("recording", &recording, Offer::kFiles,
                 "joint angles by the names of the joints of --from, as FFJ3_rad or index_mcp (no "
                 "unit: degrees); or keypoints"),
        Option(
            "--from", &from,
            {.value = "HAND.xml|keypoints", .offer = Offer::kFiles, .required = true},
            "the hand of the recording: its MJCF, or keypoints (MediaPipe, OpenXR, WebXR, ARKit, "
            "Manus and alike: docs/reference/column-maps.md)"),
        Option("--hand", &hand, {.value = "HAND.xml", .offer = Offer::kFiles},
               "the hand that shall move [models/hand_arm.xml]"),
        OutOption(out, "file to write [out/<recording>.retargeted.csv]", "FILE.csv"),
        Option("--rate", &format.rate_hz, {.value = "HZ", .range = {0.01, 100000.0}},
               "rows per second of a recording without times"),
        ArrayOptions(format.array),
        UnitOption(format.unit, {"deg", "rad"}, "unit of angles whose names have none [deg]"),
        TimeUnitOption(format.time_unit),
        Option("--side", &format.side, {.choices = {"left", "right"}},
               "the hand to take from keypoints of both"),
        Option("--touch-mm", &format.touch_mm, {.range = {1.0, 50.0}, .shows_default = true},
               "distance of two fingertips in contact, where neither radii nor capsules tell it"),
        Option("--json", &json, {}, "print JSON instead of the table"),
    };
  }

  static constexpr auto kNotes = R"(
Angles of one hand are wrong on another: lengths and the thumb's axes differ.
The fingertips of the hand follow those of the recording, scaled by the lengths
of the digits. Contacts of thumb and finger stay contacts, and digits do not
interpenetrate. All angles are within the ranges of the hand. Wrist and arm are
copied by name.

The fingers of a hand are found by the names of its joints (thumb_mcp, FFJ3,
if_mcp). Its motors and cables do not matter here.

Example:
  gauntlet retarget scenarios/recordings/door_opening/angles_01.csv --from models/hand_arm.xml
  gauntlet retarget keypoints.csv --from keypoints --hand models/five_motor_hand.xml
)";
};

std::filesystem::path RetargetedFile(const RetargetOptions& options) {
  if (!options.out.empty()) return options.out;
  const std::string stem = std::filesystem::path(options.recording).stem().string();
  return std::filesystem::path("out") / (stem + ".retargeted.csv");
}

void PrintNotes(const HandKinematics& hand) {
  for (const std::string& note : hand.notes()) Say("gauntlet: warning: {}\n", note);
}

FingertipMotion MotionOfRecording(const RetargetOptions& options, const HandKinematics& hand) {
  if (options.from == kKeypoints) return FingertipsOfKeypoints(options.recording, options.format);
  HandKinematics from(options.from, "--from", FingerOfJointName);
  PrintNotes(from);
  FingertipFormat format = options.format;
  format.copied = hand.other_joint_names();
  return FingertipsOfAngles(options.recording, from, format);
}

void RunRetarget(const RetargetOptions& options) {
  const std::filesystem::path target = RetargetedFile(options);
  const std::filesystem::path model = options.hand.empty() ? DataFolder("models") / "hand_arm.xml"
                                                           : std::filesystem::path(options.hand);
  HandKinematics hand(model, "--hand", FingerOfJointName);
  PrintNotes(hand);
  const FingertipMotion motion = MotionOfRecording(options, hand);
  RefuseInput(target);
  const RetargetedMotion retargeted = Retarget(motion, hand);
  const double copied_overlap_share = CopiedOverlapShare(motion, hand);
  MakeDirectoryOf(target);
  WriteOutputFile(target, RetargetedCsv(motion, hand, retargeted));
  PrintText(options.json ? RetargetedJson(motion, hand, retargeted, copied_overlap_share)
                         : TextOf(RetargetedText(motion, hand, retargeted, copied_overlap_share),
                                  StyleOf({})));
  FlushOutput();
  for (const std::string& remark : motion.remarks) Say("gauntlet: {}\n", remark);
  Say("wrote {}\n", target.string());
}

}  // namespace

Command MakeRetargetCommand() { return MakeCommand(RunRetarget); }

}  // namespace gauntlet::sim
