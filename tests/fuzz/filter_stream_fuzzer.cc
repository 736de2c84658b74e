// `gauntlet filter`: the first line of an input has its arguments, the rest is standard input.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
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
  std::istringstream text(std::string(reinterpret_cast<const char*>(data), size));
  std::string line;
  std::getline(text, line);
  std::istringstream words(line);
  std::vector<std::string> arguments;  // from the last to the first, as CLI11 takes them
  for (std::string word; words >> word;) {
    if (!arguments.empty()) arguments.insert(arguments.begin(), "--set");
    arguments.insert(arguments.begin(), word);
  }
  arguments.push_back("filter");
  std::streambuf* const before = std::cin.rdbuf(text.rdbuf());
  std::cin.clear();
  try {
    CLI::App app;
    gauntlet::sim::AddFilterCommand(app);
    app.parse(arguments);
  } catch (const CLI::ParseError&) {
  } catch (const gauntlet::sim::UserError&) {
  } catch (const gauntlet::controller::SettingError&) {
  }
  std::cin.rdbuf(before);
  return 0;
}
