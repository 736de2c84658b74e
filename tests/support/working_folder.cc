#include "tests/support/working_folder.h"

#include <fstream>
#include <utility>

#include "tests/support/read_file.h"

namespace gauntlet::test {

WorkingFolder::WorkingFolder(std::string program, std::chrono::milliseconds timeout)
    : program_(std::move(program)), timeout_(timeout) {}

ProgramResult WorkingFolder::Run(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), program_);
  return RunProgram(arguments, {.working_directory = path(), .timeout = timeout_});
}

void WorkingFolder::Write(const std::string& name, const std::string& text) const {
  std::ofstream(In(name)) << text;
}

std::string WorkingFolder::Read(const std::string& name) const { return ReadFile(In(name)); }

}  // namespace gauntlet::test
