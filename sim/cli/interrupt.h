#pragma once

namespace gauntlet::sim {

/// From now on the first Ctrl-C (or SIGTERM) asks long work to stop; a second one ends the program
/// at once, without leaving temporary files.
void CatchInterrupts();

/// From now on Ctrl-C and SIGTERM end the program at once, as they do any that has nothing to tidy.
void EndAtInterrupts();

/// Whether somebody pressed Ctrl-C.
bool Interrupted();

}  // namespace gauntlet::sim
