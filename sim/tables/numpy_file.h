#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"

namespace gauntlet::sim {

/// An array of NumPy's NPY format, version 1 to 3: real numbers, whole numbers, flags, dates or
/// durations of any byte order, with rows and columns as of SetValues(). All others are left out.
/// Source: NEP 1, numpy/lib/format.py. Errors: UserError without a place.
NamedArray ReadNpy(std::string_view bytes, const std::string& name);

/// The arrays in an NPZ file, which is a ZIP of NPY files, stored or deflated. Source: PKWARE
/// APPNOTE 6.3. Errors: UserError without a place.
std::vector<NamedArray> ReadNpz(std::string_view bytes);

}  // namespace gauntlet::sim
