#pragma once

#include <vector>

#include "sim/cli/command.h"

namespace gauntlet::sim {

// Each describes its command. Errors travel as exceptions to main(), the only place that knows exit
// codes.
// Those of studies, in both programs.
Command MakeRunCommand();
Command MakeCompareCommand();
Command MakeSweepCommand();
Command MakeTuneCommand();
Command MakeRobustCommand();
Command MakeRenderCommand();
Command MakeExportCommand();
Command MakeDiffCommand();
Command MakeReportCommand();
Command MakeShowCommand();
Command MakeCleanCommand();
Command MakeInspectCommand();
Command MakeFilterCommand();
Command MakeListCommand();
Command MakeDoctorCommand();

// The others.
Command MakeCalibrateCommand();
Command MakeIdentifyCommand();
Command MakeAuditCommand();
Command MakeValidateCommand();
Command MakeRetargetCommand();
Command MakeReproduceCommand();
Command MakeLiveCommand();
Command MakeGloveCommand();

/// The others; none in the program of studies alone.
std::vector<Command> OtherCommands();

}  // namespace gauntlet::sim
