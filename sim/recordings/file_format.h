#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// What a file is, by its bytes; its name counts for nothing.
enum class FileFormat {
  kText,
  kUtf16,
  kEmpty,
  kJson,
  kNpy,
  kNpz,
  kMat5,
  kHdf5,  // MAT 7.3 and trace.h5 included
  kXlsx,
  kZip,
  kGzip,
  kSqlite,  // ROS 2 bags
  kRosBag,
  kMcap,
  kParquet,
  kLfsPointer,
  kVideo,
  kUrdf,
  kBinary,
};

/// `head`: the first bytes of the file, some hundreds if it has as many.
FileFormat FormatOfBytes(std::string_view head);
/// A folder with DataSetFiles() is Parquet.
FileFormat FormatOfFile(const std::filesystem::path& file);
/// data/*/*.parquet in a folder, as a data set of LeRobot has them, in the order of their names.
std::vector<std::filesystem::path> DataSetFiles(const std::filesystem::path& folder);
/// Size of the file, or of those of a data set.
std::uintmax_t RecordingBytes(const std::filesystem::path& file);

/// As a person calls it.
std::string_view NameOf(FileFormat format);
/// What to do with a file that Gauntlet does not read, as a part of a sentence; empty if it does.
std::string_view WayOut(FileFormat format);

}  // namespace gauntlet::sim
