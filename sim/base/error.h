#pragma once

#include <concepts>
#include <stdexcept>
#include <string>
#include <utility>

namespace gauntlet::sim {

/// The parts of an error message. Only the problem is always present.
struct ErrorParts {
  std::string place = {};  // `file:line:column` as far as known, or `--set key=value`
  std::string key = {};    // path of keys, joined by dots
  std::string problem = {};
};

/// The user's mistake: one line with place, field, value and allowed range. Exit code 2.
class UserError : public std::runtime_error {
 public:
  /// From one text. (A template, so that braces always mean ErrorParts.)
  template <std::convertible_to<std::string> Text>
  explicit UserError(const Text& problem) : UserError(ErrorParts{.problem = problem}) {}
  explicit UserError(ErrorParts parts)
      : std::runtime_error(Line(parts)), parts_(std::move(parts)) {}

  const std::string& place() const { return parts_.place; }
  const std::string& key() const { return parts_.key; }
  const std::string& problem() const { return parts_.problem; }

 private:
  /// The parts that are present, joined by colons. what() returns this line.
  static std::string Line(const ErrorParts& parts) {
    std::string line;
    for (const std::string* part : {&parts.place, &parts.key}) {
      if (!part->empty()) line += *part + ": ";
    }
    return line + parts.problem;
  }

  ErrorParts parts_;
};

/// The run failed although the input was right: a full disk, a diverged simulation. Exit code 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Long work was stopped on request (Ctrl-C).
struct Cancelled {
  std::string kept = {};  // sentence for the user about results that are kept; may be empty
};

}  // namespace gauntlet::sim
