#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Format of a file, by its bytes; its name counts for nothing.
enum class FileFormat {
  kText,
  kUtf16,
  kBvh,      // motion of a skeleton
  kStorage,  // of OpenSim: .mot, .sto
  kTrc,      // positions of markers
  kEmpty,
  kJson,
  kNpy,
  kNpz,
  kMat,
  kHdf5,  // MAT 7.3 and trace.h5 included
  kXlsx,
  kZip,
  kGzip,
  kZstd,
  kSqlite,   // bags of ROS 2
  kRosBag,   // of ROS 1
  kRosEcho,  // printed messages
  kMcap,
  kOctave,  // text
  kParquet,
  kLfsPointer,
  kVideo,
  kC3d,  // of motion capture
  kXdf,  // of the Lab Streaming Layer
  kFbx,  // of animation
  kUrdf,
  kArrow,   // IPC and Feather
  kEdf,     // EDF and BDF of biosignals
  kTdms,    // of LabVIEW
  kWave,    // sound
  kPickle,  // objects of Python
  kXls,     // of older Excel
  kBinary,
};

/// True for the beginning of a MAT file of level 4, which has no signature: a head of five numbers
/// and the name of the first variable.
bool IsMat4(std::string_view head);
/// `head`: the first bytes of the file, some hundreds if it has as many.
FileFormat FormatOfBytes(std::string_view head);
/// data/*/*.parquet in a folder, as a data set of LeRobot has them, in the order of their names. Or
/// the files of a bag of ROS 2: those that its metadata.yaml lists, in that order; without it, .db3
/// and .mcap files in the order of their numbers.
/// Errors: UserError for a listed file that is missing, and for files of several bags.
std::vector<std::filesystem::path> DataSetFiles(const std::filesystem::path& folder);
/// Files of messages in topics: MCAP, bags of ROS 2 and printed messages.
bool HasTopics(FileFormat format);
/// Size of the file, or of its `parts`, the DataSetFiles() of a folder.
std::uintmax_t RecordingBytes(const std::filesystem::path& file,
                              const std::vector<std::filesystem::path>& parts);
/// Errors: UserError for a folder, which is no recording without DataSetFiles().
void CheckFolder(const std::filesystem::path& file);

/// As a person calls it.
std::string_view NameOf(FileFormat format);
/// As profiles call it: see ProfileFacts.
std::string_view NameInProfiles(FileFormat format);
/// Advice for a file that Gauntlet does not read, as a part of a sentence; empty if it does.
std::string_view WayOut(FileFormat format);

}  // namespace gauntlet::sim
