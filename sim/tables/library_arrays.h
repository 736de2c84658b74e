#pragma once

#include <filesystem>
#include <vector>

#include "sim/tables/array_table.h"

namespace gauntlet::sim {

/// Arrays of files that libraries read. These crash or hang over some damaged files: to be called
/// in a helper process only, which opens no other file afterwards.

/// The matrices of numbers in a MAT file of MATLAB 4 to 7.2, those in structures included.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadMatArrays(const std::filesystem::path& file);

/// The datasets of numbers with at most three dimensions of an HDF5 file, MAT 7.3 included. Of a
/// `trace.h5` of Gauntlet the wearer's true angles with their time.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadHdf5Arrays(const std::filesystem::path& file);

}  // namespace gauntlet::sim
