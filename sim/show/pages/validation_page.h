#pragma once

#include <string>

#include "sim/fit/validation.h"

namespace gauntlet::sim {

/// Findings of gauntlet identify --validate as a page without scripts: the table of the terminal,
/// and for each part the measured angle beside the simulated one where it moves most, and their
/// difference.
std::string ValidationPage(const Validation& validation);

}  // namespace gauntlet::sim
