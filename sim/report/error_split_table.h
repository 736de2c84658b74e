#pragma once

#include <string>
#include <vector>

#include "sim/comparison/summary.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// The mean square error of a controller by its cause, in the order of TrackingErrorParts(): means
/// over joints and seeds [deg^2], which sum to the whole. Empty where there is no split.
std::vector<double> ErrorByCause(const ControllerSummary& controller);

/// Which share of the squared error each cause has: a row per controller that has a split.
ResultTable ErrorSplitTable(const Summary& summary);

}  // namespace gauntlet::sim
