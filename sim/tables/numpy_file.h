#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"

namespace gauntlet::sim {

/// An array of NumPy's NPY format, version 1 to 3: real numbers, whole numbers or flags of any
/// byte order; dimensions behind the first are columns.
/// Source: NEP 1, numpy/lib/format.py. Errors: UserError without a place.
NamedArray ReadNpy(std::string_view bytes, const std::string& name);

/// The arrays of numbers in an NPZ file, which is a ZIP of NPY files, stored or deflated; others
/// are left out. Source: PKWARE APPNOTE 6.3. Errors: UserError without a place.
std::vector<NamedArray> ReadNpz(std::string_view bytes);

}  // namespace gauntlet::sim
