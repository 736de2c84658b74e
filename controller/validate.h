#pragma once

#include <string>
#include <vector>

#include "controller/controller_config.h"
#include "controller/export.h"

namespace gauntlet::controller {

/// A problem of a robot's settings. `key`: as in its file.
struct GAUNTLET_API RobotProblem {
  std::string key;
  std::string problem;
  bool is_warning = false;  // a Controller can be made nevertheless
};

/// All problems of a robot, where the constructor of Controller names the first one; empty if there
/// is none. Parts are checked one by one, except those that need a part with a problem. Warned of:
/// a known pose of the glove that turns its joint beyond the joint's range by more than half of it,
/// which most often is an angle in degrees. Allocates.
GAUNTLET_API std::vector<RobotProblem> Validate(const RobotConfig& robot);

/// Line of a problem: `key: problem`, behind `warning: ` where it is one.
GAUNTLET_API std::string TextOf(const RobotProblem& problem);

}  // namespace gauntlet::controller
