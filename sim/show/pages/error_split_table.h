#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/results/result_table.h"

namespace gauntlet::sim {

/// The mean square error of a controller by its cause, in the order of TrackingErrorParts(): means
/// over joints and the seeds whose causes were found [deg^2], which sum to the whole. NaN for a
/// cause that could not be taken away; empty where none was.
std::vector<double> ErrorByCause(const ControllerSummary& controller);

/// The causes that tables and pages show, as places in TrackingErrorParts(): those of links only
/// where a controller has a value.
std::vector<std::size_t> ShownCauses(const Summary& summary);

/// Share of each cause in the squared error: a row per controller whose causes are known.
ResultTable ErrorSplitTable(const Summary& summary);
/// Meaning of these shares; empty where there are none.
std::string SharesNote(const Summary& summary);

/// Tracking error with all causes, and with each cause switched off alone: a row per controller
/// of which such trials ran.
ResultTable SwitchedTable(const Summary& summary);

/// "Tracking error of raw without the servo: 3.69 deg in place of 6.97; without the link: 4.95
/// (first seed).", the largest difference first. Of the baseline, else of the first in the order of
/// the answer that has values. The way to ask for it where it was left out; else empty.
std::string CausesText(const Summary& summary);

}  // namespace gauntlet::sim
