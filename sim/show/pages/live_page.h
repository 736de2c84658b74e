#pragma once

#include <string>
#include <vector>

#include "sim/live/live_session.h"
#include "sim/study/study.h"

namespace gauntlet::sim {

/// The page of a running session: the hand with the wearer's posture and that of a second
/// controller, running scores, the last seconds of the curves, the time of the stages, queues and
/// watchdog, and the choice of the controller. It has no measurements of its own:
/// `GET events` gives them, `POST switch` asks for a controller and `POST mark` marks that the hand
/// is still, all beside the page and with the token of its address. Scripts bear `nonce`, for the
/// content security policy. `recording`: file of the samples, empty if there is none.
std::string LivePage(const Study& study, const LiveSetup& setup, const std::string& recording,
                     const std::string& nonce);

}  // namespace gauntlet::sim
