#include "sim/glove/faults/faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "controller/controller.h"
#include "controller/filters/filter_registry.h"
#include "sim/base/channels.h"
#include "sim/glove/glove.h"

namespace gauntlet::sim {
namespace {

/// Comes at half a second, goes, and comes again.
FaultConfig Fault(const FaultSettings& settings) {
  FaultConfig fault{settings};
  fault.when().start_s = 0.5;
  fault.when().rate_per_s = 2.0;
  if (fault.when().duration_ms == 0.0) fault.when().duration_ms = 200.0;
  return fault;
}

GloveConfig WithFaults(std::vector<FaultConfig> faults) {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 4.0};
  config.faults = std::move(faults);
  return config;
}

std::vector<FaultConfig> AllFaults() {
  std::vector<FaultConfig> faults;
  for (const FaultKind& kind : FaultKinds()) faults.push_back(Fault(kind.defaults.settings));
  return faults;
}

class EveryFault : public ::testing::TestWithParam<std::size_t> {
 protected:
  const FaultKind& kind_ = FaultKinds()[GetParam()];
};

TEST_P(EveryFault, ChangesTheSignalOnlyWhereItsTruthSaysSo) {
  const GloveSignal clean = SynthesiseGlove(WithFaults({}), 1);
  const GloveSignal faulty = SynthesiseGlove(WithFaults({Fault(kind_.defaults.settings)}), 1);
  ASSERT_FALSE(faulty.faults.empty());
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> struck =
      Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(clean.counts.rows(), 18, false);
  for (const FaultEvent& event : faulty.faults) {
    EXPECT_EQ(event.kind, kind_.name);
    ASSERT_LT(event.begin, event.end);
    struck.col(event.channel).segment(event.begin, event.end - event.begin) = true;
  }
  int changed = 0;
  for (Eigen::Index i = 0; i < clean.counts.rows(); ++i) {
    for (Eigen::Index c = 0; c < 18; ++c) {
      // NaN differs from everything.
      const bool same = clean.counts(i, c) == faulty.counts(i, c);
      changed += same ? 0 : 1;
      ASSERT_TRUE(same || struck(i, c)) << i << " " << c;
    }
  }
  EXPECT_GT(changed, 0);
  EXPECT_EQ(clean.true_angle_rad, faulty.true_angle_rad);
}

TEST_P(EveryFault, GivesWholeCountsInsideTheScaleOrNothing) {
  const GloveSignal faulty = SynthesiseGlove(WithFaults({Fault(kind_.defaults.settings)}), 2);
  for (const double value : faulty.counts.reshaped()) {
    ASSERT_TRUE(std::isnan(value) ||
                (value >= 0.0 && value <= 1023.0 && value == std::round(value)));
  }
}

TEST_P(EveryFault, StrikesOnlyTheChannelsNamed) {
  FaultConfig fault = Fault(kind_.defaults.settings);
  fault.when().channels = {"wrist_flexion"};
  for (const FaultEvent& event : SynthesiseGlove(WithFaults({fault}), 1).faults) {
    EXPECT_EQ(event.channel, ChannelIndex("wrist_flexion"));
  }
  fault.when().channels = {"wrist"};
  try {
    SynthesiseGlove(WithFaults({Fault(kind_.defaults.settings), fault}), 1);
    FAIL() << "an unknown channel";
  } catch (const controller::SettingError& error) {
    EXPECT_EQ(error.key(), "faults[1].channels");
  }
}

TEST_P(EveryFault, ComesAsOftenAndLastsAsLongAsStated) {
  FaultConfig fault = kind_.defaults;
  fault.when().channels = {"wrist_flexion"};
  fault.when().start_s = -1.0;
  fault.when().rate_per_s = 4.0;
  fault.when().duration_ms = 30.0;
  const auto events = DrawFaults({fault}, 18'000'000, 1000.0, 1);
  double length_s = 0.0;
  for (const FaultEvent& event : events) length_s += (event.end - event.begin) / 1000.0;
  const double count = static_cast<double>(events.size());
  // 72,000 in 18,000 s: a standard error of 0.33 %, 0.37 % for the mean length.
  EXPECT_NEAR(count, 4.0 * 18000.0, 0.015 * 72000);
  EXPECT_NEAR(length_s / count, 0.03, 0.015 * 0.03);
}

TEST_P(EveryFault, ComesFirstWhenStatedAndOnceWithoutARate) {
  FaultConfig fault = kind_.defaults;
  fault.when().channels = {"index_mcp", "elbow_flexion"};
  fault.when().start_s = 1.1;
  fault.when().rate_per_s = 0.0;
  fault.when().duration_ms = 0.0;
  const auto events = DrawFaults({fault}, 3000, 1000.0, 1);
  ASSERT_EQ(events.size(), 2u);
  for (const FaultEvent& event : events) {
    EXPECT_EQ(event.begin, 1100);
    EXPECT_EQ(event.end, 3000);
  }
  fault.when().start_s = -1.0;
  EXPECT_TRUE(DrawFaults({fault}, 3000, 1000.0, 1).empty());
  fault.when().start_s = 4.0;
  EXPECT_TRUE(DrawFaults({fault}, 3000, 1000.0, 1).empty());
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryFault, ::testing::Range<std::size_t>(0, FaultKinds().size()),
                         [](const auto& kind) {
                           return std::string(FaultKinds()[kind.param].name);
                         });

TEST(Faults, OfFramesStrikeTheirChannelsAtOnceOthersEachByItself) {
  const auto begins_equal = [](const FaultKind& kind) {
    FaultConfig fault = Fault(kind.defaults.settings);
    fault.when().start_s = -1.0;
    fault.when().channels = {"index_mcp", "wrist_flexion"};
    std::vector<int> index, wrist;
    for (const FaultEvent& event : DrawFaults({fault}, 20000, 1000.0, 1)) {
      (event.channel == ChannelIndex("index_mcp") ? index : wrist).push_back(event.begin);
    }
    EXPECT_FALSE(index.empty());
    return index == wrist;
  };
  for (const FaultKind& kind : FaultKinds()) {
    const bool frames = kind.name.ends_with("_frames");
    EXPECT_EQ(begins_equal(kind), frames) << kind.name;
  }
}

TEST(Faults, AnOffsetJumpShiftsAllThatComesAfterIt) {
  const FaultConfig fault{OffsetJumpFault{
      .when = {.start_s = 1.0, .rate_per_s = 0.0, .duration_ms = 0.0}, .offset_counts = 25.0}};
  Signal counts = Signal::Constant(3000, std::ssize(KnownChannels()), 500.0);
  ApplyFaults(FaultStage::kAnalog, {fault}, ConverterConfig{}.ranges(), 1000.0, 1, counts);
  bool up = false, down = false;
  for (Eigen::Index c = 0; c < counts.cols(); ++c) {
    EXPECT_TRUE((counts.col(c).head(1000).array() == 500.0).all());
    const double shift = counts(1000, c) - 500.0;
    EXPECT_EQ(std::abs(shift), 25.0);
    EXPECT_TRUE((counts.col(c).tail(2000).array() == 500.0 + shift).all());
    (shift > 0.0 ? up : down) = true;
  }
  EXPECT_TRUE(up && down);
}

TEST(Faults, TimeJitterTakesSamplesOffTheirTimeByItsDeviation) {
  const FaultConfig fault{TimeJitterFault{.deviation_ms = 3.0}};
  const double counts_per_sample = 0.05;
  const int samples = 20000;
  Signal counts = Signal::Zero(samples, std::ssize(KnownChannels()));
  counts.colwise() = counts_per_sample * Eigen::VectorXd::LinSpaced(samples, 0, samples - 1);
  const Signal exact = counts;
  ApplyFaults(FaultStage::kSampling, {fault}, ConverterConfig{}.ranges(), 1000.0, 1, counts);
  const auto inside = (counts - exact).middleRows(100, samples - 200) / counts_per_sample;
  const double values = static_cast<double>(inside.size());  // 435,600: a standard error of 0.11 %
  EXPECT_NEAR(std::sqrt(inside.squaredNorm() / values), 3.0, 0.03);
  EXPECT_NEAR(inside.sum() / values, 0.0, 0.03);
}

TEST(Faults, TimeJitterLeavesTheNoiseAsItIs) {
  GloveConfig config = WithFaults({{TimeJitterFault{}}});
  config.motion.settings = HoldConfig{.duration_s = 20.0};
  GloveConfig steady = config;
  steady.faults.clear();
  EXPECT_EQ(SynthesiseGlove(config, 1).counts, SynthesiseGlove(steady, 1).counts);
}

TEST(Faults, CannotComeAgainBeforeTheyEnd) {
  FaultConfig fault{DropoutFault{}};
  fault.when().rate_per_s = 20.0;
  fault.when().duration_ms = 49.0;
  EXPECT_NO_THROW(DrawFaults({fault}, 1000, 1000.0, 1));
  fault.when().duration_ms = 50.0;
  EXPECT_THROW(DrawFaults({fault}, 1000, 1000.0, 1), controller::SettingError);
}

TEST(Faults, BehindTheEndAreTold) {
  GloveConfig config = WithFaults({{DisconnectedFault{}}});  // at 5 s
  EXPECT_THAT(SynthesiseGlove(config, 1).remarks,
              testing::ElementsAre("glove.faults[0]: disconnected never comes: start_s is 5, the "
                                   "motion ends at 4 s"));
  config.motion.settings = RandomMotionConfig{.duration_s = 6.0};
  EXPECT_THAT(SynthesiseGlove(config, 1).remarks, testing::IsEmpty());
}

TEST(Faults, OfOneChannelDoNotDependOnTheOthers) {
  FaultConfig all = Fault(SpikeFault{});
  FaultConfig one = all;
  one.when().channels = {"ring_pip"};
  const int ring = ChannelIndex("ring_pip");
  EXPECT_EQ(SynthesiseGlove(WithFaults({all}), 1).counts.col(ring),
            SynthesiseGlove(WithFaults({one}), 1).counts.col(ring));
}

TEST(Faults, StuckChannelsRepeatTheirLastGoodValue) {
  const GloveSignal glove = SynthesiseGlove(WithFaults({Fault(StuckFault{})}), 1);
  for (const FaultEvent& event : glove.faults) {
    const auto stretch =
        glove.counts.col(event.channel).segment(event.begin, event.end - event.begin);
    EXPECT_EQ(
        (stretch.array() - glove.counts(std::max(event.begin - 1, 0), event.channel)).abs().sum(),
        0.0);
  }
}

TEST(Faults, LateFramesAreOldFrames) {
  const FaultConfig fault = Fault(LateFrameFault{.delay_ms = 15.0});
  const GloveSignal clean = SynthesiseGlove(WithFaults({}), 1);
  const GloveSignal late = SynthesiseGlove(WithFaults({fault}), 1);
  for (const FaultEvent& event : late.faults) {
    for (int i = event.begin; i < event.end; ++i) {
      EXPECT_EQ(late.counts.row(i), clean.counts.row(std::max(i - 15, 0)));
    }
  }
}

TEST(Faults, AGainChangeScalesAboutTheMiddleAndStays) {
  GloveConfig config = WithFaults({Fault(GainChangeFault{.gain = 0.5})});
  config.noise.kind = WhiteNoiseKind::kNone;
  config.faults[0].when().duration_ms = 0.0;
  GloveConfig healthy = config;
  healthy.faults.clear();
  const Signal with = SynthesiseGlove(config, 1).counts;
  const Signal without = SynthesiseGlove(healthy, 1).counts;
  EXPECT_EQ(with.topRows(500), without.topRows(500));
  const Signal expected = 511.5 + 0.5 * (without.bottomRows(3500).array() - 511.5);
  EXPECT_LT((with.bottomRows(3500) - expected).cwiseAbs().maxCoeff(), 0.76);  // two roundings
}

TEST(Faults, MoveWithTheChannelsThatTheGloveHas) {
  GloveConfig config = WithFaults({Fault(SpikeFault{})});
  config.channels = {"index_mcp", "elbow_flexion"};
  const GloveSignal glove = SynthesiseGlove(config, 1);
  EXPECT_EQ(glove.counts.cols(), 2);
  EXPECT_EQ(glove.channel_names[1], "elbow_flexion");
  bool elbow = false;
  for (const FaultEvent& event : glove.faults) {
    ASSERT_LT(event.channel, 2);
    elbow = elbow || event.channel == 1;
  }
  EXPECT_TRUE(elbow);
  EXPECT_EQ(NominalCalibration(config).low_counts.size(), 2u);
}

/// A transmission without coupling: 10-bit motors that turn with their joint.
controller::TendonTransmission PlainTransmission() {
  controller::TendonTransmission hand;
  hand.coupling.assign(18 * 18, 0.0);
  for (std::size_t c = 0; c < 18; ++c) {
    const Channel& joint = GloveChannels()[c];
    hand.joint_names.emplace_back(joint.name);
    hand.motor_names.emplace_back(joint.name);
    hand.coupling[19 * c] = 1.0;
    hand.reference_angle_rad.push_back(0.0);
    hand.joint_min_rad.push_back(joint.min_deg * kRadPerDeg);
    hand.joint_max_rad.push_back(joint.max_deg * kRadPerDeg);
    hand.counts_per_rad.push_back(195.0);
    hand.center_counts.push_back(512);
    hand.min_counts.push_back(0);
    hand.max_counts.push_back(1023);
  }
  return hand;
}

class EveryFilter : public ::testing::TestWithParam<std::size_t> {};

/// Sends a signal through the controller and checks everything that comes out of it.
void ExpectSaneCommands(const GloveConfig& config, const controller::FilterConfig& filter,
                        controller::FilterOn filter_on) {
  const GloveSignal glove = SynthesiseGlove(config, 3);
  controller::ControllerConfig settings;
  settings.filters = {filter};
  settings.filter_on = filter_on;
  if (filter_on == controller::FilterOn::kAngle) {  // the defaults are in counts
    if (auto* limits = std::get_if<controller::JerkLimitConfig>(&settings.filters[0].settings)) {
      *limits = {
          .max_velocity_per_s = 20.0, .max_acceleration_per_s2 = 300.0, .max_jerk_per_s3 = 1e4};
    }
    std::visit(
        [](auto& kind) {
          if (auto* r = controller::MeasurementVarianceOf(kind)) *r = {1e-4};
        },
        settings.filters[0].settings);
  }
  controller::Controller controller(settings, NominalCalibration(config), PlainTransmission());
  std::vector<double> counts(18);
  for (Eigen::Index i = 0; i < glove.counts.rows(); ++i) {
    for (Eigen::Index c = 0; c < 18; ++c) counts[static_cast<std::size_t>(c)] = glove.counts(i, c);
    const controller::Command command = controller.Step({.counts = counts});
    for (const std::int32_t motor : command.motor_counts) {
      ASSERT_GE(motor, 0);
      ASSERT_LE(motor, 1023);
    }
    for (const double angle : controller.filtered_angle_rad()) ASSERT_TRUE(std::isfinite(angle));
    for (const double angle : controller.linearised_angle_rad()) ASSERT_TRUE(std::isfinite(angle));
  }
}

TEST_P(EveryFilter, GivesSaneCommandsUnderEachFaultAloneAndAllTogether) {
  const controller::FilterConfig& filter = controller::FilterKinds()[GetParam()].defaults;
  for (const auto filter_on : {controller::FilterOn::kCounts, controller::FilterOn::kAngle}) {
    for (const FaultConfig& fault : AllFaults()) {
      GloveConfig config = WithFaults({fault});
      config.motion.settings = RandomMotionConfig{.duration_s = 1.0};
      ExpectSaneCommands(config, filter, filter_on);
    }
    ExpectSaneCommands(WithFaults(AllFaults()), filter, filter_on);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryFilter,
                         ::testing::Range<std::size_t>(0, controller::FilterKinds().size()),
                         [](const auto& kind) {
                           return std::string(controller::FilterKinds()[kind.param].name);
                         });

}  // namespace
}  // namespace gauntlet::sim
