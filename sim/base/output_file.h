#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sim/base/descriptor.h"

namespace gauntlet::sim {

/// The only writer of files that can be made again (others: growing_file.h). A file appears under
/// its name when it is complete: it is written beside its target under a random new name, flushed
/// to the disk, then renamed. All steps use the descriptor of the target's folder, so no link in
/// that folder is followed. A registered input (input_file.h), a result that a manifest names
/// (manifest.h), a device and a pipe are never replaced.

/// A file or folder under a temporary name that others cannot guess. The destructor removes it
/// unless Rename() was called.
class TemporaryEntry {
 public:
  enum class Kind { kFile, kFolder };
  /// Makes the entry beside `target`; its name begins with that of the target. Removes such entries
  /// of killed programs. Errors: RunError.
  TemporaryEntry(const std::filesystem::path& target, Kind kind);
  ~TemporaryEntry();

  int descriptor() const { return entry_.get(); }
  /// Descriptor of the folder that contains the entry.
  int folder() const { return folder_.get(); }
  /// Path through the open descriptor; it stays valid if the name changes.
  const std::filesystem::path& path() const { return path_; }
  /// Flushes the file and gives it its final name. Errors: RunError.
  void Rename();
  /// Flushes the folder, so that the rename is on the disk. Some file systems cannot do this.
  void FlushFolder() const;

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  std::string name_;
  Descriptor folder_;
  Descriptor entry_;
  int place_ = -1;  // slot in the list for the signal handler
  bool renamed_ = false;
};

/// A new file at `target`. Without Commit() the destructor removes it.
class OutputFile {
 public:
  /// Permission to replace a result. A manifest replaces itself.
  enum class Replaces { kNoResult, kResult };
  /// Errors: UserError for a target that is an input or a result; RunError.
  explicit OutputFile(std::filesystem::path target);
  OutputFile(std::filesystem::path target, Replaces replaces);

  const std::filesystem::path& target() const { return target_; }
  /// Place to write until Commit(), for a library that needs a path.
  const std::filesystem::path& temporary_path() const { return temporary_.path(); }
  /// Appends. Errors: RunError.
  void Write(std::string_view content);
  /// Errors: as of the constructor; RunError if the disk did not take it.
  void Commit();

 private:
  std::filesystem::path target_;
  TemporaryEntry temporary_;
};

/// A temporary folder inside another folder, for its new files. The destructor removes it with its
/// content.
class StagingFolder {
 public:
  /// Errors: RunError.
  explicit StagingFolder(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return temporary_.path(); }
  /// Moves every file in it into the folder, under the same name. Errors: RunError.
  void MoveUp();

 private:
  std::filesystem::path folder_;
  TemporaryEntry temporary_;
};

/// Writes `content` as a file. Errors: as of OutputFile.
void WriteOutputFile(const std::filesystem::path& target, std::string_view content);

/// `text` for a file that people may edit, with a first line (# ..) that contains the checksum of
/// the rest.
std::string WithChecksum(std::string_view text);
/// Errors: UserError if the file at `target` has no checksum line, or was edited since
/// WithChecksum().
void RefuseEdited(const std::filesystem::path& target);
/// Writes such a file. `force`: also over an edited file. Errors: as of OutputFile and
/// RefuseEdited().
void WriteEditableFile(const std::filesystem::path& target, std::string_view text, bool force);

/// Errors: UserError if the file at `target` is a registered input.
void RefuseInput(const std::filesystem::path& target);

/// Makes `directory` if it does not exist. Errors: RunError with the path and the system's reason.
void MakeDirectory(const std::filesystem::path& directory);
/// Makes the folder of `target` if it does not exist. Errors: as of MakeDirectory().
void MakeDirectoryOf(const std::filesystem::path& target);

/// Registers a new folder. RemoveUncommittedFiles() removes it if it is empty by then.
void RemoveIfEmptyLater(const std::filesystem::path& folder);

/// Removes every temporary entry that is not yet renamed; safe to call in a signal handler.
void RemoveUncommittedFiles() noexcept;

}  // namespace gauntlet::sim
