#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// An array of numbers in a file of arrays, as MAT, NPZ and HDF5 are.
struct NamedArray {
  std::string name;
  std::size_t rows = 0;
  std::size_t columns = 1;
  std::vector<double> values;                  // row by row
  std::vector<std::string> column_names = {};  // empty: name_1, name_2 ..
};

/// One table of text with a line of names, of arrays that belong together: of those with the same
/// number of rows, the ones that hold the most values, side by side in their order. An array with
/// far more columns than rows lies on its side. A lone number called fs, rate or the like is the
/// rate: the table begins with a time then, unless it has one.
/// Errors: UserError if there is none with two rows.
void WriteTable(std::vector<NamedArray> arrays, const std::function<void(std::string_view)>& write);

}  // namespace gauntlet::sim
