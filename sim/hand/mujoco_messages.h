#pragma once

#include <string>

namespace gauntlet::sim {

/// The last warning of the physics engine in this thread, and forgets it. Empty if there was none.
std::string TakeMujocoWarning();

}  // namespace gauntlet::sim
