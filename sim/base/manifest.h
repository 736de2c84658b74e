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

/// Size and checksum of a file, as its run wrote it.
struct FileMark {
  std::uintmax_t bytes = 0;
  std::string checksum;  // see FastHash
  bool operator==(const FileMark&) const = default;
};

/// `manifest.json` of an output folder: the files that one command wrote, each with size and
/// checksum, so that damage and a mixture of runs are seen. It is no seal: a person who changes a
/// file on purpose can change the manifest, too. While files are exchanged it says that the folder
/// is unfinished.
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

/// The files that a command is going to write into a folder.
struct OutputPlan {
  std::filesystem::path folder;
  std::string command = {};  // the folder's files belong to it; see Manifest
  std::string manifest = "manifest.json";
  std::vector<std::string> results = {};   // names that are known before the work begins
  std::vector<std::string> editable = {};  // names of those among them that begin with a checksum
  bool force = false;                      // replaces edited ones
};

/// New files of an output folder, which all appear together: written into a folder inside it, then
/// renamed one after the other in a moment. A program that ends before leaves the folder as it was;
/// one that is killed in that moment leaves it marked as unfinished. The destructor removes what
/// was not committed.
///
/// Files of the folder that its manifest names are replaced, also where the command has read them:
/// they are its own results. No other input is, nor what another command wrote, nor an edited file.
class OutputFiles {
 public:
  /// Errors: UserError for a planned result that would replace what it must not.
  explicit OutputFiles(OutputPlan plan);

  /// Lets `write` fill the folder that it gets. Its RunErrors name the files as they will be
  /// called. Errors: RunError.
  void Write(const std::function<void(const std::filesystem::path&)>& write);
  /// Renames them and writes the manifest. What the folder held of another scenario (files of its
  /// manifest, video, trace tables, exported controllers) is removed.
  /// Errors: as of the constructor, for all files; RunError.
  void Commit();

 private:
  void Check(const std::vector<std::string>& names) const;

  OutputPlan plan_;
  std::optional<StagingFolder> staging_;
};

}  // namespace gauntlet::sim
