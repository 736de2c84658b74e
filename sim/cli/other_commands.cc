#include "sim/cli/commands.h"

namespace gauntlet::sim {

std::vector<Command> OtherCommands() {
  return {MakeCalibrateCommand(), MakeIdentifyCommand(),  MakeAuditCommand(), MakeValidateCommand(),
          MakeRetargetCommand(),  MakeReproduceCommand(), MakeLiveCommand(),  MakeGloveCommand()};
}

}  // namespace gauntlet::sim
