#pragma once

#include <string>
#include <vector>

#include "sim/show/paper/paper_experiment.h"
#include "sim/show/paper/paper_figures.h"

namespace gauntlet::sim {

/// One self-contained page that a reader of the paper can hold beside it.
std::string PaperPage(const PaperExperiment& experiment, const std::vector<PaperFigure>& figures);

/// The claims with their numbers, for a person at a terminal.
std::string PaperTable(const PaperExperiment& experiment);

}  // namespace gauntlet::sim
