#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gauntlet::sim {

/// Names and units (s, ms, us, ns) of the columns of durations. Parquet has no type for them: they
/// are whole numbers there, and only the schema of Arrow beside it, a text in base64 under
/// `ARROW:schema`, has the unit. pyarrow, pandas, polars and the Parquet of Rust write it. What is
/// no such schema has none. Source: arrow/format/Schema.fbs, flatbuffers/docs/source/internals.md.
std::vector<std::pair<std::string, std::string_view>> DurationsOf(std::string_view base64);

}  // namespace gauntlet::sim
