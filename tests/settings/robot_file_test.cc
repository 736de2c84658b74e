// A robot file gives back what was written, bit for bit, and names the place of every mistake.
#include "sim/settings/robot_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "controller/controller.h"
#include "controller/robot_text.h"
#include "sim/base/error.h"
#include "sim/settings/robot_constants.h"
#include "sim/settings/yaml_writer.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using controller::RobotConfig;
using testing::HasSubstr;
using testing::Not;

/// Two sensors on a finger of two joints and two motors; numbers that need all their digits.
RobotConfig Finger() {
  RobotConfig robot;
  robot.controller.filters = {
      {controller::KalmanConfig{.noise = {.r = {1.0 / 3.0, 21.18}, .q = {1e-300}}}},
      {controller::OneEuroConfig{}}};
  robot.controller.filter_at = controller::FilterAt::kEvent;
  robot.glove = {.channel_names = {"a", "b"},
                 .low_counts = {102.30000000000001, 0.1 + 0.2},
                 .high_counts = {920.7, 1e3},
                 .low_angle_rad = {-0.0, -1.0 / 7.0},
                 .high_angle_rad = {1.5707963267948966, 1.6},
                 .full_scale_counts = {4095.0}};
  robot.hand = {.joint_names = {"mcp", "pip"},
                .motor_names = {"m: one", "yes"},
                .coupling = {1.0 / 3.0, 0.0, 0.77777777777777701, 1.0000000000000093},
                .motor_of_joint = {"m: one", ""},
                .reference_angle_rad = {0.1, 0.7},
                .joint_min_rad = {-0.1, 0.0},
                .joint_max_rad = {1.5, 1.6},
                .counts_per_rad = {-195.37860813961072, 5e-3},
                .center_counts = {-7, 300},
                .min_counts = {-1000, 0},
                .max_counts = {1000, 1023}};
  robot.joint_map.joints = {{.joint = "mcp", .channels = {"a", "b"}, .weights = {0.1, 0.2}},
                            {.joint = "pip", .channels = {}, .offset_deg = 1.0 / 9.0}};
  robot.timing = {.tick_rate_hz = 1020.0, .ticks_per_sample = 17, .event_period_ms = 100.0 / 3.0};
  return robot;
}

std::string ToYaml(const RobotConfig& robot) {
  return RobotToYaml(robot, {.gauntlet_version = "0.1.0",
                             .scenario = "door_opening",
                             .controller = "tuned",
                             .model_hash = "1234"});
}

/// Every value, with the digits that identify it.
std::string Values(RobotConfig robot) {
  return SettingsToYaml([&](controller::SettingsVisitor& visitor) { robot.Visit(visitor); });
}

class RobotFileTest : public testing::Test {
 protected:
  RobotConfig Read(const std::string& text) {
    std::ofstream(file_) << text;
    return LoadRobot(file_);
  }
  /// The message when `from` becomes `to` in the file of a finger, without the file's folder.
  std::string Complaint(const std::string& from, const std::string& to) {
    std::string text = Values(Finger());
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from << " is not in\n" << text;
    text.replace(place, from.size(), to);
    try {
      Read(text);
    } catch (const UserError& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, Not(HasSubstr("\n")));
      EXPECT_THAT(message, testing::StartsWith(file_.string()));
      return message.substr(file_.string().size());
    }
    return "no complaint";
  }

  test::TemporaryDirectory folder_;
  std::filesystem::path file_ = folder_.path() / "robot.yaml";
};

TEST_F(RobotFileTest, GivesBackEveryValue) {
  const RobotConfig robot = Finger();
  const RobotConfig read = Read(ToYaml(robot));
  EXPECT_EQ(Values(read), Values(robot));
  EXPECT_EQ(read.glove.low_counts, robot.glove.low_counts);
  EXPECT_TRUE(std::signbit(read.glove.low_angle_rad[0]));
  EXPECT_EQ(read.hand.coupling, robot.hand.coupling);
  EXPECT_EQ(read.hand.motor_of_joint, robot.hand.motor_of_joint);
  EXPECT_EQ(read.hand.motor_names, robot.hand.motor_names);
  EXPECT_EQ(read.hand.center_counts, robot.hand.center_counts);
  EXPECT_EQ(read.timing.event_period_ms, robot.timing.event_period_ms);
}

/// The finger with a filter of one channel, and one with lists.
RobotConfig FingerWithFiltersByChannel() {
  RobotConfig robot = Finger();
  robot.controller.filters = {
      {.settings = controller::MovingAverageConfig{}, .channels = {"b"}},
      {.settings = controller::OneEuroConfig{}, .per_channel = {{"beta", {0.1, 1.0 / 3.0}}}},
      {.settings = controller::MedianConfig{}, .per_channel = {{"window", {3.0, 5.0}}}}};
  return robot;
}

TEST_F(RobotFileTest, GivesBackFiltersByChannel) {
  const RobotConfig robot = FingerWithFiltersByChannel();
  const RobotConfig read = Read(ToYaml(robot));
  EXPECT_EQ(Values(read), Values(robot));
  EXPECT_THAT(Values(read), HasSubstr("channels: [b]"));
  EXPECT_EQ(read.controller.filters[1].per_channel[0].values[1], 1.0 / 3.0);
  EXPECT_EQ(read.controller.filters[2].per_channel[0].values[1], 5.0);
  std::string text = ToYaml(robot);
  const auto complaint = [&](const std::string& from, const std::string& to) {
    std::string wrong = text;
    const std::size_t place = wrong.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    try {
      Read(wrong.replace(place, from.size(), to));
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("no complaint");
  };
  EXPECT_THAT(complaint("[3, 5]", "[3]"), HasSubstr("no complaint"));
  EXPECT_THAT(complaint("[3, 5]", "[3, 5, 7]"), HasSubstr("window: has 3 values, must have 1 for"));
  EXPECT_THAT(complaint("[3, 5]", "[3, 5.5]"), HasSubstr("window: has 5.5, must have whole"));
  EXPECT_THAT(complaint("[3, 5]", "[3, 0]"), HasSubstr("window[1]: is 0, must be from 1"));
  EXPECT_THAT(
      complaint("channels: [b]", "channels: [c]"),
      HasSubstr("channels: has c, must have numbers from 1 to 2 or names of channels (a, b)"));
}

/// The finger with a converter of 12 bits and a signed one.
RobotConfig FingerOfTwoConverters() {
  RobotConfig robot = Finger();
  robot.glove.low_counts = {102.30000000000001, -1e3 / 3.0};
  robot.glove.full_scale_counts = {4095.0, 2047.0};
  robot.glove.min_counts = {0.0, -2048.0};
  return robot;
}

TEST_F(RobotFileTest, GivesBackConvertersByChannel) {
  const RobotConfig robot = FingerOfTwoConverters();
  EXPECT_THAT(Values(robot), HasSubstr("  full_scale_counts: [4095, 2047]\n"
                                       "  min_counts: [0, -2048]\n"));
  for (const RobotConfig& read : {Read(ToYaml(robot)), Read(Values(robot))}) {
    EXPECT_EQ(Values(read), Values(robot));
    EXPECT_EQ(ConvertersOf(read.glove), ConvertersOf(robot.glove));
    EXPECT_EQ(ConvertersOf(read.glove)[1].min_counts, -2048.0);
  }
  // One for all is written as before there were lists.
  EXPECT_THAT(Values(Finger()), HasSubstr("  full_scale_counts: 4095\n  frame_number_bits: 64\n"));
  RobotConfig is_signed = Finger();
  is_signed.glove.min_counts = {-4096.0};
  EXPECT_THAT(Values(is_signed), HasSubstr("  full_scale_counts: 4095\n  min_counts: -4096\n"));
  EXPECT_EQ(Values(Read(ToYaml(is_signed))), Values(is_signed));
}

TEST_F(RobotFileTest, NamesThePlaceOfAWrongConverter) {
  const std::string key = "full_scale_counts: 4095";
  EXPECT_THAT(Complaint(key, "full_scale_counts: [4095, 4095, 4095]"),
              HasSubstr(":22: glove.full_scale_counts: has 3 values, must have 1 for all channels "
                        "or 2, one for each"));
  EXPECT_THAT(Complaint(key, key + "\n  min_counts: [0, 4095]"),
              HasSubstr(":22: glove.full_scale_counts: is 4095 for channel b, must be above its "
                        "min_counts, 4095, and at most 1000000000"));
  EXPECT_THAT(Complaint(key, key + "\n  min_counts: [0, -inf]"),
              HasSubstr(": glove.min_counts[1]: is"));
  EXPECT_THAT(
      Complaint(key, key + "\n  min_counts: -1e10"),
      HasSubstr(":15: glove.min_counts: is -1e+10, must be from -1000000000 to 1000000000"));
  EXPECT_THAT(Complaint(key, key + "\n  min_counts: []"),
              HasSubstr(":15: glove.min_counts: has 0 values, must have 1"));
  EXPECT_THAT(Complaint(key, "full_scale_counts: [4095, 500]"),
              HasSubstr(": glove: channel b: a pose is at 1000 counts, must be within the "
                        "converter's range, 0 to 500"));
}

TEST_F(RobotFileTest, AHandWithAMotorPerJointSaysWhichIsForWhich) {
  RobotConfig robot = Finger();
  robot.hand.motor_of_joint.clear();
  EXPECT_EQ(Read(ToYaml(robot)).hand.motor_of_joint, robot.hand.motor_names);
}

TEST_F(RobotFileTest, TablesHaveALinePerRow) {
  const std::string text = ToYaml(Finger());
  EXPECT_THAT(text,
              HasSubstr("  coupling:  # turn of each motor's spool per turn of each joint, as in "
                        "joint_names\n"
                        "    \"m: one\": [0.3333333333333333, 0]\n"
                        "    yes: [0.777777777777777, 1.0000000000000093]\n"));
  EXPECT_THAT(text, HasSubstr("\n\n# what is known of the glove\nglove:\n"));
  EXPECT_THAT(text, HasSubstr("    a: {low_counts: 102.30000000000001, high_counts: 920.7, "));
}

TEST_F(RobotFileTest, TheOrderOfTheRowsIsFree) {
  std::string text = ToYaml(Finger());
  const std::size_t a = text.find("    a: {");
  const std::size_t b = text.find("    b: {");
  const std::size_t end = text.find('\n', b) + 1;
  text = text.substr(0, a) + text.substr(b, end - b) + text.substr(a, b - a) + text.substr(end);
  EXPECT_EQ(Values(Read(text)), Values(Finger()));
}

TEST_F(RobotFileTest, NamesThePlaceOfEveryMistake) {
  const auto lines_before = [](const std::string& part) {
    const std::string text = Values(Finger());
    return std::to_string(1 + std::ranges::count(text.substr(0, text.find(part)), '\n'));
  };
  EXPECT_EQ(Complaint("full_scale_counts", "full_scale_count"),
            ":" + lines_before("full_scale_counts: 4095") +
                ":3: glove.full_scale_count: unknown key (did you mean full_scale_counts?)");
  EXPECT_EQ(Complaint("[0.3333333333333333, 0]", "[0.3333333333333333]"),
            ":" + lines_before("[0.3333333333333333, 0]") +
                ":15: hand.coupling.m: one: has 1 values, must have 2");
  EXPECT_THAT(Complaint("  channel_names: [a, b]\n", ""),
              HasSubstr(": glove.channel_names: is missing"));
  EXPECT_THAT(Complaint("joint_names: [mcp, pip]", "joint_names: [mcp]"),
              HasSubstr(": hand.joints.pip: unknown key"));
  EXPECT_THAT(Complaint("channel_names: [a, b]", "channel_names: [a, b, c]"),
              HasSubstr(": glove.channels.c: is missing"));
  EXPECT_THAT(Complaint("channel_names: [a, b]", "channel_names: [a, b, a]"),
              HasSubstr(": glove.channel_names: a is given twice"));
  EXPECT_THAT(Complaint("center_counts: -7", "center_counts: -7.5"),
              HasSubstr(": hand.motors.m: one.center_counts: is -7.5, must be a whole number"));
  EXPECT_THAT(Complaint("low_counts: 102.30000000000001", "low_counts: .nan"),
              HasSubstr(": glove.channels.a.low_counts: is \".nan\", must be a number"));
  EXPECT_THAT(Complaint("timing:", "timings:"),
              HasSubstr("timings: unknown key (did you mean timing?)"));
}

TEST_F(RobotFileTest, WhatDoesNotFitTogetherIsNamedAsInTheFile) {
  EXPECT_THAT(Complaint("motor: \"m: one\"", "motor: none"),
              HasSubstr(": hand.joints: none is not a motor of the hand"));
  EXPECT_THAT(Complaint("joint_max_rad: 1.5", "joint_max_rad: -1.5"),
              HasSubstr(": hand.joints: joint mcp: must be finite and at most joint_max_rad"));
  EXPECT_THAT(Complaint("center_counts: -7", "center_counts: -7000"),
              HasSubstr(": hand.motors: motor m: one: must be from min_counts to max_counts"));
  EXPECT_THAT(
      Complaint("high_counts: 920.7", "high_counts: 102.30000000000001"),
      HasSubstr(": glove: channel a: the two poses are 0 counts apart, must be at least 10"));
  EXPECT_THAT(Complaint("channels: [a, b]", "channels: [a, z]"),
              HasSubstr(": joint_map.mcp.channels: z is not a channel of the glove"));
  const std::string r = Complaint("r: [0.3333333333333333, 21.18]", "r: [1, 2, 3]");
  EXPECT_THAT(r, HasSubstr(": controller.filter[0].r: has 3 values"));
  EXPECT_THAT(r, testing::StartsWith(":5:10: "));  // the line of r
}

TEST_F(RobotFileTest, AFileThatIsNotThereOrHoldsAScenarioIsRefused) {
  EXPECT_THROW(LoadRobot(folder_.path() / "none.yaml"), UserError);
  EXPECT_THROW(Read("question: q\ncontrollers: {raw: {}}\n"), UserError);
}

std::string ToText(const RobotConfig& robot) {
  return RobotToText(robot, {.gauntlet_version = "0.1.0",
                             .scenario = "two\nlines",
                             .controller = "tuned",
                             .model_hash = "1234"});
}

/// What controller::RobotFromText() says of it.
std::string ComplaintOfText(const std::string& text) {
  try {
    controller::RobotFromText(text);
  } catch (const controller::SettingError& error) {
    return error.what();
  }
  return "no complaint";
}

/// "line 9: " for where Finger() has the key.
std::string LineOf(const std::string& key) {
  const std::string text = ToText(Finger());
  return "line " +
         std::to_string(1 + std::count(text.begin(), text.begin() + text.find(key), '\n')) + ": ";
}

TEST(RobotText, GivesBackEveryValueOfEveryKind) {
  for (const controller::FilterKind& kind : controller::FilterKinds()) {
    RobotConfig robot = Finger();
    robot.controller.filters.push_back(kind.defaults);
    std::visit(
        [](auto& settings) {
          if (auto* r = controller::MeasurementVarianceOf(settings)) *r = {0.1, 1.0 / 3.0};
        },
        robot.controller.filters.back().settings);
    EXPECT_EQ(Values(controller::RobotFromText(ToText(robot))), Values(robot)) << kind.name;
  }
  RobotConfig robot = FingerWithFiltersByChannel();
  EXPECT_EQ(Values(controller::RobotFromText(ToText(robot))), Values(robot));
  EXPECT_THAT(ToText(robot), HasSubstr("window = 2 3 5"));
  robot = FingerOfTwoConverters();
  EXPECT_EQ(Values(controller::RobotFromText(ToText(robot))), Values(robot));
  EXPECT_THAT(ToText(robot), HasSubstr("\n  full_scale_counts = 2 4095 2047\n"
                                       "  min_counts = 2 0 -2048\n"));
  robot = Finger();
  robot.glove.channel_names = {"=#\"\\ \t\n7", "\303\244 9\r"};
  robot.joint_map.joints.clear();
  EXPECT_EQ(Values(controller::RobotFromText(ToText(robot))), Values(robot));
}

TEST(RobotText, MayHaveBlanksCommentsAndEndsOfLinesOfWindows) {
  std::string text;
  for (const char c : "# one more\n\n" + ToText(Finger())) {
    if (c == '\n') text += " \r";
    text += c;
  }
  EXPECT_EQ(Values(controller::RobotFromText(text)), Values(Finger()));
}

TEST(RobotText, NamesThePlaceOfEveryMistake) {
  const auto complaint = [](const std::string& from, const std::string& to) {
    std::string text = ToText(Finger());
    const std::size_t place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from << " is not in\n" << text;
    return ComplaintOfText(text.replace(place, from.size(), to));
  };
  EXPECT_EQ(complaint("\ncontroller =\n", "\ncontroller\n"),
            "line 5: must be a key, \"=\" and its values");
  EXPECT_EQ(complaint("\ncontroller =\n", "\ncontroller = 0x\n"),
            "line 5: has 0x behind \"=\", must be numbers or texts in quotes");
  EXPECT_EQ(complaint("\"kalman\"", "\"kalman"), "line 7: has a quote that does not end");
  EXPECT_EQ(complaint("\"kalman\"", "7"), "line 7: controller.filter[0].kind: must be a text");
  EXPECT_THAT(
      complaint("\"kalman\"", "\"calman\""),
      testing::StartsWith("line 7: controller.filter[0].kind: is calman, must be one of none, "));
  EXPECT_EQ(complaint("ticks_per_sample = 17", "ticks_per_sample = 17.5"),
            LineOf("ticks_per_sample") + "timing.ticks_per_sample: must be a whole number");
  EXPECT_EQ(complaint("ticks_per_sample = 17", "ticks_per_sample = 1e99"),
            LineOf("ticks_per_sample") + "timing.ticks_per_sample: must be a whole number");
  EXPECT_EQ(complaint("ticks_per_sample = 17", "ticks_per_sample = \"17\""),
            LineOf("ticks_per_sample") + "timing.ticks_per_sample: must be a number");
  EXPECT_THAT(complaint("ticks_per_sample", "ticks"),
              HasSubstr(": ticks: is not a setting in this place"));
  EXPECT_THAT(
      complaint("high_angle_rad = 1.6", "high_angle_rad = 60"),
      HasSubstr("glove.channels.b.high_angle_rad: is 60, must be from -6.28319 to 6.28319"));
  EXPECT_THAT(complaint("filter_at", "filter_att"),
              testing::StartsWith(LineOf("filter_at") + "filter_att: is not a setting in this"));
  EXPECT_THAT(complaint("ticks_per_sample = 17", "ticks_per_sample = 0"),
              HasSubstr(": timing.ticks_per_sample: is 0, must be from 1 to 100000"));
  EXPECT_EQ(complaint("channel_names = 2", "channel_names = 1e9"),
            LineOf("channel_names") + "glove.channel_names: has another length than 1000000000");
  EXPECT_EQ(complaint("channel_names = 2", "channel_names = -1"),
            LineOf("channel_names") + "glove.channel_names: has another length than -1");
  EXPECT_THAT(complaint("channel_names = 2", "channel_names = nan"),
              HasSubstr("has nan behind \"=\", must be numbers or texts in quotes"));
  EXPECT_THAT(complaint("channel_names = 2", "channel_names = 1"),
              testing::StartsWith(LineOf("channel_names")));
  EXPECT_EQ(ComplaintOfText(""), "controller: is missing");
  EXPECT_THAT(ComplaintOfText(ToText(Finger()) + "more = 1\n"),
              HasSubstr(": more: is not a setting in this place"));
  // What a Controller cannot be made of, with the keys of the text.
  EXPECT_THAT(complaint("frame_number_bits = 64", "frame_number_bits = 1"),
              testing::StartsWith(LineOf("frame_number_bits") + "glove.frame_number_bits: is 1, "));
  EXPECT_EQ(complaint("full_scale_counts = 4095", "full_scale_counts = 2 4095 0"),
            LineOf("full_scale_counts") +
                "glove.full_scale_counts: is 0 for channel b, must be above its min_counts, 0, and "
                "at most 1000000000");
  EXPECT_THAT(complaint("center_counts = -7", "center_counts = 99999"),
              testing::ContainsRegex("^line [0-9]+: hand.center_counts: motor"));
}

TEST(RobotText, OfAnOlderVersionHasTheDefaultsOfNewSettings) {
  std::string text = ToText(Finger());
  for (const std::string key : {"lost_after_ms", "when_lost", "lost_speed_deg_s"}) {
    const std::size_t begin = text.rfind('\n', text.find(key));
    text.erase(begin, text.find('\n', begin + 1) - begin);
  }
  EXPECT_EQ(Values(controller::RobotFromText(text)), Values(Finger()));
}

TEST(RobotFile, HasTheRateOfAGloveWhosePeriodIsNoWholeNumberOfSteps) {
  RobotConfig robot = Finger();
  EXPECT_THAT(sim::RobotToYaml(robot, {}), Not(HasSubstr("glove_rate_hz"))) << "as before";
  robot.timing = controller::WithTickRate({.tick_rate_hz = 1080.0, .ticks_per_sample = 12}, 1000.0);
  const std::string yaml = sim::RobotToYaml(robot, {});
  EXPECT_THAT(yaml, HasSubstr("a new sample every 11.11 times"));
  EXPECT_EQ(sim::ParseRobot("robot.yaml", yaml).timing.sample_rate_hz(), 90.0);
  EXPECT_EQ(sim::ParseRobot("robot.txt", sim::RobotToText(robot, {})).timing.sample_rate_hz(),
            90.0);
}

TEST(RobotFile, ListsItsProblemsWithTheirPlaces) {
  RobotConfig robot = Finger();
  robot.joint_map.joints = {{.joint = "mcp", .channels = {"a"}},
                            {.joint = "pip", .channels = {"b"}}};
  EXPECT_TRUE(sim::ProblemsOfRobot("robot.yaml", sim::RobotToYaml(robot, {})).empty());
  robot.glove.high_angle_rad[0] = 6.1;
  const auto yaml = sim::ProblemsOfRobot("robot.yaml", sim::RobotToYaml(robot, {}));
  ASSERT_EQ(yaml.size(), 1u);
  EXPECT_THAT(yaml[0], testing::MatchesRegex("robot.yaml:[0-9]+:[0-9]+: warning: "
                                             "glove.channels.*high_angle_rad: is 6.1.*"));
  const auto text = sim::ProblemsOfRobot("robot.txt", sim::RobotToText(robot, {}));
  ASSERT_EQ(text.size(), 1u);
  EXPECT_THAT(text[0], HasSubstr("warning: line "));
  EXPECT_EQ(sim::ProblemsOfRobot("robot.yaml", "glove: 1\n").size(), 1u);
}

TEST(RobotText, IsReadFromAFileThatEndsInTxt) {
  const test::TemporaryDirectory folder;
  const auto file = folder.path() / "robot.txt";
  std::ofstream(file) << ToText(Finger());
  EXPECT_EQ(Values(LoadRobot(file)), Values(Finger()));
  std::ofstream(file) << "more = 1\n";
  try {
    LoadRobot(file);
    ADD_FAILURE() << "no error";
  } catch (const UserError& error) {
    EXPECT_EQ(std::string(error.what()), file.string() + ": line 1: controller: is missing");
  }
}

TEST(RobotText, WithLinesThatAreMissingOrSwappedIsNeverAnotherRobot) {
  std::vector<std::string> lines;
  std::istringstream text(ToText(Finger()));
  for (std::string line; std::getline(text, line);) lines.push_back(line + "\n");
  const auto joined = [](const std::vector<std::string>& all) {
    return std::accumulate(all.begin(), all.end(), std::string());
  };
  int refused = 0;
  for (std::size_t i = 4; i + 1 < lines.size(); ++i) {
    std::vector<std::string> swapped = lines;
    std::swap(swapped[i], swapped[i + 1]);
    if (swapped[i] == swapped[i + 1]) continue;
    EXPECT_NE(ComplaintOfText(joined(swapped)), "no complaint") << lines[i];
    std::vector<std::string> twice = lines;
    twice.insert(twice.begin() + static_cast<std::ptrdiff_t>(i), lines[i]);
    EXPECT_NE(ComplaintOfText(joined(twice)), "no complaint") << lines[i];
    std::vector<std::string> without = lines;
    without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
    refused += ComplaintOfText(joined(without)) != "no complaint";
  }
  EXPECT_GT(refused, 10) << "what has no default is asked for";
}

TEST(RobotText, OfWhichAPartIsMissingIsRefused) {
  const std::string text = ToText(Finger());
  const std::size_t last_line = text.rfind('\n', text.size() - 2);
  for (std::size_t length = 0; length < last_line; ++length) {
    EXPECT_NE(ComplaintOfText(text.substr(0, length)), "no complaint") << length;
  }
}

}  // namespace
}  // namespace gauntlet::sim
