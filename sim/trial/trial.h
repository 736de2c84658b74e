#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/glove/glove.h"
#include "sim/trial/loop/hand_loop.h"
#include "sim/trial/trace.h"

namespace gauntlet::sim {

/// One controller between a glove and a hand.
struct TrialSetup {
  std::string controller_name;
  controller::ControllerConfig controller;
  controller::GloveCalibration calibration;
  controller::JointMapConfig joint_map;
  std::shared_ptr<const HandModel> hand;
  LoopLinks links = {};
};

struct TrialOptions {
  std::function<bool()> keep_going = {};       // asked now and then; false throws Cancelled
  std::vector<std::string_view> signals = {};  // to record, of ForEachSignal(); none named: all
};

/// The angles that the controller takes the glove's first samples for: a hand that already follows
/// begins in their posture. The wearer's own would be an advantage for a filter that keeps it
/// still. Shape: 1 x channels. Units: rad.
Signal FirstAngles(const TrialSetup& setup, const GloveSignal& glove);

/// The one loop in which simulated time advances: glove sample -> controller -> event -> hand. It
/// begins in the posture of FirstAngles(). Deterministic: same arguments,
/// same bytes; what is recorded changes none of them. A filter that is a program or an object and
/// fails ends the trial as a hand does that diverges. Errors: SettingError, as of TrialPrograms;
/// std::invalid_argument for a signal that there is not (the caller's mistake).
Trace RunTrial(const TrialSetup& setup, const GloveSignal& glove, const TrialOptions& options = {});

}  // namespace gauntlet::sim
