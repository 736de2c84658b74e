#pragma once

#include <memory>

#include "sim/trial/external/command_words.h"
#include "sim/trial/external/program.h"
#include "sim/trial/external/stepper.h"

namespace gauntlet::sim {

/// Starts the program of an external filter. `limit`: the longest wait for an answer.
///
///     -> {"rate_hz": 1e3, "channel_count": 2, "channels": ["a", "b"], "parameters": {"x": 0.1}}
///     -> 512,498.25
///     <- 512,498.25      and so on, a line for a line
///
/// Errors: as of Program.
std::unique_ptr<Stepper> StartProgram(const ProgramCommand& command, const FilterFacts& facts,
                                      Program::Duration limit);

}  // namespace gauntlet::sim
