#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gauntlet::sim {

/// A variable that an option sets; a bool makes a flag. A function is called with the value.
class Variable : public std::variant<bool*, int*, std::int64_t*, double*, std::optional<double>*,
                                     std::string*, std::vector<double>*, std::vector<std::string>*,
                                     std::function<void(const std::string&)>> {
 public:
  using variant::variant;
  Variable();
  Variable(const Variable& other);
  Variable(Variable&& other) noexcept;
  Variable& operator=(const Variable& other);
  Variable& operator=(Variable&& other) noexcept;
  ~Variable();
};

/// Words that a shell may offer for a value.
enum class Offer {
  kNothing,
  kFiles,
  kFolders,
  kScenarios,
  kStudies,
  kControllers,
  kChannels,
  kFilterKinds,
  kScenarioKeys,
  kFilterKeys
};

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Properties of an option that most options do not have.
struct OptionRules {
  std::string value = {};                 // name of the value in --help; empty: that of the type
  Range range = {};                       // of a number, ends included
  std::vector<std::string> choices = {};  // other words are refused
  std::vector<std::string> words = {};    // for --help and shells; the command refuses others
  Offer offer = Offer::kNothing;
  bool required = false;
  bool shows_default = false;              // in --help
  char separator = '\0';                   // between the values of a list, beside blanks
  bool is_one_word = false;                // a list without blanks
  std::vector<std::string> needs = {};     // options above this one
  std::vector<std::string> excludes = {};  // the same
  /// Returns the problem of a value, or nothing. May change the value.
  std::function<std::string(std::string&)> check = {};
};

/// An option `--seed`, or an argument: a name without dashes.
struct Option {
  std::string name;
  Variable variable;
  OptionRules rules;
  std::string help;

  Option(std::string its_name, Variable sets, OptionRules its_rules, std::string text);
  Option(const Option& other);
  Option(Option&& other) noexcept;
  Option& operator=(const Option& other);
  Option& operator=(Option&& other) noexcept;
  ~Option();

  bool is_argument() const { return !name.starts_with('-'); }
  bool is_flag() const { return std::holds_alternative<bool*>(variable); }
  bool is_whole() const {
    return std::holds_alternative<int*>(variable) ||
           std::holds_alternative<std::int64_t*>(variable);
  }
};

/// A list of options. It is written as options and other lists, one after the other.
struct Options : std::vector<Option> {
  Options(Option option);  // NOLINT(google-explicit-constructor)
  Options(std::initializer_list<Options> parts);
};

/// Parts of the list of commands in --help, in their order. The last is left to `help --all`.
enum class Group { kEveryday, kMeasure, kStudy, kOther };

/// A command of the program. Parser, --help, pages of man, completion and suggestions follow from
/// this description.
struct Command {
  std::string name;
  std::string purpose;  // one line
  Options options;
  std::function<void()> run;  // owns the variables of the options
  std::string notes;          // below the options: explanations, examples
  Group group = Group::kOther;
};

/// The command of a Config: `kName`, `kPurpose`, `kGroup` and `kNotes`, the variables of its
/// options, and `Rows()`, which describes these.
template <class Config>
Command MakeCommand(void (*run)(const Config&)) {
  const auto config = std::make_shared<Config>();
  return {Config::kName,         Config::kPurpose, config->Rows(),
          [=] { run(*config); }, Config::kNotes,   Config::kGroup};
}

/// Thrown by a command that is done, for an answer that is an exit code.
struct ExitCode {
  int value;
};

/// The command or option of this name, or nullptr.
template <class Row>
const Row* FindNamed(const std::vector<Row>& rows, const std::string& name) {
  const auto found = std::ranges::find(rows, name, &Row::name);
  return found == rows.end() ? nullptr : &*found;
}

std::vector<std::string> AllNames(const auto& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.name);
  return names;
}

/// Reads a command line into the variables of a command's options and returns the command; nullptr
/// after it has printed the text of --help or --version. Errors: UserError with the argument, the
/// problem and what was probably meant, without a command below the text of --help; those of the
/// options' checks.
const Command* ReadCommandLine(const Command& program, const std::vector<Command>& commands,
                               int argc, char** argv);

}  // namespace gauntlet::sim
