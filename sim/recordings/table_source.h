#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/tables/array_table.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/message_table.h"

namespace gauntlet::sim {

/// The table in a recording of any format that Gauntlet reads (see FileFormat), as text for a
/// CsvReader. `array` chooses of a file with arrays, as in ListArrays(), or a topic of a file of
/// messages, as in ListTopics().
/// Errors: UserError that says what the file is and what to do, if it is of no such format, or has
/// no arrays to choose from.
CsvReader::Source TableSource(const std::filesystem::path& file, const std::string& array = {});

/// Table as of TableSource(), but with keypoints of a hand as they are; TableSource() turns them
/// into angles, see AnglesOfKeypoints().
CsvReader::Source StoredTable(const std::filesystem::path& file, const std::string& array = {});

/// All topics of a file of messages, and which is its table; none of another file.
/// Errors: as TableSource().
std::vector<ListedTopic> TopicsIn(const std::filesystem::path& file, const std::string& topic = {});

/// All arrays of such a file, and which are in its table; none of a text, or a file of messages.
/// Errors: as TableSource().
std::vector<ListedArray> ArraysIn(const std::filesystem::path& file, const std::string& array = {});

}  // namespace gauntlet::sim
