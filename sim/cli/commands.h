#pragma once

#include "sim/cli/command.h"

namespace gauntlet::sim {

// Each describes its command. Errors travel as exceptions to main(), the only place that knows exit
// codes.
Command MakeRunCommand();
Command MakeCompareCommand();
Command MakeSweepCommand();
Command MakeTuneCommand();
Command MakeRobustCommand();
Command MakeRenderCommand();
Command MakeExportCommand();
Command MakeDiffCommand();
Command MakeReportCommand();
Command MakeInspectCommand();
Command MakeFilterCommand();
Command MakeCalibrateCommand();
Command MakeIdentifyCommand();
Command MakeValidateCommand();
Command MakeRetargetCommand();
Command MakeReproduceCommand();
Command MakeListCommand();
Command MakeLiveCommand();
Command MakeGloveCommand();
Command MakeDoctorCommand();

}  // namespace gauntlet::sim
