#include "sim/cli/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>
#include <type_traits>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/shell_word.h"
#include "sim/base/text.h"
#include "sim/cli/standard_streams.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

/// Numbers as controller::ParseNumber() reads them: CLI11 alone would take hexadecimal and octal
/// digits.
CLI::Validator Within(const Range& range, bool is_whole) {
  const auto low = static_cast<std::int64_t>(range.low);
  const auto high = static_cast<std::int64_t>(range.high);
  const auto whole = [=](std::string& text) -> std::string {
    const auto number = controller::ParseWholeNumber(text, low, high);
    text = number ? fmt::format("{}", *number) : Shown(text);
    if (number) return "";
    return fmt::format("is '{}', must be a whole number from {} to {}", text, low, high);
  };
  const auto any = [=](std::string& text) -> std::string {
    const auto number = controller::ParseNumber(text);
    const bool is_good = number && *number >= range.low && *number <= range.high;
    text = is_good ? fmt::format("{:a}", *number) : Shown(text);  // read as the same double
    if (is_good) return "";
    return fmt::format("is '{}', must be a number from {} to {}", text, range.low, range.high);
  };
  return is_whole ? CLI::Validator(whole, "") : CLI::Validator(any, "");
}

CLI::Validator OneOf(const std::vector<std::string>& choices) {
  const auto check = [choices](std::string& text) -> std::string {
    if (std::ranges::find(choices, text) != choices.end()) return "";
    return fmt::format("is '{}', must be one of {}", Shown(text), fmt::join(choices, ", "));
  };
  return {check, fmt::format("{{{}}}", fmt::join(choices, ","))};
}

/// The option without its rules.
CLI::Option* AddVariable(const Option& option, CLI::App& command) {
  const auto add = [&](const auto& variable) -> CLI::Option* {
    using Type = std::decay_t<decltype(variable)>;
    if constexpr (std::is_same_v<Type, bool*>) {
      return command.add_flag(option.name, *variable, option.help);
    } else if constexpr (std::is_pointer_v<Type>) {
      return command.add_option(option.name, *variable, option.help);
    } else {
      return command.add_option_function<std::string>(option.name, variable, option.help);
    }
  };
  return std::visit(add, option.variable);
}

void AddOption(const Option& option, CLI::App& command) {
  const OptionRules& rules = option.rules;
  CLI::Option* added = AddVariable(option, command)->required(rules.required);
  if (!rules.words.empty()) added->type_name(fmt::format("{{{}}}", fmt::join(rules.words, ",")));
  if (!rules.value.empty()) added->type_name(rules.value);
  if (std::isfinite(rules.range.low)) added->transform(Within(rules.range, option.is_whole()));
  if (!rules.choices.empty()) added->check(OneOf(rules.choices));
  if (rules.check) added->transform(CLI::Validator(rules.check, ""));
  if (rules.separator != '\0') added->delimiter(rules.separator);
  if (rules.is_one_word) added->allow_extra_args(false);
  if (rules.shows_default) {  // how CLI11 itself shows it depends on its version
    std::string value = added->capture_default_str()->get_default_str();
    if (value.starts_with('[')) value = value.substr(1, value.size() - 2);  // a list
    added->description(fmt::format("{} [{}]", option.help, value))->default_str("");
  }
  for (const std::string& other : rules.needs) added->needs(command.get_option(other));
  for (const std::string& other : rules.excludes) added->excludes(command.get_option(other));
}

std::string HeadingOf(Group group) {
  constexpr const char* kHeadings[] = {"Everyday", "Measure a glove or a hand", "Studies", "Other"};
  return kHeadings[static_cast<std::size_t>(group)];
}

/// Line of the short help.
constexpr auto kMore =
    "\nOther commands: gauntlet help --all. One command: gauntlet help COMMAND.\n";

void AddCommand(const Command& command, CLI::App& app) {
  CLI::App* added = app.add_subcommand(command.name, command.purpose)->footer(command.notes);
  added->group(HeadingOf(command.group));
  for (const Option& option : command.options) AddOption(option, *added);
}

constexpr std::size_t kLongestReason = 340;  // so that the hint behind it stays whole

/// A negative number is a value.
bool IsOption(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' && !controller::ParseNumber(argument);
}

/// --seed of --seed=3.
std::string NameOf(const std::string& option) { return option.substr(0, option.find('=')); }

bool HasOption(const Command& command, const std::string& name) {
  return name == "-h" || name == "--help" || FindNamed<Option>(command.options, name) != nullptr;
}

/// An option that a command does not have; nothing if all are its own. Names one that was probably
/// meant: a list of all options is what --help is for.
std::optional<std::string> UnknownOption(const std::vector<Command>& commands,
                                         const Command& command,
                                         const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const std::string name = NameOf(argument);
    if (!IsOption(argument) || HasOption(command, name)) continue;
    std::string problem = fmt::format("{}: {} has no such option", Shown(name), command.name);
    for (const Command& other : commands) {
      if (HasOption(other, name)) return fmt::format("{}; {} has", problem, other.name);
    }
    std::vector<std::string> names = AllNames(command.options);
    names.insert(names.begin(), "--help");
    std::erase_if(names, [](const std::string& other) { return !IsOption(other); });
    const std::string nearest = NearestName(name, names);
    return nearest.empty() ? problem : fmt::format("{} (did you mean {}?)", problem, nearest);
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

/// Words that people try as commands, and what does it here.
struct OtherWord {
  std::string_view word;
  std::string_view command;
};
constexpr OtherWord kOtherWords[] = {
    {"plot", "gauntlet inspect FILE --plot FILE.png"},
    {"video", "gauntlet compare SCENARIO --video, or gauntlet render FOLDER"},
    {"csv", "gauntlet compare SCENARIO --csv"},
    {"simulate", "gauntlet run SCENARIO"},
    {"start", "gauntlet run SCENARIO"},
    {"optimize", "gauntlet tune SCENARIO"},
    {"convert", "gauntlet inspect FILE --json, or gauntlet compare SCENARIO --mcap"},
};

std::string ExplainUnknownCommand(const std::vector<Command>& commands, const std::string& word) {
  const auto other = std::ranges::find(kOtherWords, word, &OtherWord::word);
  const std::string hint = other == std::end(kOtherWords)
                               ? Suggestion(word, AllNames(commands))
                               : fmt::format(" (did you mean {}?)", other->command);
  return fmt::format("{}: no such command{}; see gauntlet --help", Shown(word), hint);
}

/// Explanation of a command line that CLI11 did not take: what was written, why it is not taken,
/// and what was probably meant.
std::string ExplainUsage(const std::vector<Command>& commands,
                         const std::vector<std::string>& arguments, const CLI::ParseError& error) {
  const auto word = std::ranges::find_if_not(arguments, IsOption);
  if (word == arguments.end()) {
    const Options options = {Option("--version", {}, {}, ""), Option("--all", {}, {}, "")};
    const Command program = {"gauntlet", "", options, {}, ""};
    return UnknownOption(commands, program, arguments).value_or(ReasonOf(error));
  }
  const Command* command = FindNamed(commands, *word);
  if (command == nullptr) return ExplainUnknownCommand(commands, *word);
  std::string problem = ReasonOf(error);
  const bool is_too_much = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);
  if (is_too_much) problem = fmt::format("{}: more than {} takes", Shown(arguments.back()), *word);
  // An option that is required and misspelt is there for the person who typed it.
  if (is_too_much || error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError)) {
    problem = UnknownOption(commands, *command, {word + 1, arguments.end()}).value_or(problem);
  }
  return fmt::format("{}; see gauntlet {} --help", problem, *word);
}

/// Arguments as CLI11 knows them: `help` for --help, `help run` for run --help, `version` for
/// --version.
std::vector<std::string> WithoutWordsForOptions(std::vector<std::string> arguments) {
  if (arguments.empty()) return arguments;
  if (arguments[0] == "version") arguments[0] = "--version";
  if (arguments[0] == "help") {
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
  }
  return arguments;
}

/// A text that says `gauntlet COMMAND` in the way in which the program was called: `./gauntlet
/// COMMAND` of a source tree. `called`: argv[0]; a place that no person types is left out.
std::string AsCalled(const std::string& text, const std::string& called) {
  if (!called.starts_with("./") && !called.starts_with("../")) return text;
  constexpr std::string_view kName = "gauntlet ";
  const auto is_command = [&](std::size_t at) {
    const bool begins =
        at == 0 || std::string_view(" \t\n(").find(text[at - 1]) != std::string_view::npos;
    const std::string_view next = std::string_view(text).substr(at + kName.size());
    const bool goes_on = !next.empty() && (next[0] == '[' || (next[0] >= 'a' && next[0] <= 'z'));
    return begins && (goes_on || next.starts_with("--help"));
  };
  const std::string word = ShellPath(called) + " ";
  std::string result;
  std::size_t copied = 0;
  for (auto at = text.find(kName); at != std::string::npos; at = text.find(kName, at + 1)) {
    if (!is_command(at)) continue;
    result += text.substr(copied, at - copied) + word;
    copied = at + kName.size();
  }
  return result + text.substr(copied);
}

/// The next line, or what is left of a paragraph of notes of which a line is too long.
bool NextPart(std::vector<std::string_view>& lines, std::size_t width, std::string& part) {
  if (lines.empty()) return false;
  const auto is_text = [](std::string_view line) { return !line.empty() && line[0] != ' '; };
  const auto end = std::ranges::find_if_not(lines, is_text);
  const bool is_long =
      std::any_of(lines.begin(), end, [&](auto line) { return Width(line) > width; });
  const auto last = is_long ? end : lines.begin() + 1;
  part = fmt::format("{}", fmt::join(lines.begin(), last, " "));
  lines.erase(lines.begin(), last);
  return true;
}

/// Help in lines of at most 80 columns. Descriptions stay in the column where CLI11 begins them.
std::string HelpIn80Columns(const std::string& help) {
  constexpr std::size_t kWidth = 80;
  constexpr std::size_t kDescription = 30;  // CLI11's column of descriptions
  std::vector<std::string_view> lines = SplitLines(help);
  std::string out;
  for (std::string line; NextPart(lines, kWidth, line);) {
    if (line.empty() && out.ends_with("\n\n")) continue;
    const bool has_columns = line.size() > kDescription &&
                             (line.starts_with("  -") || line.substr(kDescription - 2, 2) == "  ");
    if (Width(line) > kWidth && has_columns) {
      const std::string gap(kDescription, ' ');
      std::string text = Wrapped(line.substr(kDescription), kWidth - kDescription);
      for (std::size_t at = text.find('\n'); at != std::string::npos;
           at = text.find('\n', at + 1)) {
        text.insert(at + 1, gap);
      }
      line = line.substr(0, kDescription) + text;
    } else if (Width(line) > kWidth && !line.starts_with(' ')) {
      line = Wrapped(line, kWidth);
    }
    out += line + "\n";
  }
  return out;
}

}  // namespace

Variable::Variable() = default;
Variable::Variable(const Variable& other) = default;
Variable::Variable(Variable&& other) noexcept = default;
Variable& Variable::operator=(const Variable& other) = default;
Variable& Variable::operator=(Variable&& other) noexcept = default;
Variable::~Variable() = default;

Option::Option(std::string its_name, Variable sets, OptionRules its_rules, std::string text)
    : name(std::move(its_name)),
      variable(std::move(sets)),
      rules(std::move(its_rules)),
      help(std::move(text)) {}
Option::Option(const Option& other) = default;
Option::Option(Option&& other) noexcept = default;
Option& Option::operator=(const Option& other) = default;
Option& Option::operator=(Option&& other) noexcept = default;
Option::~Option() = default;

Options::Options(Option option) : vector({std::move(option)}) {}
Options::Options(std::initializer_list<Options> parts) {
  for (const Options& part : parts) insert(end(), part.begin(), part.end());
}

const Command* ReadCommandLine(const Command& program, const std::vector<Command>& commands,
                               int argc, char** argv) {
  const std::string called = argc > 0 ? argv[0] : "";
  const std::vector<std::string> arguments =
      WithoutWordsForOptions({argv + std::min(argc, 1), argv + argc});
  CLI::App app{program.purpose, program.name};
  bool all = false;
  app.add_flag("--all", all, "with --help: list all commands");
  app.set_version_flag("--version", "gauntlet " GAUNTLET_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->label("SUBCOMMAND", "COMMAND");
  for (const Command& command : commands) AddCommand(command, app);
  const auto print = [&](const CLI::Success& request) {
    app.footer(all ? program.notes : kMore + program.notes);
    for (const Command& command : commands) {
      // CLI11 leaves out those of a group without a heading.
      if (!all && command.group == Group::kOther) app.get_subcommand(command.name)->group("");
    }
    std::ostringstream text;
    app.exit(request, text, text);
    PrintText(HelpIn80Columns(AsCalled(text.str(), called)));
  };
  try {
    if (arguments.empty()) {
      print(CLI::CallForHelp());
      FlushOutput();
      throw UserError("a command is missing");
    }
    app.parse(std::vector(arguments.rbegin(), arguments.rend()));  // CLI11 takes them from the end
    if (all) throw UserError("--all requires --help");
  } catch (const CLI::Success& request) {  // --help, --version
    if (app.get_subcommands().empty() && app.remaining_size() > 0) {
      const CLI::ExtrasError unknown(app.remaining());
      throw UserError(AsCalled(ExplainUsage(commands, arguments, unknown), called));
    }
    print(request);
    return nullptr;
  } catch (const CLI::ParseError& error) {
    if (all) throw UserError("--all requires --help");
    throw UserError(AsCalled(ExplainUsage(commands, arguments, error), called));
  }
  return FindNamed(commands, app.get_subcommands().front()->get_name());
}

}  // namespace gauntlet::sim
