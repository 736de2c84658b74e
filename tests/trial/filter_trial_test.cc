// Trials without a hand against a controller that is stepped tick by tick.
#include "sim/trial/filter_trial.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace gauntlet::sim {
namespace {

using controller::ControllerConfig;
using controller::FilterAt;

controller::FilterConfig Mean(int window) {
  return {controller::MovingAverageConfig{.window = window}};
}

/// Filters, guards and moments of filtering that differ.
std::vector<ControllerConfig> Controllers() {
  std::vector<ControllerConfig> configs(6);
  configs[1].filters = {Mean(20)};
  configs[2].filters = {{controller::KalmanConfig{}}};
  configs[2].filter_at = FilterAt::kEvent;
  configs[3].filters = {Mean(3)};
  configs[3].untrusted.jump_share = 0.01;
  configs[3].untrusted.jump_confirm_ms = 40.0;
  configs[4].filters = {Mean(5)};
  configs[4].filter_on = controller::FilterOn::kAngle;
  configs[4].prediction = {controller::LinearPredictionConfig{.horizon_ms = {30.0}}};
  configs[5].filters = {Mean(7)};
  configs[5].filter_at = FilterAt::kEvent;
  return configs;
}

struct Setting {
  double rate_hz = 1000.0;
  double event_period_ms = 20.0;
  controller::JointMapConfig joint_map = {};
};

class FilterTrialTest : public ::testing::Test {
 protected:
  void Prepare(const Setting& setting) {
    GloveConfig config;
    config.rate_hz = setting.rate_hz;
    config.motion.settings = RandomMotionConfig{.duration_s = 1.3};
    const LoopTiming timing = MakeLoopTiming(
        {.sample_rate_hz = setting.rate_hz, .event_period_ms = setting.event_period_ms});
    glove_ = SynthesiseGlove(config, 1);
    // One channel starts late, in the middle of a block; another one is gone for a while.
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    const auto samples = static_cast<int>(glove_.counts.rows());
    glove_.counts.col(4).head(samples / 5).setConstant(kMissing);
    glove_.counts.col(3).segment(samples / 2, samples / 3).setConstant(kMissing);
    const auto hand = std::make_shared<const HandModel>(HandConfig{}, timing);
    setups_.clear();
    for (const ControllerConfig& controller : Controllers()) {
      setups_.push_back({.controller_name = "number_" + std::to_string(setups_.size()),
                         .controller = controller,
                         .calibration = NominalCalibration(config),
                         .joint_map = setting.joint_map,
                         .hand = hand});
    }
  }

  /// What the joints are asked for at every tick, and what was not trusted.
  std::pair<Signal, std::vector<std::int64_t>> Expected(const TrialSetup& setup) const {
    const controller::TendonTransmission& hand = setup.hand->transmission();
    controller::Controller controller(setup.controller, setup.calibration, hand,
                                      setup.hand->timing().controller, setup.joint_map);
    const controller::JointMap joint_map(setup.joint_map, glove_.channel_names, hand);
    Signal angles(glove_.true_angle_rad.rows(), joint_map.joint_count());
    std::vector<double> counts(glove_.channel_names.size());
    std::vector<double> joints(hand.joint_names.size());
    for (Eigen::Index tick = 0; tick < angles.rows(); ++tick) {
      if (tick % glove_.ticks_per_sample == 0) {
        for (std::size_t c = 0; c < counts.size(); ++c) {
          counts[c] = glove_.counts(tick / glove_.ticks_per_sample, static_cast<Eigen::Index>(c));
        }
        controller.Step({.counts = counts});
      } else {
        controller.Step();
      }
      joint_map.ToJoints(controller.predicted_angle_rad(), joints);
      for (std::size_t j = 0; j < joints.size(); ++j) {
        angles(tick, static_cast<Eigen::Index>(j)) = static_cast<float>(joints[j]);
      }
    }
    const auto untrusted = controller.untrusted_samples();
    return {angles, {untrusted.begin(), untrusted.end()}};
  }

  void ExpectTheControllersBits(const Setting& setting) {
    Prepare(setting);
    std::vector<Trace> traces;
    for (const TrialSetup& setup : setups_) {
      const Trace& trace = traces.emplace_back(RunFilterTrial(setup, glove_));
      const auto [angles, untrusted] = Expected(setup);
      EXPECT_EQ(trace.hand_angle_rad, angles) << setup.controller_name;
      EXPECT_EQ(trace.untrusted_samples, untrusted) << setup.controller_name;
      EXPECT_EQ(trace.controller_name, setup.controller_name);
    }
    EXPECT_NE(traces[0].hand_angle_rad, traces[1].hand_angle_rad);
    EXPECT_NE(traces[1].hand_angle_rad, traces[3].hand_angle_rad);
    EXPECT_NE(traces[0].untrusted_samples, traces[3].untrusted_samples);
  }

  GloveSignal glove_;
  std::vector<TrialSetup> setups_;
};

TEST_F(FilterTrialTest, GivesWhatTheControllerGives) { ExpectTheControllersBits({}); }

TEST_F(FilterTrialTest, SamplesComeSeldomAndFramesAtFractionsOfThem) {
  ExpectTheControllersBits({.rate_hz = 100.0, .event_period_ms = 7.3});
  EXPECT_GT(glove_.ticks_per_sample, 1);
  ExpectTheControllersBits({.rate_hz = 33.3, .event_period_ms = 20.0});
}

TEST_F(FilterTrialTest, JointsMayFollowOtherChannels) {
  controller::JointMapConfig joint_map;
  joint_map.joints = {{.joint = "index_mcp",
                       .channels = {"middle_mcp", "ring_mcp"},
                       .weights = {0.5},
                       .offset_deg = 3.0},
                      {.joint = "thumb_ip", .channels = {}, .offset_deg = 10.0}};
  ExpectTheControllersBits({.joint_map = joint_map});
}

}  // namespace
}  // namespace gauntlet::sim
