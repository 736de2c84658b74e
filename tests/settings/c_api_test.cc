// The controller as programs in C see it, from the text that gauntlet export writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/c_api/gauntlet_controller.h"
#include "controller/controller.h"
#include "sim/settings/robot_constants.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr int kSamples = 94'096;

RobotConfig Robot() {
  RobotConfig robot;
  robot.glove = PlainGlove(kChannels);
  robot.hand = CoupledHand(kChannels);
  robot.controller.filters = {{HampelConfig{}}, {KalmanConfig{.noise = {.r = {15.0}}}}};
  robot.controller.motor.rounding = Rounding::kHysteresis;
  robot.timing = {.tick_rate_hz = 1000.0, .ticks_per_sample = 2, .event_period_ms = 3.0};
  return robot;
}

using Handle = std::unique_ptr<gauntlet_controller, decltype(&gauntlet_controller_destroy)>;

Handle Create(const RobotConfig& robot) {
  const std::string text = sim::RobotToText(robot, {});
  std::array<char, 200> error = {'x'};
  Handle handle(gauntlet_controller_create(text.data(), text.size(), error.data(), error.size()),
                gauntlet_controller_destroy);
  EXPECT_TRUE(handle) << error.data();
  EXPECT_STREQ(error.data(), "");
  return handle;
}

TEST(CApi, GivesTheCommandsOfTheControllerCountForCount) {
  const Handle handle = Create(Robot());
  Controller controller(Robot());
  const std::vector<std::int32_t> start = HalfClosed(kChannels);
  controller.Reset(start);
  ASSERT_EQ(gauntlet_controller_reset(handle.get(), start.data(), start.size()), GAUNTLET_OK);
  EXPECT_EQ(gauntlet_controller_channel_count(handle.get()), kChannels);
  EXPECT_EQ(gauntlet_controller_motor_count(handle.get()), kChannels);
  EXPECT_EQ(gauntlet_controller_tick_rate_hz(handle.get()), 1000.0);
  EXPECT_EQ(gauntlet_controller_ticks_per_sample(handle.get()), 2);

  const TestSignal signal = GloveCounts(kSamples, kChannels);
  std::vector<std::int32_t> motors(kChannels, -1);
  long events = 0;
  long allocations = 0;
  for (int k = 0; k < kSamples; ++k) {
    const bool fresh = k % 2 == 0;
    const bool numbered = k > kSamples / 2;
    GloveSample sample{.counts = RowOf(signal, k)};
    if (numbered) sample.number = k - k % 7;  // some are late
    const Command expected = fresh ? controller.Step(sample) : controller.Step();
    const double* counts = fresh ? sample.counts.data() : nullptr;
    const std::size_t size = fresh ? sample.counts.size() : 0;
    const long before = AllocationCount();
    const gauntlet_result result =
        fresh && numbered
            ? gauntlet_controller_step_frame(handle.get(), *sample.number, counts, size,
                                             motors.data(), motors.size())
            : gauntlet_controller_step(handle.get(), counts, size, motors.data(), motors.size());
    allocations += AllocationCount() - before;
    ASSERT_EQ(result, expected.event ? GAUNTLET_EVENT : GAUNTLET_OK) << k;
    ASSERT_THAT(motors, testing::ElementsAreArray(expected.motor_counts)) << k;
    events += result == GAUNTLET_EVENT;
  }
  EXPECT_EQ(events, (kSamples + 2) / 3);
  EXPECT_EQ(allocations, 0);
}

TEST(CApi, TakesWhatJointSensorsSay) {
  RobotConfig robot = Robot();
  robot.hand.joint_sensors = true;
  robot.controller.joint_loop.kind = JointLoopKind::kPi;
  const Handle handle = Create(robot);
  Controller controller(robot);
  ASSERT_EQ(gauntlet_controller_joint_count(handle.get()), kChannels);
  const TestSignal signal = GloveCounts(2'000, kChannels);
  const std::vector<double> measured_rad(kChannels, 0.3);
  std::vector<std::int32_t> motors(kChannels);
  for (int k = 0; k < 2'000; ++k) {
    if (k % 10 == 0) {
      controller.TakeJointAngles(measured_rad);
      ASSERT_EQ(gauntlet_controller_take_joint_angles(handle.get(), measured_rad.data(), kChannels),
                GAUNTLET_OK);
    }
    const std::span<const double> counts = RowOf(signal, k);
    const Command expected = controller.Step({.counts = counts});
    gauntlet_controller_step(handle.get(), counts.data(), counts.size(), motors.data(), kChannels);
    ASSERT_THAT(motors, testing::ElementsAreArray(expected.motor_counts)) << k;
  }
  EXPECT_EQ(gauntlet_controller_take_joint_angles(handle.get(), measured_rad.data(), 3),
            GAUNTLET_WRONG_LENGTH);
  EXPECT_EQ(gauntlet_controller_take_joint_angles(handle.get(), nullptr, kChannels),
            GAUNTLET_NULL_POINTER);
}

TEST(CApi, WrongArgumentsAreRefusedAndChangeNothing) {
  const Handle handle = Create(Robot());
  const Handle other = Create(Robot());
  const std::vector<double> counts(kChannels, 400.0);
  std::vector<std::int32_t> motors(kChannels, 512);
  std::vector<std::int32_t> expected(kChannels, 512);
  const auto step = [&](const double* from, std::size_t size, std::int32_t* to, std::size_t room) {
    return gauntlet_controller_step(handle.get(), from, size, to, room);
  };
  for (int k = 0; k < 200; ++k) {
    EXPECT_EQ(step(counts.data(), kChannels - 1, motors.data(), kChannels), GAUNTLET_WRONG_LENGTH);
    EXPECT_EQ(step(counts.data(), 0, motors.data(), kChannels), GAUNTLET_WRONG_LENGTH);
    EXPECT_EQ(step(counts.data(), kChannels, motors.data(), kChannels + 1), GAUNTLET_WRONG_LENGTH);
    EXPECT_EQ(step(nullptr, 0, motors.data(), 0), GAUNTLET_WRONG_LENGTH);
    EXPECT_EQ(step(nullptr, kChannels, motors.data(), kChannels), GAUNTLET_NULL_POINTER);
    EXPECT_EQ(step(counts.data(), kChannels, nullptr, kChannels), GAUNTLET_NULL_POINTER);
    EXPECT_EQ(gauntlet_controller_reset(handle.get(), motors.data(), 3), GAUNTLET_WRONG_LENGTH);
    EXPECT_EQ(gauntlet_controller_reset(handle.get(), nullptr, 3), GAUNTLET_NULL_POINTER);
    const gauntlet_result result = step(counts.data(), kChannels, motors.data(), kChannels);
    EXPECT_EQ(
        gauntlet_controller_step(other.get(), counts.data(), kChannels, expected.data(), kChannels),
        result);
    ASSERT_EQ(motors, expected);
  }
  EXPECT_EQ(gauntlet_controller_reset(handle.get(), nullptr, 0), GAUNTLET_OK);
}

TEST(CApi, NoControllerIsHarmless) {
  std::int32_t motor = 7;
  EXPECT_EQ(gauntlet_controller_step(nullptr, nullptr, 0, &motor, 1), GAUNTLET_NULL_POINTER);
  EXPECT_EQ(gauntlet_controller_step_frame(nullptr, 1, nullptr, 0, &motor, 1),
            GAUNTLET_NULL_POINTER);
  EXPECT_EQ(gauntlet_controller_reset(nullptr, &motor, 1), GAUNTLET_NULL_POINTER);
  EXPECT_EQ(gauntlet_controller_channel_count(nullptr), 0U);
  EXPECT_EQ(gauntlet_controller_motor_count(nullptr), 0U);
  EXPECT_EQ(gauntlet_controller_tick_rate_hz(nullptr), 0.0);
  EXPECT_EQ(gauntlet_controller_ticks_per_sample(nullptr), 0);
  gauntlet_controller_destroy(nullptr);
  EXPECT_EQ(motor, 7);
}

TEST(CApi, TellsASickGloveFromAHealthyOne) {
  RobotConfig robot = Robot();
  robot.controller.untrusted.lost_after_ms = 50.0;
  robot.controller.model_predictive.kind = ModelPredictiveKind::kSecondOrder;
  robot.controller.prediction.settings = AdaptivePredictionConfig{};
  const Handle handle = Create(robot);
  Controller controller(robot);
  EXPECT_STREQ(gauntlet_controller_version(), GAUNTLET_VERSION);
  EXPECT_EQ(gauntlet_controller_event_period_ms(handle.get()), 3.0);
  EXPECT_STREQ(gauntlet_controller_channel_name(handle.get(), 17), "joint_17");
  EXPECT_STREQ(gauntlet_controller_joint_name(handle.get(), 3), "joint_3");
  EXPECT_STREQ(gauntlet_controller_motor_name(handle.get(), 0), "motor_0");
  EXPECT_EQ(gauntlet_controller_motor_name(handle.get(), kChannels), nullptr);
  const TestSignal signal = GloveCounts(400, kChannels);
  std::vector<std::int32_t> motors(kChannels);
  std::vector<std::int64_t> samples(kChannels);
  std::vector<double> values(kChannels);
  for (int k = 0; k < 1000; ++k) {
    if (k == 100) {
      controller.SetChannelActive(5, false);
      EXPECT_EQ(gauntlet_controller_set_channel_active(handle.get(), 5, 0), GAUNTLET_OK);
      EXPECT_EQ(gauntlet_controller_channel_active(handle.get(), 5), 0);
      EXPECT_EQ(gauntlet_controller_channel_active(handle.get(), 6), 1);
    }
    const bool fresh = k % 2 == 0 && k < 400;
    std::vector<double> counts(RowOf(signal, k % 400).begin(), RowOf(signal, k % 400).end());
    if (k > 150) counts[2] = 1e9;
    const Command command = fresh ? controller.Step({.counts = counts}) : controller.Step();
    ASSERT_GE(gauntlet_controller_step(handle.get(), fresh ? counts.data() : nullptr,
                                       fresh ? kChannels : 0, motors.data(), kChannels),
              0);
    ASSERT_THAT(motors, testing::ElementsAreArray(command.motor_counts)) << k;
    ASSERT_EQ(static_cast<int>(gauntlet_controller_glove_status(handle.get())),
              static_cast<int>(command.glove));
  }
  EXPECT_EQ(gauntlet_controller_glove_status(handle.get()), GAUNTLET_GLOVE_LOST);
  const auto samples_of = [&](gauntlet_untrusted reason) {
    EXPECT_EQ(
        gauntlet_controller_untrusted_samples(handle.get(), reason, samples.data(), kChannels),
        GAUNTLET_OK);
    return samples;
  };
  EXPECT_THAT(samples_of(GAUNTLET_UNTRUSTED_ALL),
              testing::ElementsAreArray(controller.untrusted_samples()));
  EXPECT_GT(samples_of(GAUNTLET_UNTRUSTED_OUT_OF_RANGE)[2], 100);
  EXPECT_EQ(samples_of(GAUNTLET_UNTRUSTED_OUT_OF_RANGE)[3], 0);
  EXPECT_GT(samples_of(GAUNTLET_UNTRUSTED_MISSING)[3], 290);
  EXPECT_EQ(gauntlet_controller_sample_age_ms(handle.get(), values.data(), kChannels), GAUNTLET_OK);
  EXPECT_EQ(values[3], 601.0);
  EXPECT_EQ(values[2], controller.sample_age_ms(2));
  EXPECT_EQ(gauntlet_controller_failed_plans(handle.get(), samples.data(), kChannels), GAUNTLET_OK);
  EXPECT_THAT(samples, testing::ElementsAreArray(controller.failed_plans()));
  const auto angles_of = [&](gauntlet_angle kind) {
    EXPECT_EQ(gauntlet_controller_angles(handle.get(), kind, values.data(), kChannels),
              GAUNTLET_OK);
    return values;
  };
  EXPECT_THAT(angles_of(GAUNTLET_ANGLE_LINEARISED),
              testing::ElementsAreArray(controller.linearised_angle_rad()));
  EXPECT_THAT(angles_of(GAUNTLET_ANGLE_FILTERED),
              testing::ElementsAreArray(controller.filtered_angle_rad()));
  EXPECT_THAT(angles_of(GAUNTLET_ANGLE_PREDICTED),
              testing::ElementsAreArray(controller.predicted_angle_rad()));
  EXPECT_THAT(angles_of(GAUNTLET_ANGLE_TARGET),
              testing::ElementsAreArray(controller.target_angle_rad()));

  EXPECT_EQ(gauntlet_controller_angles(handle.get(), GAUNTLET_ANGLE_TARGET, values.data(), 1),
            GAUNTLET_WRONG_LENGTH);
  EXPECT_EQ(gauntlet_controller_angles(handle.get(), GAUNTLET_ANGLE_TARGET, nullptr, kChannels),
            GAUNTLET_NULL_POINTER);
  EXPECT_EQ(gauntlet_controller_untrusted_samples(handle.get(), static_cast<gauntlet_untrusted>(7),
                                                  samples.data(), kChannels),
            GAUNTLET_OUT_OF_RANGE);
  EXPECT_EQ(gauntlet_controller_set_channel_active(handle.get(), kChannels, 1),
            GAUNTLET_OUT_OF_RANGE);
  EXPECT_EQ(gauntlet_controller_glove_status(nullptr), GAUNTLET_GLOVE_LOST);
  EXPECT_EQ(gauntlet_controller_channel_active(nullptr, 0), 0);
}

TEST(CApi, ReportsALoopOfAnotherRateAndLateSteps) {
  const Handle handle = Create(Robot());
  EXPECT_TRUE(std::isnan(gauntlet_controller_measured_tick_rate_hz(handle.get())));
  const double period_ms = 1e3 / gauntlet_controller_tick_rate_hz(handle.get());
  std::vector<std::int32_t> motors(kChannels);
  const auto step = [&](double elapsed_ms) {
    EXPECT_EQ(gauntlet_controller_take_elapsed_ms(handle.get(), elapsed_ms), GAUNTLET_OK);
    gauntlet_controller_step(handle.get(), nullptr, 0, motors.data(), kChannels);
    return gauntlet_controller_loop_status(handle.get());
  };
  EXPECT_EQ(step(period_ms), GAUNTLET_LOOP_IN_TIME);
  EXPECT_EQ(step(2.0 * period_ms), GAUNTLET_LOOP_OVERRUN);
  EXPECT_EQ(gauntlet_controller_overruns(handle.get()), 1);
  for (int k = 0; k < 254; ++k) step(1.08 * period_ms);
  EXPECT_EQ(gauntlet_controller_loop_status(handle.get()), GAUNTLET_LOOP_WRONG_RATE);
  EXPECT_NEAR(gauntlet_controller_measured_tick_rate_hz(handle.get()) * period_ms, 1e3 / 1.08, 5.0);
  EXPECT_EQ(gauntlet_controller_take_elapsed_ms(nullptr, 1.0), GAUNTLET_NULL_POINTER);
  EXPECT_EQ(gauntlet_controller_loop_status(nullptr), GAUNTLET_LOOP_IN_TIME);
  EXPECT_EQ(gauntlet_controller_overruns(nullptr), 0);
}

TEST(CApi, ListsAllThatIsWrongOrDoubtful) {
  const auto validate = [](const std::string& text, std::size_t room = 2000) {
    std::string lines(room, 'x');
    const std::size_t count =
        gauntlet_controller_validate(text.data(), text.size(), lines.data(), lines.size());
    lines.resize(lines.find('\0'));
    return std::pair(count, lines);
  };
  RobotConfig robot = Robot();
  EXPECT_EQ(validate(sim::RobotToText(robot, {})), std::pair(std::size_t{0}, std::string()));
  robot.glove.high_angle_rad[1] = 6.0;
  robot.glove.channel_names[3] = robot.glove.channel_names[2];
  robot.joint_map.joints = {{.joint = "no_joint", .channels = {}}};
  const auto [count, lines] = validate(sim::RobotToText(robot, {}));
  EXPECT_EQ(count, 2u) << lines;  // poses need a joint map
  EXPECT_THAT(lines, testing::HasSubstr("appears twice\n"));
  EXPECT_THAT(lines, testing::HasSubstr("no_joint"));
  robot = Robot();
  robot.glove.high_angle_rad[1] = 6.0;
  const std::string doubtful = sim::RobotToText(robot, {});
  EXPECT_THAT(validate(doubtful).second, testing::StartsWith("warning: line "));
  EXPECT_EQ(validate(doubtful, 20), std::pair(std::size_t{1}, std::string())) << "no room";
  EXPECT_EQ(gauntlet_controller_validate(doubtful.data(), doubtful.size(), nullptr, 0), 1u);
  EXPECT_EQ(validate("nonsense").first, 1u);
}

TEST(CApi, SwapsOtherSettingsIn) {
  const Handle handle = Create(Robot());
  Controller controller(Robot());
  RobotConfig other = Robot();
  other.controller.filters = {{ButterworthConfig{}}};
  const auto prepare = [&](const gauntlet_controller* from, const RobotConfig& robot,
                           std::string& problem) {
    const std::string text = sim::RobotToText(robot, {});
    std::array<char, 200> error = {'x'};
    Handle made(
        gauntlet_controller_prepare(from, text.data(), text.size(), error.data(), error.size()),
        gauntlet_controller_destroy);
    problem = error.data();
    return made;
  };
  std::string problem;
  const Handle next = prepare(handle.get(), other, problem);
  ASSERT_TRUE(next) << problem;
  EXPECT_EQ(problem, "");
  const TestSignal signal = GloveCounts(1000, kChannels);
  std::vector<std::int32_t> motors(kChannels);
  for (int k = 0; k < 1000; ++k) {
    if (k == 500) {
      controller.Load(other.controller);
      const long before = AllocationCount();
      EXPECT_EQ(gauntlet_controller_swap(handle.get(), next.get()), GAUNTLET_OK);
      EXPECT_EQ(AllocationCount(), before);
    }
    const std::span<const double> counts = RowOf(signal, k);
    const Command command = controller.Step({.counts = counts});
    gauntlet_controller_step(handle.get(), counts.data(), counts.size(), motors.data(), kChannels);
    ASSERT_THAT(motors, testing::ElementsAreArray(command.motor_counts)) << k;
  }
  EXPECT_EQ(gauntlet_controller_swap(handle.get(), handle.get()), GAUNTLET_NOT_PREPARED);
  EXPECT_EQ(gauntlet_controller_swap(handle.get(), Create(Robot()).get()), GAUNTLET_NOT_PREPARED);
  EXPECT_EQ(gauntlet_controller_swap(handle.get(), nullptr), GAUNTLET_NULL_POINTER);
  other.hand.center_counts[4] = 500;
  EXPECT_FALSE(prepare(handle.get(), other, problem));
  EXPECT_EQ(problem, "settings: have another glove, hand, joint_map or timing than the controller");
  other = Robot();
  other.glove.min_counts = {-1024.0};
  EXPECT_FALSE(prepare(handle.get(), other, problem));
  EXPECT_EQ(problem, "settings: have another glove, hand, joint_map or timing than the controller");
  other.glove.min_counts.assign(kChannels, 0.0);
  EXPECT_TRUE(prepare(handle.get(), other, problem)) << "the same range, as a list: " << problem;
  EXPECT_FALSE(prepare(nullptr, Robot(), problem));
  EXPECT_EQ(problem, "controller: is missing");
}

TEST(CApi, BadSettingsGiveNoControllerAndOneLine) {
  const auto complaint = [](const char* text, std::size_t length) {
    std::array<char, 200> error = {'x'};
    EXPECT_EQ(gauntlet_controller_create(text, length, error.data(), error.size()), nullptr);
    return std::string(error.data());
  };
  const auto of = [&](const std::string& text) { return complaint(text.data(), text.size()); };
  EXPECT_EQ(complaint(nullptr, 9), "settings: are missing");
  EXPECT_THAT(of(""), testing::StartsWith("controller: is missing"));
  EXPECT_EQ(of("controller"), "line 1: must be a key, \"=\" and its values");
  RobotConfig robot = Robot();
  robot.glove.high_counts[3] = 201.0;
  EXPECT_THAT(of(sim::RobotToText(robot, {})),
              testing::HasSubstr("channel joint_3: the two poses"));
  robot = Robot();
  robot.glove.channel_names[3] = robot.glove.channel_names[4] = "two\nlines";
  EXPECT_THAT(of(sim::RobotToText(robot, {})), testing::HasSubstr("two lines appears twice"));

  std::array<char, 8> error = {};
  EXPECT_EQ(gauntlet_controller_create("controller", 10, error.data(), 7), nullptr);
  EXPECT_EQ(std::string(error.data()), "line 1");
  EXPECT_EQ(error[7], '\0');
  EXPECT_EQ(gauntlet_controller_create("controller", 10, error.data(), 0), nullptr);
  EXPECT_EQ(gauntlet_controller_create("controller", 10, nullptr, 99), nullptr);
}

}  // namespace
}  // namespace gauntlet::controller
