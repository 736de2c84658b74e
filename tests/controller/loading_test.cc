// Other settings while the controller runs.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <thread>

#include "controller/controller.h"
#include "tests/controller/allocation_counter.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr Timing kEventPerSample = {.event_period_ms = 1.0};

/// Every kind of filter, with a variance and limits that suit counts and angles alike, and with the
/// start from zero where it has one.
std::vector<ControllerConfig> AllKindsOfSettings() {
  std::vector<ControllerConfig> all;
  for (const FilterKind& kind : FilterKinds()) {
    for (const FilterOn on : {FilterOn::kCounts, FilterOn::kAngle}) {
      for (const FilterAt at : {FilterAt::kSample, FilterAt::kEvent}) {
        ControllerConfig& config = all.emplace_back();
        config.filters = {kind.defaults};
        std::visit(
            [](auto& settings) {
              if (auto* r = MeasurementVarianceOf(settings)) *r = {15.0};
              if constexpr (requires { settings.max_jerk_per_s3; }) {
                settings.max_jerk_per_s3 = 2e7;
              }
              if constexpr (requires { settings.start; }) settings.start = Start::kZero;
              if constexpr (requires { settings.cutoff_hz; }) settings.cutoff_hz = 2.0;
            },
            config.filters[0].settings);
        config.filter_on = on;
        config.filter_at = at;
        config.untrusted.stuck_after_ms = 0.0;
      }
    }
  }
  return all;
}

Controller Make(const ControllerConfig& config, const Timing& timing = {}) {
  Controller controller(config, PlainGlove(kChannels), CoupledHand(kChannels), timing);
  controller.Reset(HalfClosed(kChannels));
  return controller;
}

TEST(Load, LeavesAStillHandWhereItIsWhateverChanges) {
  const std::vector<double> still(kChannels, 620.0);
  const std::vector<ControllerConfig> all = AllKindsOfSettings();
  for (const ControllerConfig& from : all) {
    Controller controller = Make(from, {.event_period_ms = 2.0});
    // Also a filter that started at zero has arrived: 8 seconds.
    for (int k = 0; k < 8000; ++k) controller.Step({.counts = still});
    const auto counts = controller.Step({.counts = still}).motor_counts;
    const std::vector<std::int32_t> before(counts.begin(), counts.end());
    for (const ControllerConfig& to : all) {
      controller.Load(to);
      for (int k = 0; k < 20; ++k) {
        const auto after = controller.Step({.counts = still}).motor_counts;
        for (std::size_t i = 0; i < before.size(); ++i) {
          ASSERT_LE(std::abs(after[i] - before[i]), 1)
              << from.filters[0].kind() << " to " << to.filters[0].kind() << " at " << k;
        }
      }
    }
  }
}

TEST(Load, KeepsNoVelocityPerAnotherStep) {
  // One step of an event is 20 samples: a velocity per step means another speed.
  for (const FilterAt from : {FilterAt::kSample, FilterAt::kEvent}) {
    ControllerConfig config;
    config.filters = {{KalmanConfig{.noise = {.q = {1e-4}}}}};
    config.prediction = {KalmanPredictionConfig{.horizon_ms = {20.0}}};
    config.filter_at = from;
    Controller controller = Make(config);
    double largest_rad = 0.0;
    for (int k = 0; k < 1200; ++k) {
      if (k == 600) {
        config.filter_at = from == FilterAt::kSample ? FilterAt::kEvent : FilterAt::kSample;
        controller.Load(config);
      }
      const std::vector<double> counts(kChannels, 400.0 + 0.2 * k);
      controller.Step({.counts = counts});
      if (k < 600) continue;
      // 0.2 counts a sample are 0.0005 rad: a filter that starts anew is behind by some of them.
      largest_rad =
          std::max(largest_rad, std::abs(controller.filtered_angle_rad()[3] - 0.0005 * k - 0.5));
    }
    EXPECT_LE(largest_rad, 0.04) << static_cast<int>(from);
  }
}

TEST(Swap, NeitherAllocatesNorFrees) {
  const TestSignal input = GloveCounts(60, kChannels);
  const std::vector<ControllerConfig> all = AllKindsOfSettings();
  Controller controller = Make(all[0]);
  for (const ControllerConfig& config : all) {
    for (int k = 0; k < 60; ++k) controller.Step({.counts = RowOf(input, k)});
    Controller next = controller.Prepare(config);
    const long before = AllocationCount();
    ASSERT_TRUE(controller.Swap(next));
    ASSERT_TRUE(controller.Swap(next));  // back
    ASSERT_TRUE(controller.Swap(next));  // and forth
    EXPECT_EQ(AllocationCount(), before) << config.filters[0].kind();
  }
}

TEST(Swap, KeepsWhatWasHandedOutBefore) {
  const TestSignal input = GloveCounts(300, kChannels);
  ControllerConfig config;
  config.filters = {{MovingAverageConfig{}}};
  Controller controller = Make(config);
  Command command;
  for (int k = 0; k < 100; ++k) command = controller.Step({.counts = RowOf(input, k)});
  const std::vector<std::int32_t> counts(command.motor_counts.begin(), command.motor_counts.end());
  const auto angles = {controller.linearised_angle_rad(), controller.filtered_angle_rad(),
                       controller.target_angle_rad()};
  const auto untrusted = controller.untrusted_samples();
  std::vector<std::vector<double>> values;
  for (const auto& span : angles) values.emplace_back(span.begin(), span.end());

  config.filters = {{ButterworthConfig{}}};
  {
    Controller old = controller.Prepare(config);
    ASSERT_TRUE(controller.Swap(old));
  }
  EXPECT_THAT(command.motor_counts, testing::ElementsAreArray(counts));
  std::size_t i = 0;
  for (const auto& span : angles) EXPECT_THAT(span, testing::ElementsAreArray(values[i++]));
  EXPECT_EQ(untrusted[0], 0);
  // They are those of the next step, too.
  const Command next = controller.Step({.counts = RowOf(input, 100)});
  EXPECT_EQ(next.motor_counts.data(), command.motor_counts.data());
  EXPECT_EQ(controller.filtered_angle_rad().data(), (angles.begin() + 1)->data());
  EXPECT_EQ(controller.untrusted_samples().data(), untrusted.data());
}

TEST(Swap, KeepsTheMemoryOfFailedPlansWhereNothingIsPlannedAnyMore) {
  const TestSignal input = GloveCounts(100, kChannels);
  ControllerConfig planned;
  planned.filters = {{KalmanConfig{}}};
  planned.model_predictive = {
      .kind = ModelPredictiveKind::kSecondOrder, .speed_limit_deg_s = 1.0, .iterations = 0};
  ControllerConfig plain;
  plain.filters = planned.filters;
  Controller controller = Make(planned, kEventPerSample);
  for (int k = 0; k < 50; ++k) controller.Step({.counts = RowOf(input, k)});
  const std::span<const std::int64_t> before = controller.failed_plans();
  ASSERT_EQ(before.size(), kChannels);
  const std::int64_t failed = before[0];
  EXPECT_GT(failed, 0) << "without iterations limits cannot be kept";
  controller.Load(plain);
  EXPECT_TRUE(controller.failed_plans().empty());
  EXPECT_EQ(before[0], failed);
  controller.Load(planned);
  EXPECT_EQ(controller.failed_plans().data(), before.data()) << "the memory is another one";
  EXPECT_EQ(before[0], failed);
}

TEST(Swap, TakesOnlyWhatTheControllerHasPrepared) {
  const TestSignal input = GloveCounts(100, kChannels);
  ControllerConfig config;
  config.filters = {{KalmanConfig{}}};
  Controller controller = Make(config);
  Controller undisturbed = Make(config);
  Controller other = Make(config);
  Controller emptied = controller.Prepare(config);
  const Controller taken = std::move(emptied);
  for (int k = 0; k < 100; ++k) {
    EXPECT_FALSE(controller.Swap(other));
    EXPECT_FALSE(controller.Swap(emptied));  // NOLINT: moved from on purpose
    EXPECT_FALSE(controller.Swap(controller));
    const auto expected = undisturbed.Step({.counts = RowOf(input, k)}).motor_counts;
    ASSERT_THAT(controller.Step({.counts = RowOf(input, k)}).motor_counts,
                testing::ElementsAreArray(expected));
  }
}

TEST(Swap, ChangesNothingWhenTheSettingsAreTheSameAndIsWithinTheSpeedLimitElse) {
  const TestSignal input = GloveCounts(3000, kChannels);
  ControllerConfig slow;
  slow.filters = {{ButterworthConfig{.order = 3, .cutoff_hz = 1.0}}};
  ControllerConfig quick;
  quick.filters = {{NoFilterConfig{}}};
  for (const bool same : {true, false}) {
    Controller controller = Make(slow, kEventPerSample);
    Controller undisturbed = Make(slow, kEventPerSample);
    Controller next = controller.Prepare(same ? slow : quick);
    std::vector<std::int32_t> last = HalfClosed(kChannels);
    for (int k = 0; k < 3000; ++k) {
      if (k % 37 == 0) controller.Swap(next);
      const auto expected = undisturbed.Step({.counts = RowOf(input, k)}).motor_counts;
      const auto counts = controller.Step({.counts = RowOf(input, k)}).motor_counts;
      if (same) {
        ASSERT_THAT(counts, testing::ElementsAreArray(expected));
      }
      for (std::size_t i = 0; i < counts.size(); ++i) {
        // 20 rad/s at 100 counts per rad and 1000 events per second: 2 counts and the rounding.
        ASSERT_LE(std::abs(counts[i] - last[i]), 3) << k;
      }
      last.assign(counts.begin(), counts.end());
    }
  }
}

/// What the thread sanitizer is for: one thread steps, another prepares settings and destroys those
/// that come back.
TEST(Swap, GetsSettingsFromAnotherThread) {
  constexpr int kLoads = 100;
  const std::vector<ControllerConfig> all = AllKindsOfSettings();
  Controller controller = Make(all[0], kEventPerSample);
  std::atomic<Controller*> prepared = nullptr;
  std::atomic<Controller*> replaced = nullptr;
  std::thread tuner([&] {
    for (std::size_t load = 0; load < kLoads; ++load) {
      auto next = std::make_unique<Controller>(controller.Prepare(all[load % all.size()]));
      prepared = next.release();
      while (replaced == nullptr) std::this_thread::yield();
      const std::unique_ptr<Controller> old(replaced.exchange(nullptr));
    }
  });
  const TestSignal input = GloveCounts(1000, kChannels);
  std::vector<std::int32_t> last = HalfClosed(kChannels);
  int swaps = 0;
  for (int k = 0; swaps < kLoads; k = (k + 1) % 1000) {
    if (Controller* next = prepared.exchange(nullptr)) {
      EXPECT_TRUE(controller.Swap(*next));
      ++swaps;
      replaced = next;
    }
    const auto counts = controller.Step({.counts = RowOf(input, k)}).motor_counts;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      ASSERT_LE(std::abs(counts[i] - last[i]), 3);
    }
    last.assign(counts.begin(), counts.end());
  }
  tuner.join();
}

}  // namespace
}  // namespace gauntlet::controller
