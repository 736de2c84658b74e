#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace gauntlet::sim {

/// A file that appears under its name only when it is whole: written beside it under a temporary
/// name, flushed to the disk, then renamed. Without Commit() the destructor removes it.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& target() const { return target_; }
  /// Where to write until Commit().
  const std::filesystem::path& temporary_path() const { return temporary_; }
  /// All of it, for who has no writer of its own. Errors: RunError.
  void Write(std::string_view content);
  /// Throws RunError if the disk did not take it.
  void Commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// A folder for new files of another one, beside which it stands under a temporary name. The
/// destructor removes it with all that is in it.
class StagingFolder {
 public:
  /// `target`: beside it, and with its name in the temporary one. Errors: RunError.
  explicit StagingFolder(const std::filesystem::path& target);
  ~StagingFolder();
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Renames every file in it to the same name in `folder`. Errors: RunError.
  void MoveTo(const std::filesystem::path& folder);

 private:
  std::filesystem::path path_;
};

/// The whole of `content` as a file. Throws RunError with the path and the system's reason.
void WriteFileAtomically(const std::filesystem::path& target, std::string_view content);

/// Makes `directory` if it is not there. Throws RunError with the path and the system's reason.
void MakeDirectory(const std::filesystem::path& directory);

/// A new folder that goes away with the temporary files if nothing else is in it then.
void RemoveIfEmptyLater(const std::filesystem::path& folder);

/// Removes every temporary file that is not yet committed, and every staging folder; safe to call
/// in a signal handler.
void RemoveUncommittedFiles() noexcept;

}  // namespace gauntlet::sim
