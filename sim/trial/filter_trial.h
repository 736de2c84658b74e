#pragma once

#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// A trial without a hand: the glove's samples go through guard, linearisation, filters, prediction
/// and joint map of the controller, and what comes out counts as what the joints did, tick by tick.
/// There are no frames, no event delay, no motors and no cables, so it takes a small part of the
/// time and its scores tell of the filter alone. `hand_angle_rad` (rounded as in RunTrial()) and
/// `untrusted_samples` are filled, other signals have no columns. Deterministic.
Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove);

}  // namespace gauntlet::sim
