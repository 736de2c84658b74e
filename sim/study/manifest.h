#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "sim/base/atomic_file.h"

namespace gauntlet::sim {

/// Size and checksum of a file, as its run wrote it.
struct FileMark {
  std::uintmax_t bytes = 0;
  std::string checksum;  // see FastHash
  bool operator==(const FileMark&) const = default;
};

/// `manifest.json` of an output folder: which files one run wrote, each with size and checksum, so
/// that damage and a mixture of runs are seen. It is no seal: whoever changes a file on purpose can
/// change the manifest, too. While files are exchanged it says that the folder is unfinished.
class Manifest {
 public:
  /// Reads that of `folder`. A folder without one, of an earlier version or put together by hand,
  /// is taken as it is. Errors: UserError in one line if the folder does not exist, was left while
  /// its files were exchanged, or if its manifest cannot be read.
  explicit Manifest(std::filesystem::path folder);

  /// False: there is no manifest, so nothing is checked.
  bool exists() const { return exists_; }
  /// The path of a file of the folder that is as its run wrote it. Costs the reading of the file.
  /// Errors: UserError in one line if it is missing or another.
  std::filesystem::path Checked(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  bool exists_ = false;
  std::string (*checksum_of_)(const std::filesystem::path&) = nullptr;
  std::map<std::string, FileMark> files_;
};

/// New files of an output folder, which all appear together: written into a folder inside it, then
/// renamed one after the other in a moment. A program that ends before leaves the folder as it was;
/// one that is killed in that moment leaves it marked as unfinished. The destructor removes what
/// was not committed.
class OutputFiles {
 public:
  /// Errors: RunError.
  explicit OutputFiles(const std::filesystem::path& folder);

  /// Where they are until Commit().
  const std::filesystem::path& path() const { return staging_.path(); }
  /// Lets `write` fill the folder that it gets. Its RunErrors name the files as they will be
  /// called.
  void Write(const std::function<void(const std::filesystem::path&)>& write);
  /// Renames them and writes the manifest. Video, trace tables and exported controllers of another
  /// scenario, which the folder held before, are removed. Errors: RunError.
  void Commit();

 private:
  std::filesystem::path folder_;
  StagingFolder staging_;
};

}  // namespace gauntlet::sim
