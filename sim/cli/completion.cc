#include "sim/cli/completion.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <optional>

#include "controller/filters/filter_registry.h"
#include "sim/base/channels.h"
#include "sim/base/data_folder.h"
#include "sim/cli/shared_options.h"
#include "sim/settings/setting_rows.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"

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

/// Names of rows, and their meanings.
Candidates Named(const auto& rows, auto meaning) {
  Candidates candidates;
  for (const auto& row : rows) {
    candidates.push_back({.word = std::string(row.name), .meaning = std::string(row.*meaning)});
  }
  return candidates;
}

Candidates OptionsOf(const Command& command) {
  Candidates candidates = {{.word = "--help", .meaning = "Print this help message and exit"}};
  for (const Option& option : command.options) {
    if (!option.is_argument()) candidates.push_back({.word = option.name, .meaning = option.help});
  }
  return candidates;
}

bool NeedsValue(const Option* option) { return option != nullptr && !option->is_flag(); }

/// The words that stand for the arguments of a command, without options and their values.
std::vector<std::string> Arguments(const Command& command, const std::vector<std::string>& words) {
  std::vector<std::string> arguments;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with('-')) {
      arguments.push_back(words[i]);
    } else if (NeedsValue(FindNamed<Option>(command.options, words[i]))) {
      ++i;
    }
  }
  return arguments;
}

/// Scenario that the first argument names: a file, a ready one, or that of an output folder.
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

Candidates ForValue(const Option& option, const std::string& current,
                    const std::vector<std::string>& arguments) {
  const Offer offer = option.rules.offer;
  if (offer == Offer::kFiles) return {kFiles};
  if (offer == Offer::kFolders) return {kFolders};
  if (offer == Offer::kScenarios) return ReadyFiles("scenarios", true);
  if (offer == Offer::kStudies) return ReadyFiles("studies", true);
  if (offer == Offer::kControllers) {
    const bool is_list = option.rules.separator != '\0';
    return Controllers(ScenarioOf(arguments),
                       is_list ? current.substr(0, current.rfind(',') + 1) : "");
  }
  if (offer == Offer::kChannels) return Named(KnownChannels(), &Channel::help);
  if (offer == Offer::kFilterKinds)
    return Named(controller::FilterKinds(), &controller::FilterKind::summary);
  if (offer == Offer::kScenarioKeys) return ScenarioKeys(ScenarioOf(arguments));
  if (offer == Offer::kFilterKeys) return FilterKeys(arguments);
  return Plain(option.rules.choices.empty() ? option.rules.words : option.rules.choices);
}

Candidates ForArgument(const Command& command, const std::string& current,
                       const std::vector<std::string>& arguments) {
  std::size_t behind = arguments.size();
  for (const Option& option : command.options) {
    if (option.is_argument() && behind-- == 0) return ForValue(option, current, arguments);
  }
  return {};
}

Candidates For(const std::vector<Command>& commands, const std::vector<std::string>& words) {
  const std::string& current = words.back();
  if (words.size() == 1) {
    Candidates candidates = Named(commands, &Command::purpose);
    for (const char* option : {"--help", "--version"}) candidates.push_back({.word = option});
    return candidates;
  }
  if (words[0] == "help") {
    Candidates candidates = Named(commands, &Command::purpose);
    candidates.push_back({.word = "--all", .meaning = "List all commands"});
    return candidates;
  }
  const Command* command = FindNamed(commands, words[0]);
  if (command == nullptr) return {};
  const std::string& previous = words[words.size() - 2];
  if (current == "=" || previous == "=") return {kFiles};  // bash splits --set key=value
  const auto arguments = Arguments(*command, {words.begin() + 1, words.end() - 1});
  const Option* option =
      previous.starts_with('-') ? FindNamed<Option>(command->options, previous) : nullptr;
  if (NeedsValue(option)) return ForValue(*option, current, arguments);
  if (current.starts_with('-')) return OptionsOf(*command);
  return ForArgument(*command, current, arguments);
}

}  // namespace

std::string Completions(const std::vector<Command>& commands,
                        const std::vector<std::string>& words) {
  std::string text;
  if (words.empty()) return text;
  for (const Candidate& candidate : For(commands, words)) {
    const bool request = candidate.word.starts_with(':');
    if (!request && !candidate.word.starts_with(words.back()) && words.back() != "=") continue;
    text += candidate.word;
    if (!candidate.meaning.empty()) text += "\t" + candidate.meaning;
    text += "\n";
  }
  return text;
}

}  // namespace gauntlet::sim
