#pragma once

#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {

/// Text in UTF-16 with its byte order mark, as spreadsheets write "Unicode text", in UTF-8. What is
/// no character becomes U+FFFD.
CsvReader::Source Utf8Of(CsvReader::Source utf16);

}  // namespace gauntlet::sim
