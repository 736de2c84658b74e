#pragma once

#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"

namespace gauntlet::sim {

/// The columns of numbers and flags of a Parquet file. A list in each row, also of lists, is an
/// array with as many columns; a row without a list, and a null, are NaN. Other columns are left
/// out, as texts, decimals of more than 64 bits and dates without a clock; times get their unit
/// behind their name.
///
/// Pages of version 1 and 2; encodings PLAIN, RLE and dictionary; not compressed, snappy, gzip or
/// zstd. Source: github.com/apache/parquet-format (README.md, Encodings.md, parquet.thrift).
/// Errors: UserError without a place: a damaged file; a column of numbers that is written in any
/// other way; lists of several lengths or shapes in one column, with the row.
std::vector<NamedArray> ReadParquet(std::string_view bytes);

}  // namespace gauntlet::sim
