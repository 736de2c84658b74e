#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// The mean square error of a controller by its cause, in the order of TrackingErrorParts(): means
/// over joints and the seeds whose causes were found [deg^2], which sum to the whole. NaN for a
/// cause that could not be taken away; empty where none was.
std::vector<double> ErrorByCause(const ControllerSummary& controller);

/// The causes that tables and pages show, as places in TrackingErrorParts(): those of links only
/// where a controller has a value.
std::vector<std::size_t> ShownCauses(const Summary& summary);

/// Which share of the squared error each cause has: a row per controller whose causes are known.
ResultTable ErrorSplitTable(const Summary& summary);

/// Says where the causes are those of one seed of several; else empty.
std::string CausesNote(const Summary& summary);

}  // namespace gauntlet::sim
