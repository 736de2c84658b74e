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
  const controller::JointMap joint_map(setup.joint_map, glove.channel_names, hand);
  Trace trace;
  trace.controller_name = setup.controller_name;
  trace.hand_angle_rad = Signal(ticks, joint_map.joint_count());
  // Blocks of ticks: a write per column and tick would touch a cache line each, and the channels'
  // angles never leave the cache.
  constexpr Eigen::Index kBlockTicks = 64;
  std::vector<double> counts(static_cast<std::size_t>(channels));
  for (Eigen::Index first = 0; first < ticks; first += kBlockTicks) {
    ThrowIfStopped();
    const Eigen::Index count = std::min(kBlockTicks, ticks - first);
    Signal predicted_rad(count, channels);
    for (Eigen::Index i = 0; i < count; ++i) {
      if ((first + i) % glove.ticks_per_sample == 0) {
        const Eigen::Index sample = (first + i) / glove.ticks_per_sample;
        for (Eigen::Index c = 0; c < channels; ++c) counts[c] = glove.counts(sample, c);
        controller.Step({.counts = counts});
      } else {
        controller.Step();
      }
      const std::span<const double> angles = controller.predicted_angle_rad();
      for (Eigen::Index c = 0; c < channels; ++c) predicted_rad(i, c) = angles[c];
    }
    trace.hand_angle_rad.middleRows(first, count) = ReferenceAngles(joint_map, predicted_rad);
    if (first % kTrimRows == 0) TrimSignals();
  }
  const auto untrusted = controller.untrusted_samples();
  trace.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  return trace;
}

}  // namespace gauntlet::sim
