#include "sim/cli/usage_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <regex>

#include "controller/number.h"
#include "sim/base/nearest_name.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLongestReason = 240;  // so that the hint behind it stays whole

bool IsOption(const std::string& argument) { return argument.size() > 1 && argument[0] == '-'; }

/// --seed of --seed=3.
std::string NameOf(const std::string& option) { return option.substr(0, option.find('=')); }

std::vector<std::string> NamesOfCommands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> NamesOfOptions(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) names.push_back(option->get_name());
  }
  return names;
}

/// " (did you mean --seed?)", or nothing: a list of all options is what --help is for.
std::string Meant(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = NearestName(name, candidates);
  return nearest.empty() ? "" : fmt::format(" (did you mean {}?)", nearest);
}

/// An option that a command does not have; nothing if all are its own.
std::optional<std::string> UnknownOption(const CLI::App& app, const CLI::App& command,
                                         const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const std::string name = NameOf(argument);
    if (!IsOption(argument) || command.get_option_no_throw(name) != nullptr) continue;
    std::string problem = fmt::format("{}: {} has no such option", Shown(name), command.get_name());
    for (const CLI::App* other : app.get_subcommands(nullptr)) {
      if (other->get_option_no_throw(name) == nullptr) continue;
      return fmt::format("{}; {} has", problem, other->get_name());
    }
    return problem + Meant(name, NamesOfOptions(command));
  }
  return std::nullopt;
}

/// "Could not convert: --json = x" of a flag, said of the flag; options have checks of their own.
std::string ReasonOf(const CLI::ParseError& error) {
  std::string text = OneLine(error.what(), kLongestReason);
  const std::string prefix = "Could not convert: ";
  if (!text.starts_with(prefix)) return text;
  std::string option = text.substr(prefix.size());
  const std::size_t sign = option.find(" = ");
  if (sign == std::string::npos) return text;
  return fmt::format("{}: is '{}', must be true or false", option.substr(0, sign),
                     option.substr(sign + 3));
}

}  // namespace

std::string ExplainUsage(const CLI::App& app, const CLI::ParseError& error,
                         const std::vector<std::string>& arguments) {
  const auto word = std::ranges::find_if_not(arguments, IsOption);
  if (word == arguments.end()) {
    if (!arguments.empty()) return UnknownOption(app, app, arguments).value_or(ReasonOf(error));
    return "a command is missing" + Suggestion("", NamesOfCommands(app)) + "; see gauntlet --help";
  }
  const std::vector<const CLI::App*> commands = app.get_subcommands(nullptr);
  const auto found = std::ranges::find(commands, *word, &CLI::App::get_name);
  if (found == commands.end()) {
    return fmt::format("{}: no such command{}; see gauntlet --help", Shown(*word),
                       Suggestion(*word, NamesOfCommands(app)));
  }
  const std::vector<std::string> behind(word + 1, arguments.end());
  const bool surplus = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  std::string problem = ReasonOf(error);
  if (const auto unknown = UnknownOption(app, **found, behind); surplus && unknown) {
    problem = *unknown;
  } else if (surplus) {
    problem = fmt::format("{}: more than {} takes", Shown(behind.back()), *word);
  }
  return fmt::format("{}; see gauntlet {} --help", problem, *word);
}

std::vector<std::string> WithoutWordsForOptions(std::vector<std::string> arguments) {
  if (arguments.empty()) return arguments;
  if (arguments[0] == "version") arguments[0] = "--version";
  if (arguments[0] == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  return arguments;
}

std::string AsCalled(const std::string& text, const std::string& called) {
  if (!called.starts_with("./") && !called.starts_with("../")) return text;
  static const std::regex kCommand(R"((^|[\s(])gauntlet( --help| [a-z\[]))");
  std::string word;  // in which $ begins nothing
  for (const char c : ShellPath(called)) word += c == '$' ? "$$" : std::string(1, c);
  return std::regex_replace(text, kCommand, "$1" + word + "$2");
}

CLI::Validator WholeNumber(std::int64_t low, std::int64_t high) {
  const auto rewrite = [=](std::string& text) -> std::string {
    const auto number = controller::ParseWholeNumber(text, low, high);
    if (!number) {
      return fmt::format("is '{}', must be a whole number from {} to {}", Shown(text), low, high);
    }
    text = fmt::format("{}", *number);
    return "";
  };
  return {rewrite, ""};
}

CLI::Validator Number(double low, double high) {
  const auto rewrite = [=](std::string& text) -> std::string {
    const auto number = controller::ParseNumber(text);
    if (!number || !(*number >= low && *number <= high)) {
      return fmt::format("is '{}', must be a number from {} to {}", Shown(text), low, high);
    }
    text = fmt::format("{:a}", *number);  // which CLI11 reads as the same double
    return "";
  };
  return {rewrite, ""};
}

}  // namespace gauntlet::sim
