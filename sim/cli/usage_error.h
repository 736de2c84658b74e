#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace gauntlet::sim {

/// What is wrong with a command line that CLI11 did not take: what was written, why it is not
/// taken, and what was probably meant.
std::string ExplainUsage(const CLI::App& app, const CLI::ParseError& error,
                         const std::vector<std::string>& arguments);

/// Arguments as CLI11 knows them: `help` for --help, `help run` for run --help, `version` for
/// --version.
std::vector<std::string> WithoutWordsForOptions(std::vector<std::string> arguments);

/// A text that says `gauntlet COMMAND` in the way in which the program was called: `./gauntlet
/// COMMAND` of a source tree. `called`: argv[0]; a place that no person types is left out.
std::string AsCalled(const std::string& text, const std::string& called);

/// For transform() of an option: a whole number, or any number, from `low` to `high`, as
/// controller::ParseNumber() reads it. CLI11 alone would take hexadecimal and octal digits.
CLI::Validator WholeNumber(std::int64_t low, std::int64_t high);
CLI::Validator Number(double low, double high);

}  // namespace gauntlet::sim
