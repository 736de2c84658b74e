#pragma once

#include <functional>
#include <memory>
#include <string>

#include "sim/glove/glove.h"
#include "sim/loop/hand_loop.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// One controller between a glove and a hand.
struct TrialSetup {
  std::string controller_name;
  controller::ControllerConfig controller;
  controller::GloveCalibration calibration;
  controller::JointMapConfig joint_map;
  std::shared_ptr<const HandModel> hand;
};

/// The one loop in which simulated time advances: glove sample -> controller -> event -> hand. It
/// begins in the posture that the wearer's first angles ask for. Deterministic: same arguments,
/// same bytes. `keep_going` is asked now and then; false stops the trial by a Cancelled exception.
Trace RunTrial(const TrialSetup& setup, const GloveSignal& glove,
               const std::function<bool()>& keep_going = {});

}  // namespace gauntlet::sim
