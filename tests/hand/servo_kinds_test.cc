#include <gmock/gmock.h>

#include <set>

#include "sim/hand/servo_input.h"
#include "tests/hand/servo_response.h"

namespace gauntlet::sim::testing {
namespace {

using ::testing::ElementsAre;

const controller::Timing kTiming;  // ticks of 1 ms

/// What a servo holds at each of so many ticks, told 1 from the tick `told` on.
std::vector<double> Held(ServoInput& input, int told, int ticks) {
  std::vector<double> held;
  for (int tick = 0; tick < ticks; ++tick) {
    held.push_back(input.Step(tick >= told ? 1.0 : 0.0, tick >= told));
  }
  return held;
}

/// The first tick at which it holds the command, told at once.
int WaitOf(ServoInput& input, int told) {
  const std::vector<double> held = Held(input, told, 200);
  return static_cast<int>(std::ranges::find(held, 1.0) - held.begin()) - told;
}

TEST(ServoInput, FramesInStepBeginWithTheFirstCommand) {
  ServoInput input({.frame_ms = 20.0}, kTiming, 3);
  for (int told : {0, 7, 33}) {
    input.Reset(0.0);
    EXPECT_EQ(WaitOf(input, told), 0);
  }
}

TEST(ServoInput, TheDeadTimeIsThatLong) {
  for (int dead_ms : {0, 1, 24}) {
    ServoInput input({.frame_ms = 0.0, .dead_time_ms = 1.0 * dead_ms}, kTiming, 0);
    EXPECT_EQ(WaitOf(input, 5), dead_ms);
  }
}

TEST(ServoInput, ACommandThatIsReplacedWithinItsFrameIsNeverSeen) {
  ServoInput input({.frame_ms = 4.0}, kTiming, 0);
  const std::vector<double> told = {1, 2, 3, 4, 5, 6};
  std::vector<double> held;
  for (double command : told) held.push_back(input.Step(command, true));
  EXPECT_THAT(held, ElementsAre(1, 1, 1, 1, 5, 5));
}

// Frames that run free make a command wait for half a frame on the average, whenever it comes;
// motors differ, runs do not.
TEST(ServoInput, FreeRunningFramesMakeCommandsWaitForHalfAFrame) {
  std::set<int> waits;
  double sum = 0.0;
  for (int motor = 0; motor < 18; ++motor) {
    ServoInput input({.frame_ms = 20.0, .free_running = true}, kTiming, motor);
    ServoInput again({.frame_ms = 20.0, .free_running = true}, kTiming, motor);
    for (int told = 40; told < 60; ++told) {
      input.Reset(0.0);
      again.Reset(0.0);
      const int wait = WaitOf(input, told);
      ASSERT_EQ(WaitOf(again, told), wait);
      ASSERT_GE(wait, 0);
      ASSERT_LT(wait, 20);
      sum += wait;
      if (told == 40) waits.insert(wait);
    }
  }
  EXPECT_NEAR(sum / (18 * 20), 9.5, 1e-9);
  EXPECT_GT(waits.size(), 8u);
}

TEST(ServoInput, TheSensorRoundsToItsStepsAndItsNoiseHasItsDeviation) {
  const double step_rad = 300.0 * kRadPerDeg / 1023.0;
  ServoInput coarse({.sensor_bits = 10}, kTiming, 0);
  for (double angle_rad : {-1.0, 0.0, 0.3, 0.777}) {
    const double reading = (angle_rad + coarse.SensorError(angle_rad)) / step_rad;
    EXPECT_NEAR(reading, std::round(reading), 1e-9);
    EXPECT_NEAR(reading, angle_rad / step_rad, 0.5 + 1e-9);
  }
  ServoInput exact({}, kTiming, 0);
  EXPECT_EQ(exact.SensorError(0.777), 0.0);

  ServoInput noisy({.sensor_noise_deg = 0.2}, kTiming, 0);
  double squares = 0.0;
  for (int i = 0; i < 10000; ++i) squares += std::pow(noisy.SensorError(0.5) * kDegPerRad, 2);
  EXPECT_NEAR(std::sqrt(squares / 10000), 0.2, 0.006);
}

// Within 10 ms and 15 % of what others measured of such servos.
TEST(ServoKinds, MoveAsLateAndAsLongAsWasMeasured) {
  for (const PublishedFigure& figure : PublishedFigures()) {
    const auto kind = std::ranges::find(ServoKinds(), figure.kind, &ServoKind::name);
    ASSERT_NE(kind, ServoKinds().end()) << figure.kind;
    const double simulated_ms = figure.Simulated(kind->defaults);
    EXPECT_NEAR(simulated_ms, figure.published_ms, std::min(10.0, 0.15 * figure.published_ms))
        << figure.kind << ", " << figure.what << ", " << figure.source;
  }
}

// Each kind stops where it is told, but for its dead band, its steps and its friction: what of the
// stall torque friction holds, it holds at that share of the error that calls for the stall torque.
// So it does where the step begins.
TEST(ServoKinds, StopWithinTheirDeadBandStepsAndFriction) {
  for (const ServoKind& kind : ServoKinds()) {
    const ServoNumbers& numbers = kind.defaults.numbers();
    const double step_deg = numbers.travel_deg / ((1 << numbers.resolution_bits) - 1);
    const double read_deg =
        numbers.sensor_bits == 0 ? 0.0 : numbers.travel_deg / ((1 << numbers.sensor_bits) - 1);
    const double friction = numbers.friction_scale * 0.008 / 0.45;
    const double allowed_deg = numbers.dead_band_deg + step_deg + read_deg +
                               3.0 * numbers.sensor_noise_deg +
                               friction * numbers.full_torque_error_deg;
    const StepResponse response = MeasureStep(kind.defaults, 30.0);
    EXPECT_LT(response.error_deg, 2.0 * allowed_deg + 1e-3) << kind.name;
    EXPECT_LT(response.overshoot_deg, 6.5) << kind.name;
  }
}

TEST(ServoKinds, ElbowAndShoulderHaveTheirOwn) {
  for (const ServoKind& kind : ServoKinds()) {
    HandConfig config;
    config.servo = kind.defaults;
    config.arm_servo = std::prev(ServoKinds().end())->defaults;
    const auto model = MakeModel(config);
    for (const Drive& drive : model->drives()) {
      const bool arm = drive.name == "elbow_flexion" || drive.name == "shoulder_flexion";
      const ServoNumbers& expected = (arm ? config.arm_servo : config.servo).numbers();
      EXPECT_EQ(drive.numbers.no_load_speed_deg_s, expected.no_load_speed_deg_s) << drive.name;
      EXPECT_EQ(drive.numbers.resolution_bits, expected.resolution_bits) << drive.name;
    }
  }
}

// Rotors as published: XL330 2.0e-3, XL320 1.1e-3, Aero hand 1.6e-3 kg m2.
TEST(ServoKinds, RotorsOfMeasuredServosAreAsHeavyAsPublishedOnes) {
  for (const char* name : {"rc_analog", "bus", "dynamixel"}) {
    HandConfig config;
    config.servo = std::ranges::find(ServoKinds(), name, &ServoKind::name)->defaults;
    const auto model = MakeModel(config);
    const Drive& finger = model->drives()[ChannelIndex("index_mcp")];
    EXPECT_GT(finger.spool.inertia_kg_m2, 1.1e-3) << name;
    EXPECT_LT(finger.spool.inertia_kg_m2, 3.0e-3) << name;
  }
}

/// The largest spread of joints over 4 s of a slow sine of all channels, in frames of 20 ms, after
/// so many ticks in which nothing was told.
std::vector<double> AnglesAfterWaiting(const HandConfig& config, int ticks) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  std::vector<double> angle = HomePosture(map);
  hand.Reset(angle);
  StepTimes(hand, ticks);
  for (int sample = 0; sample < 400; ++sample) {
    if (sample % 20 == 0) {
      for (double& value : angle) value += 0.01;
      hand.SetCommand(CountsFor(map, angle));
    }
    hand.Step();
  }
  return JointAngles(hand);
}

// In step with the link it does not matter when the first command comes; with free frames it does.
TEST(ServoKinds, FreeFramesAreNotInStepWithTheLink) {
  const HandConfig in_step = StiffServos();
  HandConfig free = StiffServos();
  free.servo.numbers().free_running = true;
  const auto moved = [](const HandConfig& config) {
    const std::vector<double> now = AnglesAfterWaiting(config, 0);
    const std::vector<double> later = AnglesAfterWaiting(config, 7);
    double most = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      most = std::max(most, std::abs(now[i] - later[i]) * kDegPerRad);
    }
    return most;
  };
  EXPECT_GT(moved(free), 0.05 + moved(in_step));
}

}  // namespace
}  // namespace gauntlet::sim::testing
