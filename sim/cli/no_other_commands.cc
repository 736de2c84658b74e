#include "sim/cli/commands.h"

namespace gauntlet::sim {

std::vector<Command> OtherCommands() { return {}; }

}  // namespace gauntlet::sim
