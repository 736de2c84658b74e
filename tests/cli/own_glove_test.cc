// A recording in counts of a real glove reaches the controllers as it is, and its column map is the
// calibration of the exported controller.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/base/signal.h"
#include "sim/settings/glove_calibration.h"
#include "sim/settings/robot_file.h"
#include "sim/settings/yaml_reader.h"
#include "tests/support/program.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kSensors = 5;
constexpr const char* kJoints[] = {"thumb_ip", "index_pip", "middle_pip", "ring_pip", "little_pip"};
constexpr double kGloveRate_hz = 60.0;
constexpr double kCountsPerRange = 300.0;

double LowCounts(int sensor) { return 350.0 + 20.0 * sensor; }

/// Degrees of a joint that is bent by this share.
double BentDeg(int joint, double share) {
  return joint == 0 ? -15.0 + 95.0 * share : 100.0 * share;
}

/// The recording of a home-made glove of 10 bits: `bend(sensor, t)` is a share of the range.
template <class Bend>
std::string Recorded(double seconds, std::uint64_t seed, const Bend& bend) {
  std::string text = "millis;flex1;flex2;flex3;flex4;flex5\n";
  sim::RandomStream random(seed, "own glove");
  for (int k = 0; k < seconds * kGloveRate_hz; ++k) {
    const double t = k / kGloveRate_hz;
    text += fmt::format("{}", static_cast<int>(1000.0 * t) + 5000);
    for (int i = 0; i < kSensors; ++i) {
      const double noise = 4.0 * sim::BoxMuller(random).first;
      text += fmt::format(";{:.0f}", LowCounts(i) + kCountsPerRange * bend(i, t) + noise);
    }
    text += "\n";
  }
  return text;
}

class OwnGlove : public testing::Test {
 protected:
  ProgramResult Run(std::vector<std::string> arguments) {
    ProgramResult result = folder_.Run(std::move(arguments));
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    return result;
  }
  fs::path In(const std::string& name) const { return folder_.In(name); }
  void Write(const std::string& name, const std::string& text) { folder_.Write(name, text); }
  std::string Read(const std::string& name) const { return folder_.Read(name); }
  /// A score of each controller of a scenario.
  std::vector<double> Scores(const std::string& scenario,
                             const std::string& score = "tracking_rmse_deg") {
    const ProgramResult compared =
        Run({"compare", scenario, "--causes", "none", "--json", "--out", "out"});
    last_error_ = compared.standard_error;
    const auto result = nlohmann::json::parse(compared.standard_output);
    std::vector<double> scores;
    for (const auto& controller : result["controllers"]) {
      scores.push_back(controller["summary"][score]["mean"]);
    }
    return scores;
  }
  void SetUp() override {
    Write("glove.csv", Recorded(20.0, 1, [](int i, double t) {
            return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (0.25 + 0.05 * i) * t);
          }));
    Write("poses_glove.csv",
          Recorded(15.0, 2, [](int, double t) { return 0.5 * std::floor(t / 5.0); }));
    std::string poses = "name,start_s,end_s";
    for (const char* joint : kJoints) poses += fmt::format(",{}_deg", joint);
    for (int pose = 0; pose < 3; ++pose) {
      poses += fmt::format("\np{},{},{}", pose, 5.0 * pose + 0.5, 5.0 * pose + 4.5);
      for (int i = 0; i < kSensors; ++i) poses += fmt::format(",{}", BentDeg(i, 0.5 * pose));
    }
    Write("poses.csv", poses + "\n");
    Run({"inspect", "glove.csv", "--write-scenario", "my.yaml"});
  }
  /// The map with these two points of each sensor, confirmed.
  void WriteMap(const std::vector<controller::ChannelCurve>& points) {
    std::string map = "column,channel,unit,raw_low,raw_high,deg_low,deg_high\nmillis,time,ms,,,,\n";
    for (int i = 0; i < kSensors; ++i) {
      const auto& [counts, angle_deg] = std::tie(points[i].counts, points[i].angle_deg);
      map += fmt::format("flex{},{},counts,{},{},{},{}\n", i + 1, kJoints[i], counts.front(),
                         counts.back(), angle_deg.front(), angle_deg.back());
    }
    Write("my.map.csv", map);
  }

  WorkingFolder folder_{GAUNTLET_PROGRAM, std::chrono::minutes(10)};
  std::string last_error_;
};

/// The controller's angles after two seconds of these counts [deg].
std::vector<double> AnglesAt(const controller::RobotConfig& robot,
                             const std::vector<double>& counts, std::vector<int>& motors) {
  controller::Controller controller(robot);
  for (int tick = 0; tick < 2.0 * robot.timing.tick_rate_hz; ++tick) {
    const bool is_fresh = tick % robot.timing.ticks_per_sample == 0;
    const controller::Command command =
        is_fresh ? controller.Step({.counts = counts}) : controller.Step();
    motors.assign(command.motor_counts.begin(), command.motor_counts.end());
  }
  std::vector<double> angles;
  for (const char* joint : kJoints) {
    const auto place = std::ranges::find(robot.hand.joint_names, joint);
    angles.push_back(controller.target_angle_rad()[place - robot.hand.joint_names.begin()] *
                     sim::kDegPerRad);
  }
  return angles;
}

/// Both ends of the glove drive each joint over its range, and the motors as far as those of a
/// controller that is made for the simulated glove.
void ExpectWholeRange(const controller::RobotConfig& robot) {
  controller::RobotConfig nominal = robot;
  nominal.controller.linearisation = {};
  for (int i = 0; i < kSensors; ++i) {
    nominal.glove.low_counts[i] = 102.3;
    nominal.glove.high_counts[i] = 920.7;
    nominal.glove.low_angle_rad[i] = BentDeg(i, 0.0) * sim::kRadPerDeg;
    nominal.glove.high_angle_rad[i] = BentDeg(i, 1.0) * sim::kRadPerDeg;
  }
  for (const double share : {0.0, 1.0}) {
    std::vector<double> counts;
    for (int i = 0; i < kSensors; ++i) counts.push_back(LowCounts(i) + kCountsPerRange * share);
    std::vector<int> motors, nominal_motors;
    const std::vector<double> angles = AnglesAt(robot, counts, motors);
    AnglesAt(nominal, std::vector<double>(kSensors, share == 0.0 ? 102.3 : 920.7), nominal_motors);
    for (int i = 0; i < kSensors; ++i) {
      EXPECT_NEAR(angles[i], BentDeg(i, share), 0.01 * (BentDeg(i, 1.0) - BentDeg(i, 0.0)))
          << kJoints[i] << " at " << share;
    }
    for (std::size_t m = 0; m < motors.size(); ++m) {
      EXPECT_NEAR(motors[m], nominal_motors[m], 0.01 * 2048) << robot.hand.motor_names[m];
    }
  }
}

std::vector<controller::ChannelCurve> RealEnds() {
  std::vector<controller::ChannelCurve> ends(kSensors);
  for (int i = 0; i < kSensors; ++i) {
    ends[i].counts = {LowCounts(i), LowCounts(i) + kCountsPerRange};
    ends[i].angle_deg = {BentDeg(i, 0.0), BentDeg(i, 1.0)};
  }
  return ends;
}

TEST_F(OwnGlove, ItsMapIsTheCalibrationOfTheExportedController) {
  WriteMap(RealEnds());
  Run({"run", "my.yaml", "--controllers", "raw,kalman", "--causes", "none", "--out", "out"});
  const ProgramResult exported = Run({"export", "out", "--controller", "kalman"});
  EXPECT_THAT(exported.standard_error,
              AllOf(Not(HasSubstr("warning")), HasSubstr("joints without a sensor hold an angle:"),
                    HasSubstr("index_mcp")));
  const controller::RobotConfig robot = sim::LoadRobot(In("out/kalman.robot.yaml"));
  for (int i = 0; i < kSensors; ++i) {
    EXPECT_DOUBLE_EQ(robot.glove.low_counts[i], LowCounts(i));
    EXPECT_DOUBLE_EQ(robot.glove.high_counts[i], LowCounts(i) + kCountsPerRange);
  }
  EXPECT_EQ(robot.glove.full_scale_counts, std::vector{1023.0});
  ExpectWholeRange(robot);
}

TEST_F(OwnGlove, BothRoutesToItsCalibrationAgree) {
  Run({"calibrate", "poses_glove.csv", "--map", "my.map.csv", "--poses", "poses.csv",
       "--linearisation", "two_point", "--out", "cal.yaml"});
  std::string scenario = Read("my.yaml");
  scenario.resize(scenario.find("controllers:"));
  Write("both.yaml", scenario +
                         "controllers:\n  raw: {filter: none}\n  calibrated: {filter: none, "
                         "calibration: cal.yaml}\n");
  // The map of inspect has other points: 4 % of the range.
  const std::vector<double> assumed = Scores("both.yaml");
  ASSERT_EQ(assumed.size(), 2U);
  EXPECT_NEAR(assumed[0], assumed[1], 2.0);
  EXPECT_THAT(last_error_, HasSubstr("controllers.calibrated: its calibration and the column map "
                                     "differ by up to"));
  Run({"export", "out", "--controller", "calibrated"});
  ExpectWholeRange(sim::LoadRobot(In("out/calibrated.robot.yaml")));

  WriteMap(sim::ReadAll<sim::Calibration>(In("cal.yaml")).linearisation.channels);
  const std::vector<double> same = Scores("both.yaml");
  ASSERT_EQ(same.size(), 2U);
  EXPECT_NEAR(same[0], same[1], 1e-6);
  EXPECT_THAT(last_error_, Not(HasSubstr("differ by up to")));
  Run({"export", "out", "--controller", "raw"});
  ExpectWholeRange(sim::LoadRobot(In("out/raw.robot.yaml")));
}

TEST_F(OwnGlove, AssumptionsAndSimulatedGlovesAreWarnedOf) {
  Run({"run", "my.yaml", "--controllers", "raw", "--causes", "none", "--out", "out"});
  EXPECT_THAT(Run({"export", "out", "--controller", "raw"}).standard_error,
              HasSubstr("warning: the column map assumes joint sign range of thumb_ip, index_pip"));
  EXPECT_THAT(Read("out/raw.robot.yaml"), testing::StartsWith("# warning: the column map assumes"));
  std::string map = Read("my.map.csv");
  for (std::size_t place = 0; (place = map.find(",counts,", place)) != std::string::npos;) {
    map.replace(place, 8, ",volts,");
  }
  for (std::size_t place = 0; (place = map.find(",10\n", place)) != std::string::npos;) {
    map.replace(place, 4, ",\n");  // bits are of counts only
  }
  Write("my.map.csv", map);
  Run({"run", "my.yaml", "--controllers", "raw", "--causes", "none", "--out", "out2"});
  EXPECT_THAT(Run({"export", "out2", "--controller", "raw", "--text"}).standard_error,
              AllOf(HasSubstr("warning: assumed: joint, sign and range of thumb_ip, index_pip"),
                    HasSubstr("a sample of the glove is: the numbers of its column")));
  EXPECT_THAT(Read("out2/raw.robot.txt"), testing::StartsWith("# warning: assumed: joint"));
}

// One row in 47 is a spike of 20 deg: a median of five rows finds it, the raw signal does not.
TEST_F(OwnGlove, ItsSpikesReachTheFilters) {
  std::string spiky = "time_s,index_pip\n", truth = spiky;
  for (int k = 0; k < 1500; ++k) {
    const double deg = 40.0 + 20.0 * std::sin(0.03 * k);
    truth += fmt::format("{:.2f},{:.3f}\n", 0.01 * k, deg);
    spiky += fmt::format("{:.2f},{:.3f}\n", 0.01 * k, deg + (k % 47 == 24 ? 20.0 : 0.0));
  }
  Write("spiky.csv", spiky);
  Write("truth.csv", truth);
  const auto scenario = [&](const std::string& motion) {
    Write("spiky.yaml",
          "question: q\nglove:\n  rate_hz: 100\n  channels: [index_pip]\n  motion: {kind: "
          "recording, file: spiky.csv, use: measured, " +
              motion +
              "}\n  noise: {kind: none}\ncontrollers:\n  raw: {filter: none}\n  median: {filter: "
              "{kind: median, window: 5}}\n");
  };
  for (const char* reference : {"reference: truth.csv, ", ""}) {
    scenario(std::string(reference) + "problems: repair");
    const std::vector<double> repaired = Scores("spiky.yaml", "jitter_rms_deg");
    EXPECT_GT(repaired[0], 2.0 * repaired[1]) << reference;
    scenario(std::string(reference) + "problems: remove");
    const std::vector<double> removed = Scores("spiky.yaml", "jitter_rms_deg");
    EXPECT_LT(removed[0], 2.0 * removed[1] + 0.05) << reference;
    EXPECT_NEAR(removed[1], repaired[1], 0.05) << reference;
  }
}

}  // namespace
}  // namespace gauntlet::test
