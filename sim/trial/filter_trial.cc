#include "sim/trial/filter_trial.h"

#include <algorithm>
#include <vector>

#include "sim/base/stop.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {

Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove) {
  const controller::TendonTransmission& hand = setup.hand->transmission();
  const controller::Timing& timing = setup.hand->timing().controller;
  controller::Controller controller(setup.controller, setup.calibration, hand, timing,
                                    setup.joint_map);
  const Eigen::Index ticks = glove.true_angle_rad.rows();
  const Eigen::Index channels = glove.counts.cols();
  // Blocks of ticks: a write per column and tick would touch a cache line each.
  constexpr Eigen::Index kBlockTicks = 64;
  Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block(kBlockTicks,
                                                                              channels);
  Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> counts(kBlockTicks,
                                                                               channels);
  Signal predicted_rad(ticks, channels);
  for (Eigen::Index first = 0; first < ticks; first += kBlockTicks) {
    ThrowIfStopped();
    const Eigen::Index count = std::min(kBlockTicks, ticks - first);
    const Eigen::Index per_sample = glove.ticks_per_sample;
    const Eigen::Index first_sample = (first + per_sample - 1) / per_sample;
    const Eigen::Index samples =
        std::min((first + count + per_sample - 1) / per_sample, glove.counts.rows()) - first_sample;
    counts.topRows(samples) = glove.counts.middleRows(first_sample, samples).array();
    for (Eigen::Index i = 0; i < count; ++i) {
      if ((first + i) % per_sample == 0) {
        const Eigen::Index row = (first + i) / per_sample - first_sample;
        controller.Step({.counts = {&counts(row, 0), static_cast<std::size_t>(channels)}});
      } else {
        controller.Step();
      }
      const std::span<const double> angles = controller.predicted_angle_rad();
      std::copy(angles.begin(), angles.end(), &block(i, 0));
    }
    predicted_rad.middleRows(first, count) = block.topRows(count).matrix();
  }
  Trace trace;
  trace.controller_name = setup.controller_name;
  const controller::JointMap joint_map(setup.joint_map, glove.channel_names, hand);
  trace.hand_angle_rad = ReferenceAngles(joint_map, predicted_rad);
  const auto untrusted = controller.untrusted_samples();
  trace.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  return trace;
}

}  // namespace gauntlet::sim
