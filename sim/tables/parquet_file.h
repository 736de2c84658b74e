#pragma once

#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"

namespace gauntlet::sim {

/// The columns of numbers and flags of a Parquet file. A list in each row is an array with as many
/// columns; a row without a list, and a null, are NaN. Texts, dates without a clock and lists of
/// lists are left out; times get their unit behind their name.
///
/// Pages of version 1 and 2; encodings PLAIN, RLE and dictionary; not compressed, snappy, gzip or
/// zstd. Source: github.com/apache/parquet-format (README.md, Encodings.md, parquet.thrift).
/// Errors: UserError without a place: a damaged file; a column of numbers that is written in any
/// other way; lists of several lengths in one column, with the row.
std::vector<NamedArray> ReadParquet(std::string_view bytes);

}  // namespace gauntlet::sim
