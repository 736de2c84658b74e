#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "sim/trial/joint_angles.h"
#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// A trial without a hand: the glove's samples go through guard, linearisation, filters, prediction
/// and joint map of the controller, and what comes out counts as what the joints did, tick by tick.
/// There are no frames, no event delay, no motors and no cables, so it takes a small part of the
/// time and its scores tell of the filter alone. `hand_angle_rad` (rounded as in RunTrial()) and
/// `untrusted_samples` are filled, other signals have no columns. Deterministic.
Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove);

/// Gets the next ticks of `hand_angle_rad` of one of the trials, not rounded yet.
using SeeAngles =
    std::function<void(std::size_t trial, const Eigen::Ref<const AngleRows>& hand_angle_rad)>;
/// Trials of several controllers of one glove, for callers that keep no angles. The angles go to
/// `see` in blocks that stay in a core's cache, a block of each trial before the next block, and no
/// signal has columns. Trials whose guards are alike share one.
std::vector<Trace> RunFilterTrials(std::span<const TrialSetup> setups, const GloveSignal& glove,
                                   const SeeAngles& see);

}  // namespace gauntlet::sim
