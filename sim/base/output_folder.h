#pragma once

#include <filesystem>
#include <vector>

#include "sim/base/descriptor.h"

namespace gauntlet::sim {

/// A folder for results, made before long work begins so that an unwritable place is found at once.
/// If the work fails and the folder is new and empty, it goes away again. Two programs that wrote
/// into one folder would mix their results, so it is locked until the object or the program ends.
/// Errors: UserError for a path that is not a folder; RunError with the path and the system's
/// reason, or when another program writes there.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path path);
  ~OutputFolder();

  const std::filesystem::path& path() const { return path_; }
  void Keep() { keep_ = true; }

 private:
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  // folders that were not there before, inside out
  Descriptor lock_;
  bool keep_ = false;
};

}  // namespace gauntlet::sim
