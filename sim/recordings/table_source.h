#pragma once

#include <filesystem>

#include "sim/recordings/csv_reader.h"

namespace gauntlet::sim {

/// The table in a recording of any format that Gauntlet reads (see FileFormat), as text for a
/// CsvReader.
/// Errors: UserError that says what the file is and what to do, if it is of no such format.
CsvReader::Source TableSource(const std::filesystem::path& file);

}  // namespace gauntlet::sim
