#include "sim/trial/filter_trial.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/base/stop.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

/// Samples that begin before this tick.
Eigen::Index SamplesBefore(Eigen::Index ticks, Eigen::Index ticks_per_sample) {
  return (ticks + ticks_per_sample - 1) / ticks_per_sample;
}

}  // namespace

Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove) {
  Signal angle_rad(glove.true_angle_rad.rows(),
                   static_cast<Eigen::Index>(setup.hand->joint_names().size()));
  Eigen::Index tick = 0;
  Trace trace = RunFilterTrial(setup, glove, [&](const auto& block) {
    angle_rad.middleRows(tick, block.rows()) = block;
    if (tick % kTrimRows == 0) TrimSignals();
    tick += block.rows();
  });
  trace.hand_angle_rad = std::move(angle_rad);
  return trace;
}

Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove, const SeeAngles& see) {
  const controller::TendonTransmission& hand = setup.hand->transmission();
  const controller::Timing& timing = setup.hand->timing().controller;
  controller::Controller controller(setup.controller, setup.calibration, hand, timing,
                                    setup.joint_map);
  const Eigen::Index ticks = glove.true_angle_rad.rows();
  const Eigen::Index channels = glove.counts.cols();
  const controller::JointMap joint_map(setup.joint_map, glove.channel_names, hand);
  // Blocks of ticks: a read or write per column and tick would touch a cache line each, and the
  // channels' angles never leave the cache, in which columns of a power of two would get in each
  // other's way.
  constexpr Eigen::Index kBlockTicks = 248;
  Signal predicted_rad(kBlockTicks, channels);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> counts;
  for (Eigen::Index first = 0; first < ticks; first += kBlockTicks) {
    ThrowIfStopped();
    const Eigen::Index count = std::min(kBlockTicks, ticks - first);
    const Eigen::Index first_sample = SamplesBefore(first, glove.ticks_per_sample);
    counts.resize(SamplesBefore(first + count, glove.ticks_per_sample) - first_sample, channels);
    for (Eigen::Index c = 0; c < channels; ++c) {
      counts.col(c) = glove.counts.col(c).segment(first_sample, counts.rows());
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      if ((first + i) % glove.ticks_per_sample == 0) {
        const Eigen::Index sample = (first + i) / glove.ticks_per_sample - first_sample;
        controller.Step({.counts = {&counts(sample, 0), static_cast<std::size_t>(channels)}});
      } else {
        controller.Step();
      }
      const std::span<const double> angles = controller.predicted_angle_rad();
      for (Eigen::Index c = 0; c < channels; ++c) predicted_rad(i, c) = angles[c];
    }
    predicted_rad.KeepRows(count);
    see(ReferenceAngles(joint_map, predicted_rad));
  }
  Trace trace;
  trace.controller_name = setup.controller_name;
  const auto untrusted = controller.untrusted_samples();
  trace.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  return trace;
}

}  // namespace gauntlet::sim
