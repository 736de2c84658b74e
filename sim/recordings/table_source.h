#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tables/array_table.h"
#include "sim/tables/csv_reader.h"
#include "sim/tables/file_format.h"
#include "sim/tables/json_arrays.h"
#include "sim/tables/message_table.h"
#include "sim/tables/table.h"

namespace gauntlet::sim {

/// A recording of any format that Gauntlet reads (see FileFormat), opened once.
struct OpenedTable {
  FileFormat format = FileFormat::kText;
  std::uintmax_t file_bytes = 0;
  std::vector<ListedArray> arrays = {};  // of a file with arrays, and which are in its table
  std::vector<ListedTopic> topics = {};  // of a file of messages, and which is its table
  std::optional<TableInput> table = {};  // none: no topic is taken
};

/// Reader of a text that becomes a Table; null for other formats.
using TextReader = Table (*)(const std::string& name, std::string_view text);
TextReader TextReaderOf(FileFormat format);

/// `array` chooses of a file with arrays, as in ListArrays(), or a topic of a file of messages, as
/// in ListTopics(). Keypoints of a hand become angles, see AnglesOfKeypoints().
/// Errors: UserError that says what the file is and what to do, if it is of no such format, or has
/// no arrays to choose from.
OpenedTable OpenTable(const std::filesystem::path& file, const std::string& array = {});

/// LeRobot's meta/info.json in the folder, beside the file or in a folder above it; empty if there
/// is none.
DatasetInfo DatasetInfoOf(const std::filesystem::path& file);

/// The table of OpenTable(). Errors: as there; UserError if a topic has to be chosen.
TableInput TableSource(const std::filesystem::path& file, const std::string& array = {});

/// TableSource() with keypoints of a hand as they are.
TableInput StoredTable(const std::filesystem::path& file, const std::string& array = {});

}  // namespace gauntlet::sim
