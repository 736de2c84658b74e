#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/output_file.h"

namespace gauntlet::sim {

/// Size and checksum of a file at the end of its run.
struct FileMark {
  std::uintmax_t bytes = 0;
  std::string checksum;  // see FastHash
  bool operator==(const FileMark&) const = default;
};

/// `manifest.json` of an output folder: the files of one command, each with size and checksum. It
/// detects damage and files of different runs. It is not a seal: a person can change a file and the
/// manifest. While files are exchanged, the manifest marks the folder as unfinished.
class Manifest {
 public:
  /// Reads the manifest of `folder`. A folder without manifest (of an earlier version, or made by
  /// hand) is accepted unchecked. Errors: UserError in one line if the folder does not exist, is
  /// marked as unfinished, or has an unreadable manifest.
  explicit Manifest(std::filesystem::path folder);

  /// False: there is no manifest, and nothing is checked.
  bool exists() const { return exists_; }
  /// See OutputPlan; empty for folders of earlier versions.
  const std::string& choices() const { return choices_; }
  /// Path of a file whose size and checksum match the manifest. Reads the whole file.
  /// Errors: UserError in one line if the file is missing or differs.
  std::filesystem::path Checked(const std::string& name) const;

 private:
  std::filesystem::path folder_;
  bool exists_ = false;
  std::string choices_;
  std::string (*checksum_of_)(const std::filesystem::path&) = nullptr;
  std::map<std::string, FileMark> files_;
};

/// The files of an output folder that Gauntlet made and that no person has changed: those of its
/// manifest, the manifest, the database of trials, video and tables. Exported controllers are not
/// among them. Reads the files. Errors: UserError for a folder without a manifest, or with one that
/// cannot be read.
std::vector<std::filesystem::path> OwnFiles(const std::filesystem::path& folder);

/// The files that a command will write into a folder.
struct OutputPlan {
  std::filesystem::path folder;
  std::string command = {};  // owner of the folder's files; see Manifest
  std::string manifest = "manifest.json";
  std::string choices = {};                // options that tell this run from others: --set a=1
  std::vector<std::string> results = {};   // known before the work begins
  std::vector<std::string> editable = {};  // results that begin with a checksum
  bool force = false;                      // replace edited ones
};

/// New files of an output folder that appear together. They are written into a temporary folder and
/// then renamed at once. If the program ends before, the folder is unchanged. If it is killed
/// during the renaming, the folder is marked as unfinished. The destructor removes files that were
/// not committed.
///
/// Files that the folder's manifest names are replaced, even if the command has read them: they are
/// results of the same command. Other inputs, results of other commands and edited files are never
/// replaced.
class OutputFiles {
 public:
  /// Errors: UserError for a planned result that must not be replaced.
  explicit OutputFiles(OutputPlan plan);

  /// Calls `write` with the temporary folder. RunErrors name the files by their final names.
  /// Errors: RunError.
  void Write(const std::function<void(const std::filesystem::path&)>& write);
  /// Renames the files and writes the manifest. Removes files of another scenario from the folder:
  /// those of its manifest, video, trace tables, exported controllers.
  /// Errors: as of the constructor, for all files; RunError.
  void Commit();

 private:
  void Check(const std::vector<std::string>& names) const;

  OutputPlan plan_;
  std::optional<StagingFolder> staging_;
};

}  // namespace gauntlet::sim
