#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"
#include "sim/tables/file_bytes.h"

namespace gauntlet::sim {

/// An array of NumPy's NPY format, version 1 to 3: real numbers, whole numbers, flags, dates or
/// durations of any byte order, with rows and columns as of SetValues(). All others are left out.
/// Source: NEP 1, numpy/lib/format.py. Errors: UserError without a place.
NamedArray ReadNpy(std::string_view bytes, const std::string& name);

/// The arrays in an NPZ file, which is a ZIP of NPY files, stored or deflated. Source: PKWARE
/// APPNOTE 6.3. Errors: UserError without a place.
std::vector<NamedArray> ReadNpz(std::string_view bytes);

/// True for the beginning of a text that Octave saved: comments with name and type of a variable.
bool IsOctaveText(std::string_view head);

/// The numbers, matrices and ranges in such a text; those in structures have the names of their
/// fields, those in a cell array `name_2`. Other variables are left out, but for texts.
/// Source: Octave, libinterp/octave-value, save_ascii of each type.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadOctaveText(std::string_view text);

/// The columns of numbers and flags of a Parquet file. A list in each row, also of lists, is an
/// array with as many columns; a row without a list, and a null, are NaN. Other columns are left
/// out, as texts, decimals in bytes and dates without a clock; times get their unit
/// behind their name.
///
/// Pages of version 1 and 2; encodings PLAIN, RLE and dictionary; not compressed, snappy, gzip or
/// zstd. Source: github.com/apache/parquet-format (README.md, Encodings.md, parquet.thrift). Their
/// values are read with NamedArray::open, a page at a time, so memory grows neither with the file
/// nor with its row groups. Errors: UserError without a place, also later where the values are
/// read: a damaged file; a column of numbers that is written in any other way; lists of several
/// lengths or shapes in one column, with the row.
std::vector<NamedArray> OpenParquet(FileBytes bytes);
/// OpenParquet() with all values.
std::vector<NamedArray> ReadParquet(std::string_view bytes);

// Libraries read the following files. They crash or hang over some damaged ones: to be called in a
// helper process only, which opens no other file afterwards.

/// The matrices of numbers in a MAT file of MATLAB 4 to 7.2, those in structures included.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadMatArrays(const std::filesystem::path& file);

/// The datasets of numbers with at most three dimensions of an HDF5 file, MAT 7.3 included. Of a
/// `trace.h5` of Gauntlet the wearer's true angles with their time.
/// Errors: UserError without a place.
std::vector<NamedArray> ReadHdf5Arrays(const std::filesystem::path& file);

}  // namespace gauntlet::sim
