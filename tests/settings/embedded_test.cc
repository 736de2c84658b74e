// The controller of a microcontroller, built as firmware is, beside the one in double.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <ostream>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "controller/controller.h"
#include "controller/embedded/embedded_settings.h"
#include "controller/number.h"
#include "sim/settings/robot_constants.h"
#include "tests/controller/test_hand.h"
#include "tests/settings/embedded_glove.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr int kTicks = 94'096;

/// Firmware does without exceptions and run-time types, and warns of every double.
constexpr const char* kFlags =
    "-std=c++20 -O2 -fno-exceptions -fno-rtti -ffp-contract=off -Wall -Wextra -Wconversion "
    "-Wsign-conversion -Wshadow -Wdouble-promotion -Wfloat-conversion -Werror";

RobotConfig SettledKalman() {
  RobotConfig robot;
  robot.glove = PlainGlove(kChannels);
  robot.hand = CoupledHand(kChannels);
  robot.controller.filters = {{KalmanSteadyConfig{.noise = {.r = {15.0}, .q = {1e-4}}}}};
  return robot;
}

/// The recommended one, with a glove whose channels look ahead by different times.
RobotConfig Adaptive() {
  RobotConfig robot = SettledKalman();
  std::vector<double> horizon_ms(kChannels, 45.0);
  std::vector<double> r_deg2(kChannels, 0.5);
  horizon_ms[1] = 0.0;
  horizon_ms[4] = 20.4;
  r_deg2[5] = 0.1;
  robot.controller.prediction.settings =
      AdaptivePredictionConfig{.horizon_ms = horizon_ms, .r_deg2 = r_deg2};
  return robot;
}

/// Everything else that the embedded form holds.
RobotConfig Unusual() {
  RobotConfig robot;
  robot.glove = PlainGlove(kChannels);
  robot.hand = CoupledHand(kChannels);
  ControllerConfig& config = robot.controller;
  config.filters = {{AlphaBetaGammaConfig{.alpha = 0.3, .beta = 0.02, .gamma = 1e-4}}};
  config.filter_on = FilterOn::kAngle;
  config.filter_at = FilterAt::kEvent;
  config.coupling_compensation = false;
  config.motor = {.rounding = Rounding::kHysteresis, .speed_limit_rad_s = 1.5};
  config.untrusted = {.full_scale = false, .stuck_after_ms = 12.0, .jump_confirm_ms = 3.0};
  config.linearisation.kind = LinearisationKind::kTable;
  for (int i = kChannels - 1; i >= 0; --i) {  // named, in another order
    ChannelCurve& curve = config.linearisation.channels.emplace_back();
    curve.channel = robot.glove.channel_names[static_cast<std::size_t>(i)];
    curve.counts = {150.0, 333.0, 900.0};
    curve.angle_deg = {90.0, 50.0, 0.0};
    if (i % 2 == 0) curve.counts = {150.0, 900.0};
    if (i % 2 == 0) curve.angle_deg = {0.0, 90.0};
  }
  robot.joint_map.joints = {
      {.joint = "joint_3", .channels = {"joint_1", "joint_2"}, .weights = {0.4, 0.7}},
      {.joint = "joint_5", .channels = {}, .offset_deg = 20.0}};
  robot.timing = {.tick_rate_hz = 1000.0, .ticks_per_sample = 2, .event_period_ms = 6.0};
  return robot;
}

/// Gloves that are given up: the motors stay, without what the prediction was ahead; or they rest.
RobotConfig HoldsALostGlove() {
  RobotConfig robot = Adaptive();
  robot.controller.untrusted.lost_after_ms = 100.0;
  return robot;
}
RobotConfig RestsALostGlove() {
  RobotConfig robot = SettledKalman();
  robot.controller.untrusted.lost_after_ms = 40.5;
  robot.controller.untrusted.when_lost = WhenLost::kRest;
  robot.controller.filter_at = FilterAt::kEvent;
  return robot;
}

/// A glove whose glitches only the ends of its converters tell.
RobotConfig WithoutJumps() {
  RobotConfig robot = SettledKalman();
  robot.controller.untrusted.jump_share = 0.0;
  return robot;
}

/// A list of settings, a value for each channel; and one to which a list settles.
RobotConfig PerChannel() {
  RobotConfig robot = SettledKalman();
  std::vector<double> cutoffs_hz;
  for (int i = 0; i < kChannels; ++i) cutoffs_hz.push_back(1.0 + i);
  robot.controller.filters = {
      {.settings = OneEuroConfig{}, .per_channel = {{"min_cutoff_hz", cutoffs_hz}}}};
  std::vector<std::string> replaced;
  robot.controller = Settled(robot, replaced);
  return robot;
}

/// The same with test::ToMixedConverters().
RobotConfig MixedConverters() {
  RobotConfig robot = WithoutJumps();
  KalmanNoise noise = {.r = {}, .q = {}};
  robot.glove.min_counts.clear();
  robot.glove.full_scale_counts.clear();
  for (int i = 0; i < kChannels; ++i) {
    const double factor = test::MixedFactor(i);
    const double offset = test::MixedOffset(i);
    for (auto* counts : {&robot.glove.low_counts, &robot.glove.high_counts}) {
      double& value = (*counts)[static_cast<std::size_t>(i)];
      value = offset + factor * value;
    }
    const auto [least, most] = std::minmax({offset, offset + 1023.0 * factor});
    robot.glove.min_counts.push_back(least);
    robot.glove.full_scale_counts.push_back(most);
    noise.r.push_back(15.0 * factor * factor);
    noise.q.push_back(1e-4 * factor * factor);
  }
  robot.controller.filters = {{KalmanSteadyConfig{.noise = noise}}};
  return robot;
}

bool IsMixed(const RobotConfig& robot) { return robot.glove.min_counts.size() > 1; }
std::string ConverterFlag(const RobotConfig& robot) {
  return IsMixed(robot) ? " -DMIXED_CONVERTERS" : "";
}

using Commands = std::vector<std::vector<int>>;

/// No channel has a sample for so long, and the third has none for twice as long.
constexpr int kAbsentTicks = 600;

/// With `start_counts`, the motors are there, and samples are absent.
Commands CommandsOf(const RobotConfig& robot, int ticks,
                    const std::vector<std::int32_t>& start_counts = {}) {
  Controller controller(robot);
  if (!start_counts.empty()) controller.Reset(start_counts);
  test::EmbeddedGlove glove;
  std::vector<double> counts(kChannels);
  Commands commands;
  for (int tick = 0; tick < ticks; ++tick) {
    const bool fresh = tick % robot.timing.ticks_per_sample == 0;
    if (fresh) glove.Next(counts.data(), kChannels);
    if (fresh && IsMixed(robot)) test::ToMixedConverters(counts.data(), kChannels);
    if (!start_counts.empty() && tick < kAbsentTicks) std::ranges::fill(counts, kNaN);
    if (!start_counts.empty() && tick < 2 * kAbsentTicks) counts[2] = kNaN;
    const Command command = fresh ? controller.Step({.counts = counts}) : controller.Step();
    if (!command.event) continue;
    std::vector<int>& row = commands.emplace_back(std::vector<int>{tick});
    row.insert(row.end(), command.motor_counts.begin(), command.motor_counts.end());
  }
  return commands;
}

/// Firmware of a robot's settings, in a folder of its own.
class Firmware {
 public:
  explicit Firmware(const RobotConfig& robot) {
    std::ofstream(folder_.path() / "robot.h") << sim::RobotToEmbeddedHeader(robot, {});
  }
  /// What the program prints that `compiler` makes of it, and what it says as an error.
  test::ProgramResult Run(const std::string& compiler, const std::string& sources, int ticks,
                          const std::string& runner = "", const std::string& flags = "") {
    const std::string program = (folder_.path() / "firmware").string();
    const std::string command = fmt::format(
        "cd '{}' && {} {} {} -I. '-DROBOT_HEADER=\"{}/robot.h\"' -DTICKS={} "
        "tests/settings/embedded_program.cc {} -o {} && {} {}",
        SourceDir(), compiler, kFlags, flags, folder_.path().string(), ticks, sources, program,
        runner, program);
    return test::RunProgram({"/bin/sh", "-c", command}, {});
  }

 private:
  test::TemporaryDirectory folder_;
};

Commands Parse(const std::string& text) {
  Commands commands;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    commands.emplace_back(std::istream_iterator<int>(words), std::istream_iterator<int>());
  }
  return commands;
}

/// Commands at most one count apart, and how many of 10,000 are.
int DifferencePerTenThousand(const Commands& commands, const Commands& expected) {
  EXPECT_EQ(commands.size(), expected.size());
  long differences = 0;
  long all = 0;
  int most = 0;
  for (std::size_t k = 0; k < std::min(commands.size(), expected.size()); ++k) {
    EXPECT_EQ(commands[k].size(), expected[k].size());
    EXPECT_EQ(commands[k][0], expected[k][0]) << "the tick";
    for (std::size_t m = 1; m < expected[k].size(); ++m, ++all) {
      const int difference = std::abs(commands[k][m] - expected[k][m]);
      most = std::max(most, difference);
      differences += difference != 0;
    }
  }
  EXPECT_LE(most, 1);
  return static_cast<int>(10'000 * differences / std::max(all, 1L));
}

struct NamedRobot {
  const char* name;
  RobotConfig (*make)();
};
void PrintTo(const NamedRobot& robot, std::ostream* out) { *out << robot.name; }

class EmbeddedController : public testing::TestWithParam<NamedRobot> {};

TEST_P(EmbeddedController, InFloatIsWithinOneCountOfTheOneInDouble) {
  const RobotConfig robot = GetParam().make();
  const test::ProgramResult result =
      Firmware(robot).Run(GAUNTLET_CXX, "", kTicks, "", ConverterFlag(robot));
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const Commands expected = CommandsOf(robot, kTicks);
  const auto moved = [&](const auto& row) { return row[4] != expected[0][4]; };
  EXPECT_GT(std::ranges::count_if(expected, moved), 1000) << "the motors move";
  const int per_ten_thousand = DifferencePerTenThousand(Parse(result.standard_output), expected);
  std::cout << per_ten_thousand << " of 10,000 commands are one count apart\n";
  EXPECT_LE(per_ten_thousand, 30);
}

TEST_P(EmbeddedController, StartsAndLosesSamplesAsTheOneInDouble) {
  const RobotConfig robot = GetParam().make();
  // Joints of CoupledHand() near 0.88 rad; every third motor where no joint can be.
  std::vector<std::int32_t> start(kChannels, 512 + 123);
  start[0] = 512 + 87;
  for (std::size_t i = 4; i < start.size(); i += 3) start[i] = 1000;
  const std::string flags = fmt::format("-DABSENT_TICKS={} '-DSTART_COUNTS={}'{}", kAbsentTicks,
                                        fmt::join(start, ","), ConverterFlag(robot));
  constexpr int kStartTicks = 3000;
  const test::ProgramResult result = Firmware(robot).Run(GAUNTLET_CXX, "", kStartTicks, "", flags);
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const Commands commands = Parse(result.standard_output);
  const Commands expected = CommandsOf(robot, kStartTicks, start);
  // A command with hysteresis that comes to rest one count beside stays there.
  const bool stays = robot.controller.motor.rounding == Rounding::kHysteresis;
  EXPECT_LE(DifferencePerTenThousand(commands, expected), stays ? 3000 : 30);
  const auto moved = [&](const auto& row) { return row[4] != expected[0][4]; };
  EXPECT_GT(std::ranges::count_if(expected, moved), 10) << "the motors move";
}

TEST(EmbeddedStart, LeavesTheMotorsWhereTheyAreUntilThereIsASample) {
  const std::vector<std::int32_t> start = HalfClosed(kChannels);
  const std::string flags =
      fmt::format("-DABSENT_TICKS={} '-DSTART_COUNTS={}'", kAbsentTicks, fmt::join(start, ","));
  const test::ProgramResult result =
      Firmware(SettledKalman()).Run(GAUNTLET_CXX, "", kAbsentTicks, "", flags);
  const Commands commands = Parse(result.standard_output);
  ASSERT_EQ(commands.size(), kAbsentTicks / 20) << result.standard_error;
  for (const std::vector<int>& row : commands) {
    EXPECT_THAT(std::vector<int>(row.begin() + 1, row.end()), testing::ElementsAreArray(start));
  }
}

TEST(ExportedHeaders, OfTwoControllersAreInOneProgram) {
  const test::TemporaryDirectory folder;
  const RobotConfig robot = SettledKalman();
  for (const char* name : {"first", "2nd tuned"}) {
    const sim::RobotOrigin origin = {.gauntlet_version = "0.1.0",
                                     .scenario = "door \u00e9",
                                     .controller = name,
                                     .model_hash = {}};
    std::ofstream(folder.path() / fmt::format("{}.h", name[0]))
        << sim::RobotToEmbeddedHeader(robot, origin);
  }
  const auto compile = [&](const std::string& text) {
    std::ofstream(folder.path() / "main.cc") << text;
    return test::RunProgram(
        {"/bin/sh", "-c",
         fmt::format("cd '{}' && {} -std=c++20 -fsyntax-only -Wall -Werror -I. "
                     "-I'{}' '{}/main.cc'",
                     SourceDir(), GAUNTLET_CXX, folder.path().string(), folder.path().string())},
        {});
  };
  test::ProgramResult result = compile(
      "#include \"f.h\"\n#include \"2.h\"\n"
      "robot::of_door_first::Controller a(robot::of_door_first::kSettings);\n"
      "robot::of_door_2nd_tuned::Controller b(robot::of_door_2nd_tuned::kSettings);\n");
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  // One needs no name.
  result = compile("#include \"f.h\"\nrobot::Controller a(robot::kSettings);\n");
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
}

TEST_P(EmbeddedController, OnACortexM4GivesTheSameCommands) {
  const bool there = std::system(
                         "echo '#include <cstdio>' | arm-none-eabi-gcc -x c++ -fsyntax-only - "
                         "2> /dev/null && command -v qemu-system-arm > /dev/null") == 0;
  if (!there) {
    GTEST_SKIP() << "not tried: it takes gcc-arm-none-eabi, libnewlib-arm-none-eabi, "
                    "libstdc++-arm-none-eabi-dev and qemu-system-arm";
  }
  constexpr int kArmTicks = 6000;
  Firmware firmware(GetParam().make());
  const test::ProgramResult here = firmware.Run(GAUNTLET_CXX, "", kArmTicks);
  const test::ProgramResult board = firmware.Run(
      "arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 "
      "-ffunction-sections -fdata-sections -Wl,--gc-sections --specs=rdimon.specs "
      "-T tests/settings/cortex_m4.ld",
      "tests/settings/cortex_m4.cc", kArmTicks,
      "timeout 60 qemu-system-arm -M mps2-an386 -nographic -semihosting -icount shift=0 -kernel");
  ASSERT_EQ(board.exit_code, 0) << board.standard_error;
  EXPECT_EQ(board.standard_output, here.standard_output);
  // An instruction is a nanosecond with -icount shift=0, and the board's clock has 25 MHz.
  std::istringstream numbers(board.standard_error);
  long all = 0, most = 0, bytes = 0, settings_bytes = 0;
  numbers >> all >> most >> bytes >> settings_bytes;
  std::cout << fmt::format("{} instructions per step, {} at most; {} bytes, {} of constants\n",
                           40 * all / kArmTicks, 40 * most, bytes, settings_bytes);
  EXPECT_GT(all, 0);
  EXPECT_LT(40 * most, 30'000) << "a millisecond has 100,000 at 100 MHz";
  const auto& prediction = GetParam().make().controller.prediction.settings;
  EXPECT_LT(bytes, std::holds_alternative<NoPredictionConfig>(prediction) ? 2048 : 24 * 1024);
}

INSTANTIATE_TEST_SUITE_P(Robots, EmbeddedController,
                         testing::Values(NamedRobot{"SettledKalman", SettledKalman},
                                         NamedRobot{"Adaptive", Adaptive},
                                         NamedRobot{"Unusual", Unusual},
                                         NamedRobot{"HoldsALostGlove", HoldsALostGlove},
                                         NamedRobot{"RestsALostGlove", RestsALostGlove},
                                         NamedRobot{"PerChannel", PerChannel},
                                         NamedRobot{"MixedConverters", MixedConverters}));

TEST(MixedConverters, GiveTheCommandsOfTheSameGloveWithOneConverter) {
  constexpr int kMixedTicks = 20'000;
  const std::vector<std::int32_t> start = HalfClosed(kChannels);
  const Commands expected = CommandsOf(WithoutJumps(), kMixedTicks);
  EXPECT_EQ(CommandsOf(MixedConverters(), kMixedTicks), expected);
  EXPECT_EQ(CommandsOf(MixedConverters(), kMixedTicks, start),
            CommandsOf(WithoutJumps(), kMixedTicks, start));
  // Glitches at the ends of the converters matter.
  RobotConfig trusting = WithoutJumps();
  trusting.controller.untrusted.full_scale = false;
  EXPECT_NE(CommandsOf(trusting, kMixedTicks), expected);

  const auto embedded = [](const RobotConfig& robot) {
    return Parse(Firmware(robot)
                     .Run(GAUNTLET_CXX, "", kMixedTicks, "", ConverterFlag(robot))
                     .standard_output);
  };
  const Commands mixed = embedded(MixedConverters());
  ASSERT_EQ(mixed.size(), expected.size());
  EXPECT_LE(DifferencePerTenThousand(mixed, embedded(WithoutJumps())), 30);
}

TEST(EmbeddedStart, GivesUpAGloveThatDies) {
  RobotConfig robot = RestsALostGlove();
  robot.controller.filter_at = FilterAt::kSample;
  const std::vector<std::int32_t> start = HalfClosed(kChannels);
  const std::string flags =
      fmt::format("-DABSENT_TICKS={} '-DSTART_COUNTS={}'", kAbsentTicks, fmt::join(start, ","));
  const Commands commands =
      Parse(Firmware(robot).Run(GAUNTLET_CXX, "", kAbsentTicks, "", flags).standard_output);
  EXPECT_LE(DifferencePerTenThousand(commands, CommandsOf(robot, kAbsentTicks, start)), 30);
  ASSERT_FALSE(commands.empty());
  EXPECT_NE(commands.back(), commands.front()) << "towards rest";
}

TEST(EmbeddedSettings, ReplaceAFilterByWhatItSettlesTo) {
  RobotConfig robot = SettledKalman();
  const KalmanNoise noise = {.r = {15.0}, .q = {1e-4}};
  std::vector<std::string> replaced;
  const auto settled = [&](const FilterSettings& filter) {
    replaced.clear();
    robot.controller.filters = {{filter}};
    robot.controller = Settled(robot, replaced);
    return std::string(robot.controller.filters[0].kind());
  };
  EXPECT_EQ(settled(KalmanConfig{.noise = noise}), "kalman_steady");
  EXPECT_THAT(replaced, testing::ElementsAre("filter[0] kalman by kalman_steady"));
  // The commands are the same once both have settled.
  RobotConfig kalman = robot;
  kalman.controller.filters = {{KalmanConfig{.noise = noise}}};
  Commands before = CommandsOf(kalman, 30'000);
  Commands after = CommandsOf(robot, 30'000);
  constexpr std::ptrdiff_t kEvents = 20'000 / 20;
  before.erase(before.begin(), before.begin() + kEvents);
  after.erase(after.begin(), after.begin() + kEvents);
  EXPECT_LE(DifferencePerTenThousand(after, before), 30);

  EXPECT_EQ(settled(OneEuroConfig{.min_cutoff_hz = 1.0, .beta = 0.1}), "exponential");
  EXPECT_NEAR(std::get<ExponentialConfig>(robot.controller.filters[0].settings).alpha, 0.0062439,
              1e-6);
  EXPECT_EQ(settled(KalmanAdaptiveConfig{.noise = noise}), "kalman_steady");
  EXPECT_EQ(settled(MedianConfig{}), "median") << "has no such form";
  EXPECT_TRUE(replaced.empty());
  EXPECT_EQ(settled(KalmanConfig{.noise = noise, .acceleration_window = 5}), "kalman");
}

TEST(EmbeddedSettings, RefuseWhatTheEmbeddedFormDoesNotHold) {
  const auto complaint = [](const auto& change) {
    RobotConfig robot = SettledKalman();
    change(robot);
    try {
      EmbeddedSettingsOf(robot);
    } catch (const SettingError& error) {
      return std::string(error.what());
    }
    return std::string("no complaint");
  };
  using Robot = RobotConfig&;
  EXPECT_EQ(complaint([](Robot) {}), "no complaint");
  EXPECT_EQ(
      complaint([](Robot r) { r.controller.filters = {{KalmanConfig{}}}; }),
      "controller.filter[0]: is kalman, must be kalman_steady, to which it settles (--settle), in "
      "the embedded form");
  EXPECT_EQ(complaint([](Robot r) { r.controller.filters = {{MedianConfig{}}}; }),
            "controller.filter[0]: is median, must be none, exponential, alpha_beta, "
            "alpha_beta_gamma or kalman_steady in the embedded form");
  EXPECT_EQ(complaint([](Robot r) { r.controller.filters.push_back({NoFilterConfig{}}); }),
            "controller.filter: has several filters, must be one at most in the embedded form");
  EXPECT_EQ(complaint([](Robot r) {
              r.controller.filters = {{.settings = ExponentialConfig{}, .channels = {"1"}}};
            }),
            "controller.filter[0].channels: is given, must be absent in the embedded form");
  EXPECT_EQ(complaint([](Robot r) {
              r.controller.filters = {{KalmanSteadyConfig{.start = Start::kZero}}};
            }),
            "controller.filter[0].start: is zero, must be first in the embedded form");
  EXPECT_EQ(complaint([](Robot r) { r.controller.prediction.settings = LinearPredictionConfig{}; }),
            "controller.prediction: is linear, must be none or adaptive in the embedded form");
  EXPECT_EQ(complaint([](Robot r) { r.controller.motor.rounding = Rounding::kNoiseShaping; }),
            "controller.motor.rounding: is noise_shaping, must be nearest or hysteresis in the "
            "embedded form");
  EXPECT_EQ(complaint([](Robot r) {
              r.hand.joint_sensors = true;
              r.controller.joint_loop.kind = JointLoopKind::kPi;
            }),
            "controller.joint_loop.kind: is pi, must be none in the embedded form");
  EXPECT_EQ(complaint([](Robot r) {
              r.controller.model_predictive.kind = ModelPredictiveKind::kSecondOrder;
            }),
            "controller.model_predictive.kind: is second_order, must be none in the embedded form");
  EXPECT_EQ(
      complaint([](Robot r) { r.hand.max_counts[3] = (1 << 24) + 1; }),
      "transmission.max_counts: motor motor_3: is 16777217, must be from -16777216 to 16777216 "
      "in the embedded form");
  EXPECT_THAT(
      complaint([](Robot r) { r.hand.min_counts[0] = -2147483647 - 1; }),
      testing::HasSubstr("transmission.min_counts: motor motor_0: is -2147483648, must be"));
  EXPECT_EQ(complaint([](Robot r) { r.hand.max_counts[3] = 1 << 24; }), "no complaint");
  EXPECT_EQ(
      complaint([](Robot r) { r.glove.full_scale_counts = {16777217.0}; }),
      "calibration.full_scale_counts: channel joint_0: is 16777217, must be from -16777216 to "
      "16777216 in the embedded form");
  EXPECT_EQ(complaint([](Robot r) {
              r.glove.min_counts.assign(kChannels, -16777216.0);
              r.glove.min_counts[7] = -16777217.0;
            }),
            "calibration.min_counts: channel joint_7: is -16777217, must be from -16777216 to "
            "16777216 in the embedded form");
  EXPECT_EQ(complaint([](Robot r) { r.glove.min_counts = {-16777216.0}; }), "no complaint");
  EXPECT_EQ(complaint([](Robot r) { r.timing.event_period_ms = 2.5; }),
            "timing.event_period_ms: is 2.5 ticks, must be a whole number in the embedded form "
            "(export: --tick-rate-hz)");
  EXPECT_EQ(complaint([](Robot r) {
              r.controller.linearisation.kind = LinearisationKind::kPolynomial;
              for (int i = 0; i < kChannels; ++i) {
                r.controller.linearisation.channels.emplace_back().coefficients_deg = {45.0, 45.0};
              }
            }),
            "controller.linearisation.kind: is polynomial, must be glove or table in the embedded "
            "form");
  EXPECT_THAT(complaint([](Robot r) { r.glove.high_counts[2] = 201.0; }),
              testing::HasSubstr("channel joint_2: the two poses"));
}

}  // namespace
}  // namespace gauntlet::controller
