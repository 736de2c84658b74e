#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "sim/base/descriptor.h"

namespace gauntlet::sim {

/// Bytes at any place of a file, which are read when they are asked for. A small file is in memory:
/// a data set has thousands of them, and a process may not have as many files open.
class FileBytes {
 public:
  /// Errors: UserError if the file cannot be opened.
  static FileBytes Of(const std::filesystem::path& file);
  explicit FileBytes(std::string bytes) : bytes_(std::move(bytes)), size_(bytes_.size()) {}

  std::uint64_t size() const { return size_; }
  /// `size` bytes from `place` on. They are in this object or in `room`, as long as both stay as
  /// they are. Errors: UserError without a place if the file ends before.
  std::string_view At(std::uint64_t place, std::size_t size, std::string& room) const;

 private:
  std::string bytes_;
  std::uint64_t size_ = 0;
  std::unique_ptr<Descriptor> file_;  // none: all is in bytes_
};

}  // namespace gauntlet::sim
