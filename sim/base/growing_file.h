#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim/base/descriptor.h"

namespace gauntlet::sim {

/// A file of lines that cannot be made again: it has its name from the start, its lines reach the
/// disk as they come, and it stays however the program ends. It replaces nothing. What a disk does
/// not take is kept in memory, up to `kMostWaitingBytes`, and tried again at each Flush().
class GrowingFile {
 public:
  static constexpr std::size_t kMostWaitingBytes = std::size_t{4} << 20;

  /// Errors: UserError if `target` exists; RunError.
  explicit GrowingFile(std::filesystem::path target);
  /// Ends the file behind its last whole line. A file without lines is removed.
  ~GrowingFile() { End(); }

  const std::filesystem::path& target() const { return target_; }
  /// Appends a line, which has its end. False: there is no room for it.
  bool Add(std::string_view line);
  /// Brings the lines to the disk, as far as it takes them.
  void Flush();
  /// Ends the file as the destructor does.
  void End();
  /// Lines that the disk has taken.
  std::int64_t lines() const { return lines_; }
  /// "FILE: cannot write: reason"; empty if the disk has all lines.
  const std::string& problem() const { return problem_; }
  /// Removes the file and what is in it.
  void Remove();

 private:
  void Fail(std::string_view action, int error);

  std::filesystem::path target_;
  Descriptor folder_;
  Descriptor file_;
  std::string waiting_;      // whole lines
  std::size_t written_ = 0;  // of the first of them, less than a line
  std::int64_t lines_ = 0;
  bool may_lack_lines_ = false;  // the system took them, the disk perhaps not
  std::string problem_;
};

}  // namespace gauntlet::sim
