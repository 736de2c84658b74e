#include "sim/cli/shared_options.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "controller/number.h"
#include "sim/base/data_folder.h"
#include "sim/cli/standard_streams.h"

namespace gauntlet::sim {
namespace {

constexpr int kUsualWidth = 80;
constexpr int kNarrowest = 40;     // less is taken for a mistake of the terminal
constexpr int kLongestText = 100;  // longer lines are hard to read

std::string_view Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

int TerminalWidth() {
  constexpr int kWidest = 1'000'000;
  int width = controller::ParseWholeNumber(Environment("COLUMNS"), 1, kWidest).value_or(0);
  winsize size{};
  if (width <= 0 && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0) width = size.ws_col;
  return width <= 0 ? kUsualWidth : std::max(width, kNarrowest);
}

}  // namespace

std::string ProblemOfPath(const std::string& path) {
  return path.empty() ? "is empty, must be a path" : "";
}

Option Argument(std::string name, std::string* variable, Offer offer, std::string help) {
  return Option(std::move(name), variable, {.offer = offer, .required = true}, std::move(help));
}

std::string ScenarioFile(const std::string& given) {
  return ReadyFile(given, "scenarios", "scenario");
}

Option ScenarioArgument(std::string& file) {
  const auto find = [](std::string& text) {
    text = ScenarioFile(text);
    return std::string();
  };
  return Option("scenario", &file, {.offer = Offer::kScenarios, .required = true, .check = find},
                "scenario file (YAML), or the name of a ready one (gauntlet list scenarios)");
}

Option SetOption(std::vector<std::string>& overrides, const std::string& help) {
  return Option("--set", &overrides, {.value = "key=value", .offer = Offer::kScenarioKeys}, help);
}

Option ControllersOption(std::vector<std::string>& names) {
  return Option("--controllers", &names, {.offer = Offer::kControllers, .separator = ','},
                "only these, separated by commas");
}

Option JobsOption(int& jobs) {
  return Option("--jobs", &jobs, {.range = {1, 1024}}, "trials at a time [number of cores]");
}

Option AllowProgramsOption(bool& allow) {
  return Option("--allow-programs", &allow, {},
                "run the programs that the scenario names as filters (kind external)");
}

Option OutOption(std::string& out, const std::string& help, const std::string& value) {
  return Option("--out", &out,
                {.value = value,
                 .offer = value == "DIR" ? Offer::kFolders : Offer::kFiles,
                 .shows_default = !out.empty(),
                 .check = ProblemOfPath},
                help);
}

Option ForceOption(bool& force) {
  return Option("--force", &force, {},
                "also replace files that were edited since they were written");
}

Options ArrayOptions(std::string& array) {
  return {Option("--array", &array, {.value = "NAME"},
                 "array, or group of arrays, of a file with several [arrays of equal length with "
                 "the most values]"),
          Option("--topic", &array, {.value = "NAME", .excludes = {"--array"}},
                 "topic of MCAP or of a ROS 2 bag [the only one with signals]")};
}

Options TopicPairOptions(std::string& command, std::string& state) {
  return {Option("--command", &command, {.value = "TOPIC", .excludes = {"--array", "--topic"}},
                 "topic of MCAP or of a ROS 2 bag with the commands [by name and type]"),
          Option("--state", &state, {.value = "TOPIC", .excludes = {"--array", "--topic"}},
                 "topic with the measured angles [a JointState named state]")};
}

Option TimeUnitOption(std::string& unit, std::vector<std::string> excludes) {
  return Option("--time-unit", &unit,
                {.choices = {"s", "ms", "us", "ns"}, .excludes = std::move(excludes)},
                "unit of the time [by the file]");
}

Option UnitOption(std::string& unit, std::vector<std::string> units, const std::string& help,
                  std::vector<std::string> excludes) {
  return Option("--unit", &unit, {.choices = std::move(units), .excludes = std::move(excludes)},
                help);
}

TerminalStyle StyleOf(const TerminalOptions& options) {
  const std::size_t width = TerminalWidth();
  const bool coloured_terminal = isatty(STDOUT_FILENO) != 0 && Environment("NO_COLOR").empty();
  return {.width = std::min<std::size_t>(width, kLongestText),
          .table_width = options.wide ? TerminalStyle::kNoLimit : width,
          .colour = options.colour == "always" || (options.colour == "auto" && coloured_terminal)};
}

std::optional<std::filesystem::path> FindProgram(const std::string& name) {
  std::istringstream folders{std::string(Environment("PATH"))};
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path program = std::filesystem::path(folder) / name;
    if (access(program.c_str(), X_OK) == 0) return program;
  }
  return std::nullopt;
}

void PrintIndented(const std::string& text) {
  constexpr std::size_t kIndent = 4;
  const std::size_t width =
      isatty(STDOUT_FILENO) != 0 ? StyleOf({}).width : TerminalStyle::kNoLimit;
  std::string lines = Wrapped(text, width - kIndent - kIndent);
  for (std::size_t end = 0; (end = lines.find('\n', end)) != std::string::npos;) {
    lines.insert(++end, 2 * kIndent, ' ');
  }
  Print("{}{}\n", std::string(kIndent, ' '), lines);
}

}  // namespace gauntlet::sim
