#include "sim/cli/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>

#include "controller/filters/filter_registry.h"
#include "sim/base/channels.h"
#include "sim/base/data_folder.h"
#include "sim/cli/study_command.h"
#include "sim/scenario/scenario.h"
#include "sim/scenario/scenario_reader.h"
#include "sim/settings/setting_rows.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;

struct Candidate {
  std::string word;
  std::string meaning = {};
};
using Candidates = std::vector<Candidate>;

const Candidate kFiles = {.word = ":files"};
const Candidate kFolders = {.word = ":folders"};
const Candidate kOpen = {.word = ":open"};

Candidates Plain(const std::vector<std::string>& words) {
  Candidates candidates;
  for (const std::string& word : words) candidates.push_back({.word = word});
  return candidates;
}

Candidates Commands(const CLI::App& app) {
  Candidates candidates;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    candidates.push_back({.word = command->get_name(), .meaning = command->get_description()});
  }
  return candidates;
}

Candidates Options(const CLI::App& command) {
  Candidates candidates;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) continue;
    candidates.push_back({.word = option->get_name(), .meaning = option->get_description()});
  }
  return candidates;
}

/// {a,b} of an option whose help says so.
Candidates ChoicesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return {};
  return Plain(CLI::detail::split(type.substr(begin + 1, end - begin - 1), ','));
}

/// The words that stand for the arguments of a command, without options and their values.
std::vector<std::string> Arguments(const CLI::App& command, const std::vector<std::string>& words) {
  std::vector<std::string> arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with('-')) {
      arguments.push_back(words[i]);
      continue;
    }
    const CLI::Option* option = command.get_option_no_throw(words[i]);
    if (option != nullptr && option->get_items_expected_max() > 0) ++i;
  }
  return arguments;
}

/// What the first argument names: a scenario, a ready one, or that of an output folder.
std::optional<Scenario> ScenarioOf(const std::vector<std::string>& arguments) {
  if (arguments.empty()) return std::nullopt;
  try {
    const fs::path resolved = fs::path(arguments[0]) / "scenario.resolved.yaml";
    return LoadScenario(fs::exists(resolved) ? resolved : fs::path(ScenarioFile(arguments[0])), {});
  } catch (const std::exception&) {  // not yet whole
    return std::nullopt;
  }
}

Candidates Controllers(const std::optional<Scenario>& scenario, const std::string& before = "") {
  Candidates candidates;
  if (!scenario) return candidates;
  for (const NamedController& controller : scenario->controllers) {
    candidates.push_back({.word = before + controller.name});
  }
  return candidates;
}

void AddKeys(const std::string& before, auto settings, Candidates& candidates) {
  for (const SettingRow& row :
       ListSettings([&](controller::SettingsVisitor& visitor) { settings.Visit(visitor); })) {
    candidates.push_back({.word = before + row.key + "=", .meaning = row.help});
  }
}

/// Keys for --set, of a scenario or of a filter.
Candidates ScenarioKeys(const std::optional<Scenario>& scenario) {
  Candidates candidates = {kOpen};
  AddKeys("", scenario.value_or(Scenario()), candidates);
  if (!scenario) return candidates;
  for (const NamedController& controller : scenario->controllers) {
    const std::string before = "controllers." + controller.name + ".";
    AddKeys(before, controller, candidates);
    const auto& filters = controller.config.filters;
    if (filters.size() == 1) AddKeys(before + "filter.", filters.front(), candidates);
  }
  return candidates;
}

Candidates FilterKeys(const std::vector<std::string>& arguments) {
  Candidates candidates = {kOpen, {.word = "rate_hz="}};
  for (const auto& kind : controller::FilterKinds()) {
    if (!arguments.empty() && kind.name == arguments[0]) AddKeys("", kind.defaults, candidates);
  }
  std::erase_if(candidates, [](const Candidate& candidate) { return candidate.word == "kind="; });
  return candidates;
}

/// YAML files of the data folder; a name alone where `by_name`, and the path where the working
/// folder has none of its own.
Candidates ReadyFiles(const std::string& folder, bool by_name) {
  Candidates candidates = {kFiles};
  const bool own = fs::exists(folder);
  for (const auto& entry : fs::directory_iterator(DataFolder(folder))) {
    if (entry.path().extension() != ".yaml") continue;
    if (by_name) candidates.push_back({.word = entry.path().stem()});
    if (!own) candidates.push_back({.word = fs::path(folder) / entry.path().filename()});
  }
  std::ranges::sort(candidates, {}, &Candidate::word);
  return candidates;
}

Candidates Channels() {
  Candidates candidates;
  for (const Channel& channel : KnownChannels()) {
    candidates.push_back({.word = std::string(channel.name), .meaning = std::string(channel.help)});
  }
  return candidates;
}

Candidates ForValue(const CLI::App& command, const CLI::Option& option, const std::string& current,
                    const std::vector<std::string>& arguments) {
  const std::string name = option.get_name();
  if (name == "--set") {
    return command.get_name() == "filter" ? FilterKeys(arguments)
                                          : ScenarioKeys(ScenarioOf(arguments));
  }
  if (name == "--controller") return Controllers(ScenarioOf(arguments));
  if (name == "--controllers" || name == "--overlay") {
    return Controllers(ScenarioOf(arguments), current.substr(0, current.rfind(',') + 1));
  }
  if (name == "--channel") return Channels();
  const std::string type = option.get_type_name();
  if (type.starts_with("DIR")) return {kFolders};
  if (type.starts_with("FILE")) return {kFiles};
  return ChoicesOf(option);
}

Candidates ForArgument(const CLI::App& command, std::size_t index) {
  std::vector<const CLI::Option*> positionals;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) positionals.push_back(option);
  }
  if (index >= positionals.size()) return {};
  const std::string name = positionals[index]->get_name();
  if (name == "scenario") return ReadyFiles("scenarios", true);
  if (name == "study") return ReadyFiles("studies", false);
  if (name == "folder" || name == "A" || name == "B") return {kFolders};
  if (name == "recording" || name == "log") return {kFiles};
  if (name != "kind") return ChoicesOf(*positionals[index]);
  Candidates candidates;
  for (const auto& kind : controller::FilterKinds()) {
    candidates.push_back({.word = std::string(kind.name), .meaning = std::string(kind.summary)});
  }
  return candidates;
}

Candidates For(const CLI::App& app, const std::vector<std::string>& words) {
  const std::string& current = words.back();
  if (words.size() == 1) {
    Candidates candidates = Commands(app);
    for (const char* option : {"--help", "--version"}) candidates.push_back({.word = option});
    return candidates;
  }
  if (words[0] == "help") return Commands(app);
  const std::vector<const CLI::App*> commands = app.get_subcommands(nullptr);
  const auto found = std::ranges::find(commands, words[0], &CLI::App::get_name);
  if (found == commands.end()) return {};
  const CLI::App& command = **found;
  const std::string& previous = words[words.size() - 2];
  if (current == "=" || previous == "=") return {kFiles};  // bash splits --set key=value
  const auto arguments = Arguments(command, {words.begin() + 1, words.end() - 1});
  const CLI::Option* option =
      previous.starts_with('-') ? command.get_option_no_throw(previous) : nullptr;
  if (option != nullptr && option->get_items_expected_max() > 0) {
    return ForValue(command, *option, current, arguments);
  }
  if (current.starts_with('-')) return Options(command);
  return ForArgument(command, arguments.size());
}

}  // namespace

std::string Completions(const CLI::App& app, const std::vector<std::string>& words) {
  std::string text;
  if (words.empty()) return text;
  for (const Candidate& candidate : For(app, words)) {
    const bool request = candidate.word.starts_with(':');
    if (!request && !candidate.word.starts_with(words.back()) && words.back() != "=") continue;
    text += candidate.word;
    if (!candidate.meaning.empty()) text += "\t" + candidate.meaning;
    text += "\n";
  }
  return text;
}

}  // namespace gauntlet::sim
