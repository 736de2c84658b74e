#pragma once

#include <string>
#include <vector>

#include "sim/show/paper/paper_experiment.h"

namespace gauntlet::sim {

struct PaperChart {
  std::string file;  // figure_12_channel_01.svg
  std::string svg;
  bool is_extra = false;  // shown when asked for
};

/// Drawings and what is said below them.
struct PaperFigure {
  std::string name;  // figure_12
  std::string caption;
  std::vector<PaperChart> charts;
  std::string extra_title = {};  // of those that are shown when asked for
};

/// Figures 4, 7, 9, 10 and 12 of the paper.
std::vector<PaperFigure> PaperFigures(const PaperExperiment& experiment);

}  // namespace gauntlet::sim
