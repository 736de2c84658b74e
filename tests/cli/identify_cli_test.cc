// What gauntlet identify writes beside the chain: a servo for the simulated hand, and a page.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class IdentifyCliTest : public testing::Test {
 protected:
  ProgramResult Run(std::vector<std::string> arguments) const {
    return folder_.Run(std::move(arguments));
  }
  std::string Read(const std::string& name) const { return folder_.Read(name); }

  /// A hand of this servo follows a motion; what is found from its targets to its joints.
  nlohmann::json Identified(const std::string& hand, const std::string& name) const {
    std::ofstream(folder_.path() / (name + ".yaml"))
        << "question: How late?\nseed: 1\nglove:\n  motion: {kind: random, duration_s: 30, "
           "bandwidth_hz: 1.2, range_percent: 40}\nscore: {noise_free_twin: false}\n"
           "controllers:\n  raw:\n    filter: {kind: butterworth, cutoff_hz: 8}\n"
        << hand;
    const ProgramResult run = Run({"run", name + ".yaml", "--out", name});
    EXPECT_EQ(run.exit_code, 0) << run.standard_error << hand;
    const ProgramResult result =
        Run({"identify", name, "--from", "target", "--json", "--out", name + ".chain.yaml"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    return nlohmann::json::parse(result.standard_output)["parts"];
  }

  WorkingFolder folder_{GAUNTLET_PROGRAM};
};

/// The median over the parts of a quantity that they all have.
double MedianOf(const nlohmann::json& parts, const std::string& key) {
  std::vector<double> values;
  for (const auto& part : parts) {
    if (part[key]["value"].is_number()) values.push_back(part[key]["value"].get<double>());
  }
  EXPECT_GT(values.size(), parts.size() / 2) << key;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

TEST_F(IdentifyCliTest, GivesAServoWithWhichTheHandAnswersAsTheLogsDid) {
  GAUNTLET_LONG_TEST();
  const nlohmann::json hidden = Identified("hand: {servo: {kind: rc_analog}}\n", "hidden");
  const std::string servo = Read("hidden.hand.yaml");
  EXPECT_THAT(servo,
              AllOf(HasSubstr("# Made by gauntlet identify of hidden"), HasSubstr("kind: ideal"),
                    HasSubstr("dead_time_ms: "), HasSubstr("found by trials"),
                    HasSubstr("What no key of the hand has"), HasSubstr("#     index_mcp: ")));
  const nlohmann::json again = Identified(servo, "again");
  for (const char* key : {"delay_ms", "dead_time_ms", "lag_ms"}) {
    const double was = MedianOf(hidden, key);
    EXPECT_NEAR(MedianOf(again, key), was, 0.15 * was + 2.0) << key << "\n" << servo;
  }
  const double loop_deg = MedianOf(hidden, "hysteresis_deg");
  EXPECT_NEAR(MedianOf(again, "hysteresis_deg"), loop_deg, 0.15 * loop_deg) << servo;
}

TEST_F(IdentifyCliTest, DrawsMeasuredBesideSimulated) {
  GAUNTLET_LONG_TEST();
  std::string log = "t_s,claw<b>_command_deg,claw<b>_deg\n";
  for (int k = 0; k < 2000; ++k) {
    const auto command = [](double t) {
      return 20.0 * std::sin(3.0 * t) + 12.0 * std::sin(8.3 * t + 1.0) + 6.0 * std::sin(14.7 * t);
    };
    const double t = 0.005 * k;
    log += std::to_string(t) + "," + std::to_string(command(t)) + "," +
           std::to_string(0.9 * command(t - 0.06)) + "\n";
  }
  folder_.Write("claw.csv", log);
  const ProgramResult result = Run({"identify", "claw.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_error,
            "wrote out/claw.chain.yaml, out/claw.hand.yaml and out/claw.html\n");
  EXPECT_THAT(Read("out/claw.hand.yaml"), HasSubstr("not tried: the simulated hand has no such"));
  const std::string page = Read("out/claw.html");
  for (const char* text : {"claw&lt;b&gt;", "command", "measured", "simulated", "hysteresis",
                           "measured less simulated", "<b>60 ms</b>"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  EXPECT_EQ(page.find("claw<b>"), std::string::npos);
  const std::string sum = "Hysteresis is the sum of dry friction, backlash of gears and slack";
  EXPECT_THAT(Read("out/claw.chain.yaml"), HasSubstr(sum));
  EXPECT_THAT(result.standard_output,
              AllOf(HasSubstr("Set prediction.horizon_ms to 48.0 (0.8 of the delay, 60.0 ms): "
                              "written to\nout/claw.chain.yaml"),
                    testing::Not(HasSubstr("damping"))));
  EXPECT_LE(std::ranges::count(result.standard_output, '\n'), 20);
  EXPECT_THAT(page, HasSubstr("the sum of dry friction"));
  EXPECT_EQ(page.find("<script"), std::string::npos);
  // Command, measured, simulated; and the difference.
  std::size_t curves = 0;
  for (std::size_t at = 0; (at = page.find("<path stroke-width", at)) != std::string::npos; ++at)
    ++curves;
  EXPECT_EQ(curves, 4u);

  EXPECT_EQ(Run({"identify", "claw.csv", "--out", "other.html"}).exit_code, 2);

  // Where the page does not fit, nothing is left of the files that would have.
  const ProgramResult full =
      RunProgram({"sh", "-c", "ulimit -f 8; exec \"$0\" identify claw.csv --out full/claw.yaml",
                  GAUNTLET_PROGRAM},
                 {.working_directory = folder_.path()});
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_THAT(full.standard_error, HasSubstr("full/claw.html"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "full"));
}

TEST_F(IdentifyCliTest, TakesEachRowsCommandAsHeldWhenToldSo) {
  GAUNTLET_LONG_TEST();
  std::string log = "t_s,claw_command_deg,claw_deg\n";
  for (int k = 0; k < 1500; ++k) {
    const auto command = [](double t) {
      return 20.0 * std::sin(3.0 * t) + 12.0 * std::sin(8.3 * t + 1.0) + 6.0 * std::sin(14.7 * t);
    };
    const double t = 0.02 * k;
    log += std::to_string(t) + "," + std::to_string(command(t)) + "," +
           std::to_string(command(t - 0.063)) + "\n";
  }
  folder_.Write("claw.csv", log);
  const auto part_of = [this](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"identify", "claw.csv", "--json"});
    return nlohmann::json::parse(Run(arguments).standard_output)["parts"][0];
  };
  const auto late_ms = [](const nlohmann::json& part) {
    return part["dead_time_ms"]["value"].get<double>() + part["lag_ms"]["value"].get<double>();
  };
  const nlohmann::json smooth = part_of({});
  const nlohmann::json held = part_of({"--held"});
  EXPECT_NEAR(late_ms(smooth), 63.0, 1.0);
  EXPECT_NEAR(late_ms(held), 53.0, 2.0);  // steps of 20 ms are 10 ms late by themselves
  EXPECT_EQ(held["delay_ms"], smooth["delay_ms"]);
}

TEST_F(IdentifyCliTest, TellsLostMotionFromTheMotorsOwnHysteresisWhereMotorsAreInTheLog) {
  GAUNTLET_LONG_TEST();
  const auto command = [](double t) {
    return 20.0 * std::sin(3.0 * t) + 12.0 * std::sin(8.3 * t + 1.0) + 6.0 * std::sin(14.7 * t);
  };
  std::string log = "t_s,claw_command_deg,claw_motor_deg,claw_deg\n";
  double motor = command(0.0);
  double joint = motor;
  for (int k = 0; k < 4000; ++k) {
    const double wanted = command(0.005 * k - 0.06);
    motor = std::clamp(motor, wanted - 1.0, wanted + 1.0);
    joint = std::clamp(joint, motor - 1.5, motor + 1.5);
    log += std::to_string(0.005 * k) + "," + std::to_string(command(0.005 * k)) + "," +
           std::to_string(5.0 * motor) + "," + std::to_string(joint) + "\n";
  }
  folder_.Write("claw.csv", log);
  const ProgramResult result = Run({"identify", "claw.csv", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const auto part = nlohmann::json::parse(result.standard_output)["parts"][0];
  EXPECT_NEAR(part["lost_motion_deg"]["value"], 3.0, 0.1);
  EXPECT_NEAR(part["motor_hysteresis_deg"]["value"], 2.0, 0.1);
  EXPECT_NEAR(part["hysteresis_deg"]["value"], 5.0, 0.25);
  EXPECT_THAT(Run({"identify", "claw.csv", "--verbose"}).standard_output,
              AllOf(HasSubstr("lost motion"), HasSubstr("of motor")));
  const std::string told = "and lost motion, behind the motor";
  EXPECT_THAT(Read("out/claw.chain.yaml"), AllOf(HasSubstr("lost_motion_deg: ["), HasSubstr(told)));
  EXPECT_THAT(Read("out/claw.html"), HasSubstr("lost motion"));
  EXPECT_THAT(Read("out/claw.hand.yaml"), HasSubstr("lost motion"));
}

TEST_F(IdentifyCliTest, TakesAnArrayOfSeveral) {
  nlohmann::json json;
  for (int k = 0; k < 3000; ++k) json["camera"].push_back({k, 2 * k, 3 * k});
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.005 * k;
    json["log"]["t_s"].push_back(t);
    json["log"]["claw_command_deg"].push_back(20.0 * std::sin(3.0 * t));
    json["log"]["claw_deg"].push_back(20.0 * std::sin(3.0 * (t - 0.06)));
  }
  folder_.Write("both.json", json.dump());
  const ProgramResult result = Run({"identify", "both.json", "--array", "log", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const auto parts = nlohmann::json::parse(result.standard_output)["parts"];
  ASSERT_EQ(parts.size(), 1);
  EXPECT_EQ(parts[0]["part"], "claw");
  EXPECT_NEAR(parts[0]["delay_ms"]["value"], 60.0, 1.0);
  const ProgramResult none = Run({"identify", "both.json", "--array", "lob"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.standard_error, HasSubstr("holds no array lob, but camera"));
}

TEST_F(IdentifyCliTest, GivesNoServoForALogThatBeginsWithTheWearer) {
  std::string log = "t_s,true_angle_rad.index_mcp,hand_angle_rad.index_mcp\n";
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.005 * k;
    log += std::to_string(t) + "," + std::to_string(std::sin(3.0 * t)) + "," +
           std::to_string(std::sin(3.0 * (t - 0.06))) + "\n";
  }
  folder_.Write("trace.csv", log);
  const ProgramResult result = Run({"identify", "trace.csv", "--out", "t.yaml"});
  EXPECT_EQ(result.standard_error, "wrote t.yaml and t.html\n");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "t.hand.yaml"));
}

}  // namespace
}  // namespace gauntlet::test
