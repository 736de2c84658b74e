#pragma once

namespace gauntlet::sim {

/// From now on the first Ctrl-C (or SIGTERM) asks long work to stop; a second one ends the program
/// at once, without leaving temporary files.
void CatchInterrupts();

/// Whether somebody pressed Ctrl-C.
bool Interrupted();

}  // namespace gauntlet::sim
