#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "sim/results/result_table.h"
#include "sim/results/table_text.h"

namespace gauntlet::python {

/// {"columns": [(key, heading, unit)], "rows": [{..}], "text": .., "html": ..}: rows have the names
/// and values of CSV; None for what is not there.
pybind11::dict DictOf(const sim::ResultTable& table);

/// Adds "text", "html" and "tables" of what a person reads, as far as it is described as a result.
void AddText(const sim::ResultText& result, const sim::ResultText& verbose, pybind11::dict& dict);

}  // namespace gauntlet::python
