#include "controller/controller.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "controller/filters/filter_registry.h"
#include "controller/number.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

constexpr int kChannels = 18;

ControllerConfig WithFilter(FilterSettings settings) {
  ControllerConfig config;
  config.filters = {{std::move(settings)}};
  return config;
}

constexpr Timing kEventPerSample = {.event_period_ms = 1.0};

Controller Make(const ControllerConfig& config, int channels = kChannels,
                const Timing& timing = kEventPerSample) {
  Controller controller(config, PlainGlove(channels), CoupledHand(channels), timing);
  controller.Reset(HalfClosed(channels));
  return controller;
}

/// Every value is taken, every command followed at once.
ControllerConfig Unlimited(ControllerConfig config) {
  config.untrusted.jump_share = 0.0;
  config.motor.speed_limit_rad_s = 0.0;
  return config;
}

TEST(Controller, MapsKnownPosesToKnownMotorCounts) {
  Controller controller = Make(Unlimited(WithFilter(NoFilterConfig{})), 2);
  const double counts[] = {400.0, 800.0};  // 0.5 and 1.5 rad
  const Command command = controller.Step({.counts = counts});
  // 512 + 100 * 0.5 and 512 + 100 (0.4 * 0.5 + 1.5)
  EXPECT_EQ(command.motor_counts[0], 562);
  EXPECT_EQ(command.motor_counts[1], 682);
  EXPECT_NEAR(controller.filtered_angle_rad()[1], 1.5, 1e-12);
}

TEST(Controller, FiltersCountsAndAnglesAlikeWhenBothAreLinear) {
  // Two-point linearisation is affine and the mean is linear, so the order must not matter.
  ControllerConfig on_counts = WithFilter(MovingAverageConfig{.window = 10});
  ControllerConfig on_angle = on_counts;
  on_angle.filter_on = FilterOn::kAngle;
  Controller first = Make(on_counts);
  Controller second = Make(on_angle);
  const TestSignal input = GloveCounts(500, kChannels);
  for (int k = 0; k < 500; ++k) {
    first.Step({.counts = RowOf(input, k)});
    second.Step({.counts = RowOf(input, k)});
    for (int i = 0; i < kChannels; ++i) {
      ASSERT_NEAR(first.filtered_angle_rad()[i], second.filtered_angle_rad()[i], 1e-12);
    }
  }
}

TEST(Controller, AppliesAChainInItsOrder) {
  ControllerConfig config = WithFilter(MovingAverageConfig{.window = 5});
  config.filters.push_back({KalmanConfig{}});
  Controller controller = Make(config);
  const auto mean = MakeFilter(config.filters[0], kChannels, 1000.0);
  const auto kalman = MakeFilter(config.filters[1], kChannels, 1000.0);
  const TestSignal input = GloveCounts(300, kChannels);
  std::vector<double> expected(kChannels);
  for (int k = 0; k < 300; ++k) {
    controller.Step({.counts = RowOf(input, k)});
    mean->Step(RowOf(input, k), expected);
    kalman->Step(expected, expected);
    for (int i = 0; i < kChannels; ++i) {
      ASSERT_NEAR(controller.filtered_angle_rad()[i], (expected[i] - 200.0) / 400.0, 1e-12);
    }
  }
}

TEST(Controller, StepsTheFilterOncePerEventWhenAsked) {
  ControllerConfig config = WithFilter(KalmanConfig{});
  config.filter_at = FilterAt::kEvent;
  Controller controller = Make(config, kChannels, Timing{});
  const auto kalman = MakeFilter(config.filters[0], kChannels, 50.0);
  const TestSignal input = GloveCounts(400, kChannels);
  std::vector<double> expected(kChannels);
  for (int k = 0; k < 400; ++k) {
    controller.Step({.counts = RowOf(input, k)});
    if (k % 20 == 0) kalman->Step(RowOf(input, k), expected);
    for (int i = 0; i < kChannels; ++i) {
      ASSERT_NEAR(controller.filtered_angle_rad()[i], (expected[i] - 200.0) / 400.0, 1e-12);
    }
  }
}

TEST(Controller, ChangesTheCommandOnlyAtEvents) {
  ControllerConfig config = WithFilter(NoFilterConfig{});
  Controller controller = Make(config, kChannels, Timing{});
  const TestSignal input = GloveCounts(400, kChannels);
  std::vector<std::int32_t> held(kChannels);
  int changes = 0;
  for (int k = 0; k < 400; ++k) {
    const auto counts = controller.Step({.counts = RowOf(input, k)}).motor_counts;
    if (k % 20 == 0) {
      changes += !std::equal(counts.begin(), counts.end(), held.begin());
      held.assign(counts.begin(), counts.end());
    }
    ASSERT_THAT(counts, ElementsAreArray(held)) << k;
  }
  EXPECT_EQ(changes, 20);
}

TEST(Controller, HoldsTheLastGoodValueOfAnUntrustedChannel) {
  Controller controller = Make(WithFilter(NoFilterConfig{}));
  std::vector<double> counts(kChannels, 500.0);
  controller.Step({.counts = counts});
  const double good = controller.filtered_angle_rad()[3];
  const double bad[] = {kNaN,
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(),
                        -1.0,
                        1024.0,
                        1e300};
  for (const double value : bad) {
    counts[3] = value;
    controller.Step({.counts = counts});
    EXPECT_EQ(controller.filtered_angle_rad()[3], good) << value;
  }
  EXPECT_EQ(controller.untrusted_samples()[3], 6);
  EXPECT_EQ(controller.untrusted_samples()[2], 0);
  counts[3] = 600.0;
  controller.Step({.counts = counts});
  EXPECT_NEAR(controller.filtered_angle_rad()[3], 1.0, 1e-12);
}

TEST(Controller, HoldsTheReferenceBeforeTheFirstGoodValueAndThenStartsThere) {
  TendonTransmission hand = CoupledHand(kChannels);
  hand.reference_angle_rad.assign(kChannels, 0.3);
  Controller controller(WithFilter(KalmanConfig{}), PlainGlove(kChannels), hand, kEventPerSample);
  std::vector<double> counts(kChannels, 500.0);
  counts[5] = kNaN;
  for (int k = 0; k < 10; ++k) controller.Step({.counts = counts});
  EXPECT_NEAR(controller.filtered_angle_rad()[5], 0.3, 1e-12);
  EXPECT_EQ(controller.untrusted_samples()[5], 10);
  counts[5] = 560.0;
  controller.Step({.counts = counts});
  EXPECT_NEAR(controller.filtered_angle_rad()[5], 0.9, 1e-12);
}

TEST(Controller, SurvivesAMissingOrShortFrame) {
  Controller controller = Make(WithFilter(KalmanConfig{}));
  const std::vector<double> counts(kChannels, 500.0);
  controller.Step({.counts = counts});
  controller.Step({.counts = {}});
  controller.Step({.counts = {counts.data(), 4}});
  EXPECT_EQ(controller.untrusted_samples()[0], 1);
  EXPECT_EQ(controller.untrusted_samples()[17], 2);
  for (const double angle : controller.filtered_angle_rad()) EXPECT_NEAR(angle, 0.75, 1e-12);
}

TEST(Controller, ResetGivesTheStateAfterConstruction) {
  ControllerConfig config = WithFilter(KalmanConfig{});
  Controller used = Make(config, kChannels, Timing{});
  const TestSignal input = GloveCounts(333, kChannels);
  for (int k = 0; k < 333; ++k) used.Step({.counts = RowOf(input, k)});
  used.Reset(HalfClosed(kChannels));
  Controller fresh = Make(config, kChannels, Timing{});
  for (int k = 0; k < 333; ++k) {
    const auto expected = fresh.Step({.counts = RowOf(input, k)}).motor_counts;
    ASSERT_THAT(used.Step({.counts = RowOf(input, k)}).motor_counts, ElementsAreArray(expected));
  }
}

/// A curve per channel that is not a straight line.
LinearisationConfig Curves(LinearisationKind kind) {
  LinearisationConfig config{.kind = kind, .channels = {}};
  for (int i = 0; i < kChannels; ++i) {
    ChannelCurve curve;
    curve.counts = {100.0, 500.0, 900.0};
    curve.angle_deg = {0.0, 50.0, 80.0};
    curve.coefficients_deg = {45.0, 45.0, 10.0, 5.0};
    config.channels.push_back(curve);
  }
  return config;
}

TEST(Controller, DoesNotAllocateInStepWhateverItIsMadeOf) {
  TestSignal input = GloveCounts(200, kChannels);
  input(20, 3) = kNaN;
  for (const LinearisationKind linearisation :
       {LinearisationKind::kGlove, LinearisationKind::kTable, LinearisationKind::kPolynomial}) {
    for (const PredictionKind& prediction : PredictionKinds()) {
      if (prediction.name == "fitted_to_others") continue;  // has no weights yet
      for (const Rounding rounding :
           {Rounding::kNearest, Rounding::kHysteresis, Rounding::kNoiseShaping}) {
        ControllerConfig config = WithFilter(HampelConfig{});
        config.filters.push_back({KalmanConfig{}});
        config.linearisation = Curves(linearisation);
        config.prediction = prediction.defaults;
        config.motor.rounding = rounding;
        Controller controller = Make(config);
        const long before = AllocationCount();
        for (int k = 0; k < 200; ++k) controller.Step({.counts = RowOf(input, k), .number = k + 1});
        controller.SetChannelActive(2, false);
        controller.Reset();
        EXPECT_EQ(AllocationCount(), before);
      }
    }
  }
}

/// A fault of one channel, or of whole frames, from sample 400 to 800.
struct Fault {
  const char* name;
  Untrusted kind;
  std::function<double(double)> value;               // of the channel, while the fault lasts
  std::function<std::int64_t(std::int64_t)> number;  // of the frame, while the fault lasts
};

std::vector<Fault> Faults() {
  const auto same_number = [](std::int64_t k) { return k; };
  const auto of_value = [&](const char* name, Untrusted kind, std::function<double(double)> value) {
    return Fault{name, kind, std::move(value), same_number};
  };
  const auto of_frame = [](const char* name, std::function<std::int64_t(std::int64_t)> number) {
    return Fault{name, Untrusted::kStale, [](double z) { return z; }, std::move(number)};
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {of_value("NotANumber", Untrusted::kMissing, [](double) { return kNaN; }),
          of_value("Infinite", Untrusted::kInfinite, [](double) { return -kInfinity; }),
          of_value("OutOfRange", Untrusted::kOutOfRange, [](double z) { return z + 5000.0; }),
          of_value("FullScale", Untrusted::kFullScale, [](double) { return 1023.0; }),
          of_value("Stuck", Untrusted::kStuck, [](double) { return 512.0; }),
          of_value("Jumping", Untrusted::kJumped,
                   [odd = false](double) mutable { return (odd = !odd) ? 1000.0 : 20.0; }),
          of_frame("Repeated", [](std::int64_t) { return 400; }),
          of_frame("Late", [](std::int64_t k) { return 801 - k; })};
}

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class ControllerFault : public testing::TestWithParam<Fault> {};

TEST_P(ControllerFault, IsCountedHeldAndRecoveredFromWithinTheSpeedLimit) {
  const Fault& fault = GetParam();
  const bool of_frames = fault.kind == Untrusted::kStale;
  constexpr int kChannel = 5;
  ControllerConfig config = WithFilter(NoFilterConfig{});
  config.untrusted.stuck_after_ms = 50.0;
  TendonTransmission hand = CoupledHand(kChannels);
  hand.min_counts.assign(kChannels, 500);
  hand.max_counts.assign(kChannels, 640);
  Controller controller(config, PlainGlove(kChannels), hand, kEventPerSample);
  Controller undisturbed(config, PlainGlove(kChannels), hand, kEventPerSample);
  controller.Reset(HalfClosed(kChannels));
  undisturbed.Reset(HalfClosed(kChannels));
  const TestSignal input = GloveCounts(1200, kChannels);
  std::vector<double> counts(kChannels);
  std::vector<std::int32_t> last = HalfClosed(kChannels);
  for (int k = 0; k < 1200; ++k) {
    const bool during = k >= 400 && k < 800;
    counts.assign(RowOf(input, k).begin(), RowOf(input, k).end());
    undisturbed.Step({.counts = counts, .number = k + 1});
    if (during) counts[kChannel] = fault.value(counts[kChannel]);
    const auto motors =
        controller.Step({.counts = counts, .number = during ? fault.number(k + 1) : k + 1})
            .motor_counts;
    for (int i = 0; i < kChannels; ++i) {
      const auto at = static_cast<std::size_t>(i);
      ASSERT_TRUE(motors[at] >= 500 && motors[at] <= 640) << k;
      // 20 rad/s at 100 counts per rad and 1000 events per second: 2 counts and the rounding.
      ASSERT_LE(std::abs(motors[at] - last[at]), 3) << k;
      ASSERT_TRUE(std::isfinite(controller.target_angle_rad()[at]));
      if (of_frames || i == kChannel) continue;
      ASSERT_EQ(controller.target_angle_rad()[at], undisturbed.target_angle_rad()[at]) << k;
    }
    last.assign(motors.begin(), motors.end());
  }
  // It has recovered, and the right counter of the right channels tells how long it took.
  EXPECT_EQ(controller.target_angle_rad()[kChannel], undisturbed.target_angle_rad()[kChannel]);
  const std::int64_t least = fault.kind == Untrusted::kStuck ? 340 : 390;
  EXPECT_GE(controller.untrusted_samples(fault.kind)[kChannel], least);
  EXPECT_LE(controller.untrusted_samples()[kChannel], 420);
  EXPECT_EQ(controller.untrusted_samples(fault.kind)[kChannel + 1], of_frames ? 400 : 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ControllerFault, testing::ValuesIn(Faults()),
                         [](const auto& test) { return test.param.name; });

TEST(Controller, LooksAheadWhenAsked) {
  ControllerConfig config = WithFilter(NoFilterConfig{});
  config.prediction = {LinearPredictionConfig{.horizon_ms = {40.0}, .window_ms = 20.0}};
  Controller controller = Make(config);
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> counts(kChannels, 300.0 + 0.5 * k);
    controller.Step({.counts = counts});
  }
  // 0.5 counts per ms are 0.00125 rad per ms.
  EXPECT_NEAR(controller.target_angle_rad()[2], controller.filtered_angle_rad()[2] + 0.05, 1e-9);
}

TEST(Controller, HoldsAChannelThatIsSwitchedOffWhileTheOthersDoNotNotice) {
  const ControllerConfig config = WithFilter(KalmanConfig{});
  Controller controller = Make(config);
  Controller undisturbed = Make(config);
  const TestSignal input = GloveCounts(900, kChannels);
  constexpr int kChannel = 6;
  std::int32_t largest_step = 0;
  std::int32_t last = 0;
  for (int k = 0; k < 900; ++k) {
    if (k == 300) controller.SetChannelActive(kChannel, false);
    if (k == 600) controller.SetChannelActive(kChannel, true);
    const double held = controller.target_angle_rad()[kChannel];
    const auto counts = controller.Step({.counts = RowOf(input, k)}).motor_counts;
    undisturbed.Step({.counts = RowOf(input, k)});
    for (int i = 0; i < kChannels; ++i) {
      if (i == kChannel) continue;
      ASSERT_EQ(controller.target_angle_rad()[i], undisturbed.target_angle_rad()[i]);
    }
    if (k >= 300 && k < 600) {
      ASSERT_EQ(controller.target_angle_rad()[kChannel], held);
    }
    if (k > 0) largest_step = std::max(largest_step, std::abs(counts[kChannel] - last));
    last = counts[kChannel];
  }
  // 20 rad/s at 100 counts per rad and 1000 events per second: 2 counts and the rounding.
  EXPECT_LE(largest_step, 3);
}

TEST(Controller, LoadsOtherSettingsWithoutAChangedBitInTheOtherChannels) {
  KalmanConfig kalman;
  Controller controller = Make(WithFilter(kalman));
  Controller undisturbed = Make(WithFilter(kalman));
  const TestSignal input = GloveCounts(600, kChannels);
  constexpr int kChannel = 9;
  bool changed = false;
  for (int k = 0; k < 600; ++k) {
    if (k == 251) {
      kalman.noise.r[kChannel] = 5000.0;
      controller.Load(WithFilter(kalman));
    }
    controller.Step({.counts = RowOf(input, k)});
    undisturbed.Step({.counts = RowOf(input, k)});
    for (int i = 0; i < kChannels; ++i) {
      const double angle = controller.target_angle_rad()[i];
      const double expected = undisturbed.target_angle_rad()[i];
      if (i != kChannel) {
        ASSERT_EQ(angle, expected);
      } else {
        ASSERT_NEAR(angle, expected, 0.2);
        changed = changed || angle != expected;
      }
    }
  }
  EXPECT_TRUE(changed);
}

TEST(Controller, DoesNotNoticeThatTheSameSettingsAreLoaded) {
  const TestSignal input = GloveCounts(300, kChannels);
  for (const FilterKind& kind : FilterKinds()) {
    ControllerConfig config = WithFilter(kind.defaults.settings);
    config.prediction = {KalmanPredictionConfig{}};
    config.motor.rounding = Rounding::kNoiseShaping;
    Controller controller = Make(config, kChannels, Timing{});
    Controller undisturbed = Make(config, kChannels, Timing{});
    for (int k = 0; k < 300; ++k) {
      if (k % 37 == 0) controller.Load(config);
      const auto expected = undisturbed.Step({.counts = RowOf(input, k)}).motor_counts;
      ASSERT_THAT(controller.Step({.counts = RowOf(input, k)}).motor_counts,
                  ElementsAreArray(expected))
          << kind.name;
      for (int i = 0; i < kChannels; ++i) {
        ASSERT_EQ(controller.target_angle_rad()[i], undisturbed.target_angle_rad()[i]) << kind.name;
      }
    }
  }
}

TEST(Controller, LoadsAnotherKindOfFilterWithinTheSpeedLimit) {
  ControllerConfig config = WithFilter(ExponentialConfig{.alpha = 0.001});  // far behind
  Controller controller = Make(config, kChannels, Timing{});
  std::vector<std::int32_t> last;
  for (int k = 0; k < 400; ++k) {
    if (k == 200) {
      ControllerConfig other = WithFilter(NoFilterConfig{});
      controller.Load(other);
    }
    const std::vector<double> counts(kChannels, k < 100 ? 250.0 : 480.0);
    const auto now = controller.Step({.counts = counts}).motor_counts;
    for (std::size_t i = 0; k > 0 && i < now.size(); ++i) {
      ASSERT_LE(std::abs(now[i] - last[i]), 40 + 1);  // 20 rad/s in 20 ms at 100 counts per rad
    }
    last.assign(now.begin(), now.end());
  }
}

TEST(Controller, KeepsRunningWhenSettingsToLoadAreWrong) {
  Controller controller = Make(WithFilter(MovingAverageConfig{}));
  const TestSignal input = GloveCounts(20, kChannels);
  controller.Step({.counts = RowOf(input, 0)});
  EXPECT_THROW(controller.Load(WithFilter(MovingAverageConfig{.window = 0})), SettingError);
  controller.Step({.counts = RowOf(input, 1)});
  EXPECT_NEAR(controller.filtered_angle_rad()[0],
              (0.5 * (input(0, 0) + input(1, 0)) - 200.0) / 400.0, 1e-12);
}

/// Any numbers at all, in any order: the commands stay in range and the angles finite.
TEST(Controller, SurvivesAnythingThatAGloveCanSend) {
  TestNoise noise(77);
  for (const FilterKind& kind : FilterKinds()) {
    ControllerConfig config = WithFilter(kind.defaults.settings);
    config.prediction = {KalmanPredictionConfig{}};
    Controller controller = Make(config);
    std::vector<double> counts(kChannels);
    for (int k = 0; k < 2000; ++k) {
      for (double& value : counts) {
        const double what = noise.Uniform();
        value = what < 0.1   ? kNaN
                : what < 0.2 ? std::numeric_limits<double>::infinity()
                : what < 0.4 ? std::pow(10.0, 600.0 * (noise.Uniform() - 0.5))
                             : 1100.0 * noise.Uniform();
      }
      const std::size_t length = noise.Uniform() < 0.1 ? 7 : counts.size();
      const auto command = controller.Step({.counts = {counts.data(), length}}).motor_counts;
      for (const std::int32_t motor : command) {
        ASSERT_GE(motor, 0);
        ASSERT_LE(motor, 1023);
      }
      for (const double angle : controller.target_angle_rad()) ASSERT_TRUE(std::isfinite(angle));
    }
  }
}

TEST(Controller, NamesTheSettingThatIsWrong) {
  const auto problem_of = [](const ControllerConfig& config) -> std::string {
    try {
      Make(config, 3);
    } catch (const SettingError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem_of(WithFilter(MovingAverageConfig{.window = -1})),
              HasSubstr("filter[0].window: is -1"));
  EXPECT_THAT(problem_of(WithFilter(KalmanConfig{.noise = {.r = {1.0, 2.0}}})),
              HasSubstr("filter[0].r: has 2 values"));
  EXPECT_THAT(problem_of(WithFilter(KalmanConfig{})), HasSubstr("filter[0].r"));
  ControllerConfig on_angle = WithFilter(KalmanConfig{});
  on_angle.filter_on = FilterOn::kAngle;
  EXPECT_THROW(Make(on_angle), SettingError);  // the paper's R is in counts
}

TEST(Controller, NamesTheClockThatIsWrong) {
  try {
    Make(WithFilter(NoFilterConfig{}), 3, {.tick_rate_hz = 0.0});
    FAIL();
  } catch (const SettingError& error) {
    EXPECT_EQ(error.key(), "timing.tick_rate_hz");
  }
}

TEST(Controller, RefusesAGloveWhosePosesDoNotFit) {
  GloveCalibration nameless = PlainGlove(4);
  nameless.channel_names.pop_back();
  EXPECT_THROW(Controller(ControllerConfig{}, nameless, CoupledHand(4)), SettingError);
  GloveCalibration flat = PlainGlove(4);
  flat.high_counts[2] = flat.low_counts[2];
  EXPECT_THROW(Controller(ControllerConfig{}, flat, CoupledHand(4)), SettingError);
}

TEST(Controller, NamesTheConverterThatIsWrong) {
  const auto problem_of = [](const std::vector<double>& least, const std::vector<double>& most) {
    GloveCalibration glove = PlainGlove(3);
    glove.min_counts = least;
    glove.full_scale_counts = most;
    try {
      Controller(ControllerConfig{}, glove, CoupledHand(3));
    } catch (const SettingError& error) {
      return std::string(error.what());
    }
    return std::string("no complaint");
  };
  EXPECT_EQ(problem_of({-2048.0}, {2047.0}), "no complaint");
  EXPECT_EQ(problem_of({0.0, -2048.0, 0.0}, {1023.0, 2047.0, 4095.0}), "no complaint");
  EXPECT_EQ(
      problem_of({0.0}, {0.0}),
      "calibration.full_scale_counts: is 0 for channel joint_0, must be above its min_counts, "
      "0, and at most 1000000000");
  EXPECT_EQ(problem_of({0.0, 0.0, 1023.5}, {1023.0}),
            "calibration.full_scale_counts: is 1023 for channel joint_2, must be above its "
            "min_counts, 1023.5, and at most 1000000000");
  EXPECT_EQ(problem_of({0.0}, {1023.0, 4095.0}),
            "calibration.full_scale_counts: has 2 values, must have 1 for all channels or 3, one "
            "for each");
  EXPECT_THAT(problem_of({}, {1023.0}), HasSubstr("calibration.min_counts: has 0 values"));
  EXPECT_EQ(problem_of({kNaN}, {1023.0}),
            "calibration.min_counts: is nan, must be from -1000000000 to 1000000000");
  EXPECT_EQ(problem_of({0.0}, {1023.0, 1023.0, std::numeric_limits<double>::infinity()}),
            "calibration.full_scale_counts: is inf, must be from -1000000000 to 1000000000");
  EXPECT_EQ(problem_of({201.0}, {1023.0}),
            "calibration: channel joint_0: a pose is at 200 counts, must be within the converter's "
            "range, 201 to 1023");
  EXPECT_EQ(problem_of({0.0}, {1023.0, 799.0, 1023.0}),
            "calibration: channel joint_1: a pose is at 800 counts, must be within the converter's "
            "range, 0 to 799");
}

TEST(Controller, HoldsTheReferenceOfJointsThatNoChannelMeasures) {
  TendonTransmission hand = CoupledHand(4);
  hand.reference_angle_rad.assign(4, 0.6);
  Controller controller(Unlimited({}), PlainGlove(2), hand, kEventPerSample);
  controller.Step({.counts = std::vector<double>{400.0, 600.0}});
  EXPECT_EQ(controller.channel_count(), 2);
  EXPECT_EQ(controller.joint_count(), 4);
  EXPECT_THAT(controller.target_angle_rad(),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.5, 1.0, 0.6, 0.6}));
  // 0.4 of the joint before passes on to each spool: C d = [-0.1, 0.4 - 0.04, 0.16, 0].
  EXPECT_THAT(controller.Step().motor_counts, testing::ElementsAre(502, 548, 528, 512));
}

TEST(Controller, HasEventsBetweenTheSamplesOfASlowGlove) {
  // Samples every 3 ticks, events every 2.5: at ticks 0, 3, 5, 8, 10, 13, ..
  const ControllerConfig config = Unlimited(WithFilter(NoFilterConfig{}));
  Controller controller =
      Make(config, 1, {.tick_rate_hz = 1000.0, .ticks_per_sample = 3, .event_period_ms = 2.5});
  std::vector<int> events;
  std::vector<std::int32_t> sent;
  for (int tick = 0; tick < 14; ++tick) {
    const double counts = 200.0 + 40.0 * tick;
    const Command command =
        tick % 3 == 0 ? controller.Step({.counts = {&counts, 1}}) : controller.Step();
    if (!command.event) continue;
    events.push_back(tick);
    sent.push_back(command.motor_counts[0]);
  }
  EXPECT_THAT(events, testing::ElementsAre(0, 3, 5, 8, 10, 13));
  // Each frame tells of the newest sample: of ticks 0, 3, 3, 6, 9, 12, at 10 counts a tick.
  EXPECT_THAT(sent, testing::ElementsAre(512, 542, 542, 572, 602, 632));
}

}  // namespace
}  // namespace gauntlet::controller
