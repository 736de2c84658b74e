#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace gauntlet::test {

/// A fresh folder in which a program runs, with its files. It goes away at the end of the scope.
class WorkingFolder {
 public:
  explicit WorkingFolder(std::string program,
                         std::chrono::milliseconds timeout = std::chrono::minutes(5));

  ProgramResult Run(std::vector<std::string> arguments) const;
  std::filesystem::path path() const { return folder_.path(); }
  /// The place of a file in it.
  std::filesystem::path In(const std::string& name) const { return path() / name; }
  void Write(const std::string& name, const std::string& text) const;
  std::string Read(const std::string& name) const;

 private:
  std::string program_;
  std::chrono::milliseconds timeout_;
  TemporaryDirectory folder_;
};

}  // namespace gauntlet::test
