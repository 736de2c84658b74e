#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// The one writer of files. A file appears under its name only when it is whole: it is written
/// beside its target under a random name that did not exist before, flushed to the disk, then
/// renamed. All of this happens below the descriptor of the target's folder, so no link in that
/// folder is followed. A file that was read as an input (input_file.h), and a result that a
/// manifest beside it names (manifest.h), is never replaced.

/// An entry of a folder under a name that others cannot know. The destructor removes it unless it
/// got its final name.
class TemporaryEntry {
 public:
  enum class Kind { kFile, kFolder };
  /// Beside `target`, with its name in the temporary one. Removes what a killed program left of
  /// such entries. Errors: RunError.
  TemporaryEntry(const std::filesystem::path& target, Kind kind);
  ~TemporaryEntry();
  TemporaryEntry(const TemporaryEntry&) = delete;
  TemporaryEntry& operator=(const TemporaryEntry&) = delete;

  int descriptor() const { return entry_; }
  /// That of the folder in which the entry is.
  int folder() const { return folder_; }
  /// A path of the open entry itself, whatever has become of its name.
  const std::filesystem::path& path() const { return path_; }
  /// Flushes the file and gives it its final name. Errors: RunError.
  void Rename();
  /// A rename is on the disk only when the folder is. Not every file system can do that.
  void FlushFolder() const;

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  std::string name_;
  int folder_ = -1;
  int entry_ = -1;
  int place_ = -1;  // in the list of what a signal removes
  bool renamed_ = false;
};

/// A new file at `target`. Without Commit() the destructor removes it.
class OutputFile {
 public:
  /// Kinds of files that may be at the target. A manifest replaces itself.
  enum class Replaces { kNoResult, kResult };
  /// Errors: UserError for a target that is an input or a result; RunError.
  explicit OutputFile(std::filesystem::path target);
  OutputFile(std::filesystem::path target, Replaces replaces);

  const std::filesystem::path& target() const { return target_; }
  /// The place to write until Commit(), for a library that wants a path.
  const std::filesystem::path& temporary_path() const { return temporary_.path(); }
  /// Appends. Errors: RunError.
  void Write(std::string_view content);
  /// Errors: as of the constructor; RunError if the disk did not take it.
  void Commit();

 private:
  std::filesystem::path target_;
  TemporaryEntry temporary_;
};

/// A folder for new files of another folder, in which it stands under a temporary name. The
/// destructor removes it with all that is in it.
class StagingFolder {
 public:
  /// Errors: RunError.
  explicit StagingFolder(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return temporary_.path(); }
  /// Renames every file in it to the same name in the folder. Errors: RunError.
  void MoveUp();

 private:
  std::filesystem::path folder_;
  TemporaryEntry temporary_;
};

/// The whole of `content` as a file. Errors: as of OutputFile.
void WriteOutputFile(const std::filesystem::path& target, std::string_view content);

/// `text` for a file that people are meant to edit: in front of it a comment (# ..) with the
/// checksum of the rest.
std::string WithChecksum(std::string_view text);
/// Errors: UserError if the file at `target`, which WithChecksum() made, was edited since, or has
/// no checksum.
void RefuseEdited(const std::filesystem::path& target);
/// Writes such a file. `force`: also over an edited one. Errors: as of OutputFile and
/// RefuseEdited().
void WriteEditableFile(const std::filesystem::path& target, std::string_view text, bool force);

/// Errors: UserError if the file at `target` was read as an input.
void RefuseInput(const std::filesystem::path& target);

/// Makes `directory` if it is not there. Errors: RunError with the path and the system's reason.
void MakeDirectory(const std::filesystem::path& directory);
/// The same for a folder that `target` is to be written into.
void MakeDirectoryOf(const std::filesystem::path& target);

/// A new folder that goes away with the temporary files if nothing else is in it then.
void RemoveIfEmptyLater(const std::filesystem::path& folder);

/// Removes every temporary entry that is not yet renamed; safe to call in a signal handler.
void RemoveUncommittedFiles() noexcept;

}  // namespace gauntlet::sim
