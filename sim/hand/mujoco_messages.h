#pragma once

#include <string>

namespace gauntlet::sim {

/// From now on errors and warnings of the physics engine become exceptions and health reports; no
/// MUJOCO_LOG.TXT is written. Called by HandModel; safe to call twice.
void RedirectMujocoMessages();

/// The last warning of the physics engine in this thread, and forgets it. Empty if there was none.
std::string TakeMujocoWarning();

}  // namespace gauntlet::sim
