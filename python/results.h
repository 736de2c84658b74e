#pragma once

#include <pybind11/pybind11.h>

#include "sim/results/result_table.h"
#include "sim/results/table_text.h"

namespace gauntlet::python {

/// Adds "text", "html" and "tables" of what a person reads, as far as it is described as a result.
void AddText(const sim::ResultText& result, const sim::ResultText& verbose, pybind11::dict& dict);

}  // namespace gauntlet::python
