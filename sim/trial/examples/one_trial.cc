// One trial: a hand, the signal of a glove, a controller between them, and the tracking error.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "sim/glove/glove.h"
#include "sim/hand/hand_model.h"
#include "sim/score/score.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/loop/hand_loop.h"

namespace controller = gauntlet::controller;
namespace sim = gauntlet::sim;

int main() {
  // The hand of models/hand_arm.xml. The glove: 3 s of random motion, its noise drawn from seed 1.
  const auto hand = std::make_shared<const sim::HandModel>(sim::HandConfig{});
  sim::GloveConfig glove;
  glove.motion.settings = sim::RandomMotionConfig{.duration_s = 3.0};
  const sim::GloveSignal signal = sim::SynthesiseGlove(glove, 1);

  // The angles that the wearer asks of the hand: ticks x joints [rad].
  const controller::JointMap joint_map({}, signal.channel_names, hand->transmission());
  const sim::Signal wearer = sim::ReferenceAngles(joint_map, signal.true_angle_rad);

  // Controller and hand as one loop. It begins in the wearer's first posture.
  controller::ControllerConfig config;
  config.filters = {{controller::KalmanConfig{.noise = {.q = {0.01}}}}};
  sim::HandLoop loop(config, sim::NominalCalibration(glove), {}, hand);
  const auto first = wearer.row(0);
  std::vector<double> posture(first.begin(), first.end());
  loop.Reset(posture);

  // The trial, in ticks of 1 ms. This glove has a sample for each; without one: loop.Step().
  sim::Signal angles(wearer.rows(), wearer.cols());
  for (Eigen::Index tick = 0; tick < angles.rows(); ++tick) {
    const auto sample = signal.counts.row(tick);
    const std::vector<double> counts(sample.begin(), sample.end());
    loop.Step({.counts = counts});
    loop.hand().ReadJointAngles(posture);
    std::ranges::copy(posture, angles.row(tick).begin());
  }

  // The score: the RMS of hand minus wearer, as the mean over the joints.
  const sim::ScoreInput input = {.reference_angle_rad = &wearer, .hand_angle_rad = &angles};
  const sim::Scores scores = sim::ComputeScores(input, {hand->joint_names(), {}, {}});
  std::printf("tracking error: %.2f deg RMS\n",
              scores.summary[sim::MetricIndex("tracking_rmse_deg")]);
}
