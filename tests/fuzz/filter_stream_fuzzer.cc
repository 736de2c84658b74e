// `gauntlet filter`: the first line of an input has its arguments, the rest is standard input and,
// behind a byte of zero, a column map.
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "controller/settings.h"
#include "sim/base/error.h"
#include "sim/cli/commands.h"

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  // The fuzzer itself keeps the standard error that it has taken before.
  stderr = std::fopen("/dev/null", "w");
  return std::freopen("/dev/null", "w", stdout) != nullptr && stderr != nullptr ? 0 : 1;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string input(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(input.find('\0'), size);
  std::istringstream text(input.substr(0, end));
  std::string line;
  std::getline(text, line);
  std::istringstream words(line);
  std::vector<std::string> arguments = {"gauntlet", "filter"};
  for (std::string word; words >> word;) {
    const bool is_setting = arguments.size() > 2 && !word.starts_with("--columns=");
    if (is_setting) arguments.emplace_back("--set");
    arguments.push_back(word);
  }
  if (end < size) {
    static const std::string map =
        "/dev/shm/gauntlet_fuzz_filter_" + std::to_string(getpid()) + ".csv";
    std::ofstream(map, std::ios::binary) << input.substr(end + 1);
    arguments.push_back("--map=" + map);
  }
  std::streambuf* const before = std::cin.rdbuf(text.rdbuf());
  std::cin.clear();
  try {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    const std::vector<gauntlet::sim::Command> commands = {gauntlet::sim::MakeFilterCommand()};
    const gauntlet::sim::Command program{
        .name = "gauntlet", .purpose = {}, .options = {}, .run = {}, .notes = {}};
    const auto* command = gauntlet::sim::ReadCommandLine(
        program, commands, static_cast<int>(argv.size()), argv.data());
    if (command != nullptr) command->run();
  } catch (const gauntlet::sim::UserError&) {
  } catch (const gauntlet::controller::SettingError&) {
  }
  std::cin.rdbuf(before);
  return 0;
}
