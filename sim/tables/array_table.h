#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/table_pipe.h"

namespace gauntlet::sim {

/// An array of numbers in a file of arrays, as MAT, NPZ and HDF5 are.
struct NamedArray {
  /// Appends the values of the next rows.
  using NextRows = std::function<void(std::size_t rows, std::vector<double>& values)>;
  std::size_t count() const { return rows * columns; }  // of values

  std::string name;
  std::size_t rows = 0;
  std::size_t columns = 1;
  std::vector<double> values;           // row by row
  std::function<NextRows()> open = {};  // instead of values: reads them from the first row on
  std::vector<std::string> column_names = {};  // empty: name_1, name_2 ..
  std::string cell = {};      // cell, or element of a struct array, that it is in; empty: none
  std::string cells_of = {};  // the cell array or struct array of this cell
  std::vector<std::string> texts = {};  // of an array of texts, which has no values
  std::string left_out = {};  // why its values are not read, behind its name; empty: they are
  bool is_flat = true;        // of one or two dimensions
  double rate_hz = 0.0;       // of its rows, if the file notes it beside the array; 0: it does not
};

/// Hz, by the name of a lone number: a rate (`fs`, `fps`), or a period between rows (`dt`, up to
/// 0.1 in s, from 1 in ms); 0 for all others.
double RateOf(std::string_view name, double number);

/// True for the name of texts that name the columns of an array, as `sensornames` and `labels`.
bool IsNameOfNames(std::string_view name);

/// Puts a unit that is noted beside an array into the names of its columns: `deg` or `rad` of
/// numbers, and the unit of a time. Other units change nothing.
void AddUnit(NamedArray& array, std::string_view unit);

/// Gives an array that is to be read its values.
void ReadValues(NamedArray& array);

/// Order of the values of an array: the last dimension changes first, as in C, or the first one, as
/// in Fortran and MATLAB.
enum class ArrayOrder { kRows, kColumns };

/// Gives an array its values and dimensions. Rows are those of the first dimension; of three and
/// more dimensions those of the longest, if the first has at most 64. Columns are the other
/// dimensions, the last changes first: three coordinates in front of points are put behind them.
/// Shapes: as many values as the product of `shape`.
void SetValues(NamedArray& array, std::vector<double> values, std::vector<std::size_t> shape,
               ArrayOrder order);

/// Numbers of `base:increment:limit` in Octave and MATLAB: none for a range that does not end.
std::size_t CountOfRange(double base, double limit, double increment);
NamedArray RangeArray(const std::string& name, double base, double limit, double increment,
                      std::size_t count);

/// Name of a column of times with their unit: `moment` in ns is `moment_time_ns`.
std::string NameOfTimes(const std::string& name, std::string_view unit);

/// Without the arrays of texts, but with their facts: names of the columns (as in
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
/// Errors: UserError that lists all if there is none of that name, or with the reason why that one
/// is left out; one if none has two rows; one if several cells of a cell array or elements of a
/// struct array remain, which are recordings and no parts of one.
std::vector<ListedArray> ListArrays(std::vector<NamedArray> arrays, std::string_view chosen);

/// One table of the arrays that ListArrays() takes, side by side in their order. What was chosen by
/// its group has names without it, and so have times. A rate of an array, else a lone number that
/// is one by RateOf(), of the same group before others, gives the table a time, unless it has one.
/// A remark lists the arrays that are left out, unless one is chosen. Errors: as ListArrays().
void WriteTable(std::vector<NamedArray> arrays, std::string_view chosen, PipeWriter& pipe);

}  // namespace gauntlet::sim
