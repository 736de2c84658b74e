#include "controller/model_predictive/model_predictive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "controller/controller.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"
#include "tests/support/gram_schmidt.h"

namespace gauntlet::controller {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

/// Without limits but the joint's range of -100 to 100 rad.
ModelPredictiveConfig Unlimited() {
  return {.kind = ModelPredictiveKind::kSecondOrder, .speed_limit_deg_s = 0.0};
}

TendonTransmission WideHand(int joints) {
  TendonTransmission hand = CoupledHand(joints);
  hand.joint_min_rad.assign(hand.joint_min_rad.size(), -100.0);
  hand.joint_max_rad.assign(hand.joint_max_rad.size(), 100.0);
  return hand;
}

/// A servo of its own, with a delay line for its dead time, stepped by Runge and Kutta.
class Servo {
 public:
  Servo(double dead_time_s, double lag_s, double frequency_hz, double event_s)
      : lag_(lag_s), w2_(std::pow(2.0 * std::numbers::pi * frequency_hz, 2)), event_s_(event_s) {
    late_ = std::lround(dead_time_s / event_s * kSteps);
  }
  void Send(double command) { commands_.push_back(command); }
  /// The angle at this time; grid: event_s / kSteps. Forgets nothing, starts at rest at 0.
  double At(double time_s) const {
    double y = 0.0, v = 0.0;
    const double h = event_s_ / kSteps;
    const long steps = std::lround(time_s / h);
    for (long k = 0; k < steps; ++k) {
      const long event = k < late_ ? -1 : (k - late_) / kSteps;
      const double u = event < 0 || commands_.empty()
                           ? 0.0
                           : commands_[std::min<std::size_t>(static_cast<std::size_t>(event),
                                                             commands_.size() - 1)];
      const auto pull = [&](double at, double speed) { return w2_ * (u - at - lag_ * speed); };
      const double v1 = v, a1 = pull(y, v);
      const double v2 = v + 0.5 * h * a1, a2 = pull(y + 0.5 * h * v1, v2);
      const double v3 = v + 0.5 * h * a2, a3 = pull(y + 0.5 * h * v2, v3);
      const double v4 = v + h * a3, a4 = pull(y + h * v3, v4);
      y += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
      v += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    return y;
  }

  static constexpr long kSteps = 200;

 private:
  double lag_, w2_, event_s_;
  long late_ = 0;
  std::vector<double> commands_;
};

/// Where the wearer is expected at each event of a path.
template <class Motion>
std::vector<double> PathOf(const ModelPredictive& planner, double now_s, double event_s,
                           const Motion& motion) {
  std::vector<double> path;
  for (int row = 0; row < planner.path_length(); ++row)
    path.push_back(motion(now_s + row * event_s));
  return path;
}

// The servo and its response are computed in another way: a delay line and Runge-Kutta.
TEST(ModelPredictive, IsTheLeastSquaresPlanForTheServoWhereNoLimitActs) {
  constexpr double kEvent = 0.02;
  const auto motion = [](double t) { return 0.2 + 3.0 * t - 4.0 * t * t; };
  for (const double dead_time_s : {0.0, 0.013, 0.04, 0.0555}) {
    ModelPredictiveConfig config = Unlimited();
    config.steps = 5;
    config.dead_time_ms = {1e3 * dead_time_s};
    config.lag_ms = {50.0};
    config.natural_frequency_hz = {4.0};
    config.change_weight = 0.3;
    ModelPredictive planner(config, WideHand(1), 1.0 / kEvent);
    const double start = 0.0;
    planner.Reset({&start, 1});
    Servo servo(dead_time_s, 0.05, 4.0, kEvent);
    double last = 0.0;
    for (int event = 0; event < 6; ++event) {
      const double now = event * kEvent;
      // y = free + response u, for the commands of the plan; the free one: the last stays.
      const auto path_of = [&](const Eigen::VectorXd& plan) {
        Servo copy = servo;
        for (const double u : plan) copy.Send(u);
        Eigen::VectorXd y(config.steps);
        for (int j = 0; j < config.steps; ++j) y[j] = copy.At(now + dead_time_s + (j + 1) * kEvent);
        return y;
      };
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(config.steps);
      const Eigen::VectorXd free = path_of(zero);
      Eigen::MatrixXd normal(2 * config.steps, config.steps);
      Eigen::MatrixXd right = Eigen::MatrixXd::Zero(2 * config.steps, 1);
      normal.setZero();
      for (int k = 0; k < config.steps; ++k) {
        Eigen::VectorXd one = zero;
        one[k] = 1.0;
        normal.col(k).head(config.steps) = path_of(one) - free;
        normal(config.steps + k, k) = std::sqrt(config.change_weight);
        if (k > 0) normal(config.steps + k, k - 1) = -std::sqrt(config.change_weight);
      }
      for (int j = 0; j < config.steps; ++j) {
        right(j, 0) = motion(now + dead_time_s + (j + 1) * kEvent) - free[j];
      }
      right(config.steps, 0) = std::sqrt(config.change_weight) * last;
      const double expected = test::SolveByGramSchmidt(normal, right).value()(0, 0);

      double command = 0.0;
      planner.Step(PathOf(planner, now, kEvent, motion), {&command, 1});
      EXPECT_NEAR(command, expected, 1e-9) << dead_time_s << " event " << event;
      servo.Send(command);
      last = command;
    }
  }
}

struct Plant {
  double event_s, dead_time_s, lag_s, frequency_hz;
};

/// 3.3 to 0.2 times the critical damping, from fast servos to slow ones.
Plant RandomPlant(std::mt19937_64& random) {
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Plant plant = {.event_s = uniform(0.01, 0.04),
                 .dead_time_s = uniform(0.0, 0.15),
                 .lag_s = 0.0,
                 .frequency_hz = uniform(1.0, 10.0)};
  plant.lag_s = 2.0 * uniform(0.2, 3.3) / (2.0 * std::numbers::pi * plant.frequency_hz);
  return plant;
}

TEST(ModelPredictive, IsStableOnAThousandRandomPlants) {
  std::mt19937_64 random(1);
  const auto uniform = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 1000; ++i) {
    const Plant plant = RandomPlant(random);
    ModelPredictiveConfig config;
    config.kind = ModelPredictiveKind::kSecondOrder;
    config.steps = 4 + i % 13;
    config.dead_time_ms = {1e3 * plant.dead_time_s};
    config.lag_ms = {1e3 * plant.lag_s};
    config.natural_frequency_hz = {plant.frequency_hz};
    config.change_weight = std::pow(10.0, uniform(-3.0, 1.0));
    config.speed_limit_deg_s = uniform(50.0, 1000.0);
    config.lead_limit_deg = i % 2 == 0 ? 0.0 : uniform(3.0, 60.0);
    config.iterations = 200;
    ModelPredictive planner(config, CoupledHand(1), 1.0 / plant.event_s);
    const double start = uniform(0.0, 1.5);
    planner.Reset({&start, 1});
    const double limit = config.speed_limit_deg_s * kDeg * plant.event_s + 1e-12;
    double last = start;
    const auto send = [&](double wanted) {
      const std::vector<double> path(static_cast<std::size_t>(planner.path_length()), wanted);
      double command = 0.0;
      planner.Step(path, {&command, 1});
      EXPECT_GE(command, 0.0) << i;
      EXPECT_LE(command, 1.5) << i;
      EXPECT_LE(std::abs(command - last), limit) << i;
      last = command;
    };
    for (int event = 0; event < 100; ++event) send(uniform(-0.5, 2.0));
    const double goal = uniform(0.1, 1.4);
    for (int event = 0; event < 3000; ++event) send(goal);
    EXPECT_NEAR(last, goal, 1e-3) << i;
    EXPECT_THAT(planner.failed_plans(), testing::ElementsAre(0)) << i;
  }
}

TEST(ModelPredictive, ObeysItsLimitsAtTheEndsOfItsSettings) {
  std::mt19937_64 random(2);
  const auto one_of = [&random](double a, double b, double c) {
    return std::array<double, 3>{a, b, c}[random() % 3];
  };
  std::int64_t failed = 0;
  for (int i = 0; i < 1000; ++i) {
    ModelPredictiveConfig config;
    config.kind = ModelPredictiveKind::kSecondOrder;
    config.steps = static_cast<int>(one_of(1, 6, kMostPlanSteps));
    config.dead_time_ms = {one_of(0.0, 37.0, 500.0)};
    config.lag_ms = {one_of(0.1, 60.0, 1000.0)};
    config.natural_frequency_hz = {one_of(0.1, 5.0, 100.0)};
    config.change_weight = one_of(1e-4, 1.0, 1e4);
    config.speed_limit_deg_s = one_of(1.0, 200.0, 0.0);
    config.lead_limit_deg = one_of(0.01, 16.0, 0.0);
    config.iterations = 200;  // 50 are too few for 1 in 1000 of these
    const double event_s = one_of(0.001, 0.02, 1.0);
    ModelPredictive planner(config, CoupledHand(1), 1.0 / event_s);
    double last = 0.7;
    planner.Reset({&last, 1});
    std::vector<double> path(static_cast<std::size_t>(planner.path_length()));
    for (int event = 0; event < 60; ++event) {
      for (double& angle : path) angle = std::uniform_real_distribution<double>(-0.5, 2.0)(random);
      double command = 0.0;
      planner.Step(path, {&command, 1});
      ASSERT_TRUE(command >= 0.0 && command <= 1.5) << i << " " << command;
      if (config.speed_limit_deg_s > 0.0) {
        ASSERT_LE(std::abs(command - last), config.speed_limit_deg_s * kDeg * event_s + 1e-12) << i;
      }
      last = command;
    }
    failed += planner.failed_plans()[0];
  }
  EXPECT_EQ(failed, 0);
}

TEST(ModelPredictive, LeadsTheJointByNoMoreThanTheServoCanUse) {
  ModelPredictiveConfig config = Unlimited();
  config.change_weight = 1e-3;
  config.dead_time_ms = {0.0};
  const auto largest_lead_deg = [&](double limit_deg) {
    config.lead_limit_deg = limit_deg;
    ModelPredictive planner(config, WideHand(1), 50.0);
    Servo servo(0.0, 1e-3 * config.lag_ms[0], config.natural_frequency_hz[0], 0.02);
    const double start = 0.0;
    planner.Reset({&start, 1});
    double lead = 0.0;
    for (int event = 0; event < 60; ++event) {
      double command = 0.0;
      planner.Step(std::vector<double>(static_cast<std::size_t>(planner.path_length()), 1.0),
                   {&command, 1});
      lead = std::max(lead, std::abs(command - servo.At(0.02 * event)));
      servo.Send(command);
    }
    EXPECT_NEAR(servo.At(1.2), 1.0, 0.01);
    return lead / kDeg;
  };
  EXPECT_GT(largest_lead_deg(0.0), 60.0);
  EXPECT_NEAR(largest_lead_deg(16.6), 16.6, 1e-6);
}

TEST(ModelPredictive, KeepsTheLastCommandWhereThePlanTakesTooLongAndCountsIt) {
  ModelPredictiveConfig config;
  config.kind = ModelPredictiveKind::kSecondOrder;
  config.speed_limit_deg_s = 100.0;
  config.iterations = 0;
  ModelPredictive planner(config, CoupledHand(2), 50.0);
  const std::vector<double> start = {0.5, 0.5};
  planner.Reset(start);
  std::vector<double> path;
  for (int row = 0; row < planner.path_length(); ++row) path.insert(path.end(), {1.5, 0.501});
  std::vector<double> command(2);
  for (int event = 0; event < 3; ++event) planner.Step(path, command);
  EXPECT_EQ(command[0], 0.5);  // would have to go faster than it may
  EXPECT_GT(command[1], 0.5);
  EXPECT_THAT(planner.failed_plans(), testing::ElementsAre(3, 0));
  planner.Reset(start);
  EXPECT_THAT(planner.failed_plans(), testing::ElementsAre(0, 0));
}

// A command may lead the joint by so much; a motor that was never told to move keeps it where it
// is.
TEST(ModelPredictive, FollowsWhatTheMotorsWereToldAndNotWhatWasPlanned) {
  ModelPredictiveConfig config = Unlimited();
  config.lead_limit_deg = 10.0;
  const auto last_command_deg = [&](bool told) {
    ModelPredictive planner(config, WideHand(1), 50.0);
    const double start = 0.0;
    planner.Reset({&start, 1});
    const std::vector<double> path(static_cast<std::size_t>(planner.path_length()), 1.0);
    double command = 0.0;
    for (int event = 0; event < 200; ++event) {
      planner.Step(path, {&command, 1});
      if (!told) planner.Sent({&command, 1}, {&start, 1});
    }
    return command / kDeg;
  };
  EXPECT_NEAR(last_command_deg(true), 1.0 / kDeg, 1e-6);
  EXPECT_NEAR(last_command_deg(false), 10.0, 1e-9);
}

TEST(ModelPredictive, RefusesListsOfAnotherLength) {
  ModelPredictiveConfig config = Unlimited();
  config.lag_ms = {50.0, 60.0};
  EXPECT_THROW(ModelPredictive(config, CoupledHand(3), 50.0), SettingError);
  EXPECT_NO_THROW(ModelPredictive(config, CoupledHand(2), 50.0));
}

ControllerConfig Planning() {
  ControllerConfig config;
  config.prediction.settings = KalmanPredictionConfig{.horizon_ms = {0.0}};
  config.model_predictive.kind = ModelPredictiveKind::kSecondOrder;
  return config;
}

/// The motor commands of a controller that is stepped with a swing of 1 Hz.
std::vector<std::int32_t> StepSwing(Controller& controller, int from, int to) {
  std::vector<std::int32_t> commands;
  for (int k = from; k < to; ++k) {
    const std::vector<double> counts(3,
                                     500.0 + 150.0 * std::sin(2.0 * std::numbers::pi * 1e-3 * k));
    const Command command = controller.Step({.counts = counts});
    commands.insert(commands.end(), command.motor_counts.begin(), command.motor_counts.end());
  }
  return commands;
}

TEST(ModelPredictiveController, SendsItsCommandsAheadOfTheWearer) {
  Controller planning(Planning(), PlainGlove(3), CoupledHand(3));
  ControllerConfig plain = Planning();
  plain.model_predictive.kind = ModelPredictiveKind::kNone;
  Controller without(plain, PlainGlove(3), CoupledHand(3));
  planning.Reset(HalfClosed(3));
  without.Reset(HalfClosed(3));
  const std::vector<std::int32_t> ahead = StepSwing(planning, 0, 3000);
  const std::vector<std::int32_t> beside = StepSwing(without, 0, 3000);
  // Dead time and lag are 86 ms, the hold 10; held commands are alike every 20 ms. The first motor
  // is that of one joint.
  double best = 1e300;
  int best_ms = 0;
  for (int shift_ms = 0; shift_ms < 200; ++shift_ms) {
    double off = 0.0;
    for (int k = 1000; k < 2800; ++k) {
      off += std::pow(ahead[static_cast<std::size_t>(3 * k)] -
                          beside[static_cast<std::size_t>(3 * (k + shift_ms))],
                      2);
    }
    if (off < best) {
      best = off;
      best_ms = shift_ms;
    }
  }
  EXPECT_NEAR(best_ms, 96, 20);
  EXPECT_THAT(planning.failed_plans(), testing::Each(0));
  EXPECT_TRUE(without.failed_plans().empty());
}

TEST(ModelPredictiveController, DoesNotAllocate) {
  ControllerConfig config = Planning();
  config.model_predictive.speed_limit_deg_s = 60.0;  // which acts all the time
  Controller controller(config, PlainGlove(3), CoupledHand(3));
  controller.Reset(HalfClosed(3));
  const std::vector<double> low(3, 250.0), high(3, 750.0);
  const long before = AllocationCount();
  for (int k = 0; k < 2000; ++k) controller.Step({.counts = k % 400 < 200 ? low : high});
  EXPECT_EQ(AllocationCount(), before);
}

TEST(ModelPredictiveController, GoesOnThroughALoadOfTheSameSettings) {
  Controller once(Planning(), PlainGlove(3), CoupledHand(3));
  Controller loaded(Planning(), PlainGlove(3), CoupledHand(3));
  EXPECT_EQ(StepSwing(once, 0, 500), StepSwing(loaded, 0, 500));
  loaded.Load(Planning());
  EXPECT_EQ(StepSwing(once, 500, 1000), StepSwing(loaded, 500, 1000));
}

TEST(ModelPredictiveController, HoldsTheJointOfAChannelThatIsOff) {
  Controller controller(Planning(), PlainGlove(3), CoupledHand(3));
  controller.Reset(HalfClosed(3));
  StepSwing(controller, 0, 1000);  // at the middle of the swing
  controller.SetChannelActive(0, false);
  StepSwing(controller, 1000, 2000);
  const std::vector<std::int32_t> commands = StepSwing(controller, 2000, 3000);
  for (std::size_t k = 0; k < commands.size(); k += 3) EXPECT_EQ(commands[k], commands[0]);
}

TEST(ModelPredictiveController, RefusesWhatCannotBePlannedFor) {
  ControllerConfig config = Planning();
  config.prediction.settings = FittedPredictionConfig{};
  EXPECT_THAT(
      [&] { Controller(config, PlainGlove(3), CoupledHand(3)); },
      testing::ThrowsMessage<SettingError>(
          "prediction.kind: is fitted, must be none or one whose horizon_ms may be changed, for "
          "model_predictive"));
  config = Planning();
  config.prediction.settings = KalmanPredictionConfig{.horizon_ms = {950.0}};
  EXPECT_THAT([&] { Controller(config, PlainGlove(3), CoupledHand(3)); },
              testing::ThrowsMessage<SettingError>(testing::HasSubstr(
                  "prediction.horizon_ms: and what model_predictive plans beyond it are")));
  TendonTransmission hand = CoupledHand(3);
  hand.joint_sensors = true;
  config = Planning();
  config.joint_loop.kind = JointLoopKind::kPi;
  EXPECT_THAT([&] { Controller(config, PlainGlove(3), hand); },
              testing::ThrowsMessage<SettingError>(
                  testing::HasSubstr("joint_loop.kind: pi with proportional or integral_per_s")));
  config.joint_loop.proportional = config.joint_loop.integral_per_s = 0.0;
  EXPECT_NO_THROW(Controller(config, PlainGlove(3), hand));
}

/// The least of several times [ns]: what the machine does besides only adds to it.
template <class Work>
double LeastNs(int repeats, const Work& work) {
  double least = 1e12;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - begin;
    least = std::min(least, taken.count());
  }
  return least;
}

TEST(PlannedController, TakesNoLongTimeForItsFirstStepAndAfterResetAndSwap) {
  constexpr int kChannels = 18;
  ControllerConfig config;
  config.prediction.settings = AdaptivePredictionConfig{};
  config.model_predictive = {.kind = ModelPredictiveKind::kSecondOrder, .steps = 16};
  ControllerConfig plain;
  const Timing timing = {.event_period_ms = 20.0};
  Controller controller(config, PlainGlove(kChannels), CoupledHand(kChannels), timing);
  const std::vector<double> counts(kChannels, 500.0);
  const auto step = [&] { controller.Step({.counts = counts}); };
  for (int k = 0; k < 2000; ++k) step();
  const double event_ns = LeastNs(20, [&] {
    for (int k = 0; k < 20; ++k) step();
  });
  const double reset_ns = LeastNs(20, [&] {
    controller.Reset();
    step();
  });
  Controller other = controller.Prepare(plain);
  ASSERT_TRUE(controller.Swap(other));  // now `other` plans
  const double swap_ns = LeastNs(20, [&] {
    controller.Swap(other);
    for (int k = 0; k < 20; ++k) step();
    controller.Swap(other);
  });
  // 20 steps take about 20 us, and filling the history of the bank took 1,500.
  EXPECT_LT(reset_ns, 5.0 * event_ns);
  EXPECT_LT(swap_ns, 10.0 * event_ns);
}

}  // namespace
}  // namespace gauntlet::controller
