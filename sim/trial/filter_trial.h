#pragma once

#include <Eigen/Core>
#include <functional>

#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// A trial without a hand: the glove's samples go through guard, linearisation, filters, prediction
/// and joint map of the controller, and what comes out counts as what the joints did, tick by tick.
/// There are no frames, no event delay, no motors and no cables, so it takes a small part of the
/// time and its scores tell of the filter alone. `hand_angle_rad` (rounded as in RunTrial()) and
/// `untrusted_samples` are filled, other signals have no columns. Deterministic.
Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove);

/// Gets the next ticks of `hand_angle_rad`: ticks x joints.
using SeeAngles = std::function<void(const Eigen::Ref<const Eigen::MatrixXd>&)>;
/// The same for who keeps no angles: they go to `see` in blocks that stay in a core's cache, and no
/// signal has columns.
Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove, const SeeAngles& see);

}  // namespace gauntlet::sim
