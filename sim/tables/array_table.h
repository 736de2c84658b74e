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
  std::string cells_of = {};                   // the cell array that it is a cell of; empty: none
  std::vector<std::string> texts = {};         // of an array of texts, which has no values
};

/// Only the arrays of numbers, with what the texts beside them tell: names of the columns (as in
/// `sensornames`, one for each) and the unit (`rad` in `angleunit`) behind the names.
std::vector<NamedArray> WithFacts(std::vector<NamedArray> arrays);

/// One of a file's arrays, and whether it is in the table that WriteTable() makes of them.
struct ListedArray {
  std::string name;
  std::size_t rows = 0;
  std::size_t columns = 0;
  bool is_taken = false;
};

/// `name (rows x columns)`, of many the first ones.
std::string TextOf(const std::vector<ListedArray>& arrays);

/// Which arrays belong together: of those with the same number of rows, the ones that hold the most
/// values. An array with far more columns than rows lies on its side.
///
/// `chosen` is the name of an array or, if there is none, of a group, with which the names of its
/// arrays begin; `/` and `.` count as `_`. Then only these are taken and, unless one of them is a
/// time, times with as many rows: those of the same group, or else the first.
/// Errors: UserError that lists all if there is none of that name; one if none has two rows; one if
/// several cells of a cell array are left, which are recordings and no parts of one.
std::vector<ListedArray> ListArrays(const std::vector<NamedArray>& arrays, std::string_view chosen);

/// One table of text with a line of names, of the arrays that ListArrays() takes, side by side in
/// their order. What was chosen by its group has names without it, and so have times. A lone number
/// called fs, rate or the like is the rate, one called frame_duration or the like its inverse (up
/// to 0.1 in s, from 1 in ms): the table begins with a time then, unless it has one.
/// Errors: as ListArrays().
void WriteTable(std::vector<NamedArray> arrays, std::string_view chosen,
                const std::function<void(std::string_view)>& write);

}  // namespace gauntlet::sim
