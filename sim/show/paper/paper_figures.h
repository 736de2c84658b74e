#pragma once

#include <string>
#include <vector>

#include "sim/show/paper/paper_experiment.h"

namespace gauntlet::sim {

struct PaperChart {
  std::string file;  // figure_12_channel_01.svg
  std::string svg;
};

/// Drawings and what is said below them.
struct PaperFigure {
  std::string name;  // figure_12
  std::string caption;
  std::vector<PaperChart> charts;
};

/// Figures 4, 7, 9, 10 and 12 of the paper.
std::vector<PaperFigure> PaperFigures(const PaperExperiment& experiment);

}  // namespace gauntlet::sim
