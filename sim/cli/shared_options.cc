#include "sim/cli/shared_options.h"

#include <algorithm>
#include <filesystem>
#include <thread>

#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"

namespace gauntlet::sim {
namespace {

std::string ProblemOfPath(const std::string& path) {
  return path.empty() ? "is empty, must be a path" : "";
}

}  // namespace

Option Argument(std::string name, std::string* variable, Offer offer, std::string help) {
  return Option(std::move(name), variable, {.offer = offer, .required = true}, std::move(help));
}

std::string ReadyFile(const std::string& given, const std::string& folder,
                      const std::string& noun) {
  namespace fs = std::filesystem;
  std::error_code unreadable;
  const fs::path file = OwnOrDataFile(given);
  const bool is_name = file == fs::path(given).stem() && !given.empty();
  if (fs::exists(file, unreadable)) return file.string();
  if (!is_name) {
    std::vector<std::string> others;  // x.yaml for x.yml
    for (const auto* ending : {".yaml", ".yml"}) {
      const fs::path other = fs::path(given).replace_extension(ending);
      if (fs::exists(other, unreadable)) others.push_back(other.string());
    }
    throw UserError({.place = given, .problem = "no such file" + Suggestion(given, others)});
  }
  const fs::path ready = OwnOrDataFile(fs::path(folder) / (given + ".yaml"));
  if (fs::exists(ready, unreadable)) return ready.string();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(DataFolder(folder))) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem());
  }
  std::ranges::sort(names);
  throw UserError(
      {.place = given, .problem = "no such file or " + noun + Suggestion(given, names)});
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

int JobsOrCores(int jobs) {
  return jobs > 0 ? jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
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
                 "of a file with several arrays the one to take, or a group of them [those of the "
                 "number of rows that holds the most values]"),
          Option("--topic", &array, {.value = "NAME", .excludes = {"--array"}},
                 "of MCAP or a ROS 2 bag the topic to take [the only one with signals]")};
}

}  // namespace gauntlet::sim
