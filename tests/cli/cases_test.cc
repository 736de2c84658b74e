// Runs cases/*.txt: shell commands, and the exit code and the lines that they must give.
// CONTRIBUTING.md describes the files.
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

constexpr std::string_view kAnswer = "----";
constexpr std::string_view kExit = "---- exit ";

/// Commands, and their answer.
struct Step {
  int line = 0;  // of the first command
  std::string script;
  int exit_code = 0;
  Lines output;
  Lines error;
};

/// Steps are separated by a blank line behind the answer, `#` begins a comment between them.
std::vector<Step> ReadSteps(const fs::path& file) {
  std::vector<Step> steps;
  std::ifstream stream(file);
  bool is_answer = true;
  bool is_between = true;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (is_between && (line.empty() || line.starts_with('#'))) continue;
    if (is_between) {
      steps.emplace_back().line = number;
      is_answer = false;
    }
    is_between = is_answer && line.empty();
    if (is_between) continue;
    Step& step = steps.back();
    if (!is_answer && line.starts_with(kAnswer)) {
      is_answer = true;
      if (line.starts_with(kExit)) step.exit_code = std::stoi(line.substr(kExit.size()));
    } else if (!is_answer) {
      step.script += line + "\n";
    } else if (line.starts_with("! ")) {
      step.error.push_back(line.substr(2));
    } else {
      step.output.push_back(line);
    }
  }
  if (!is_answer) throw std::runtime_error(file.string() + ": the last command has no ----");
  return steps;
}

/// Every `...` of the pattern stands for any text.
bool Matches(std::string_view pattern, std::string_view text) {
  const std::size_t any = pattern.find("...");
  if (any == std::string_view::npos) return pattern == text;
  if (!text.starts_with(pattern.substr(0, any))) return false;
  const std::string_view rest = pattern.substr(any + 3);
  for (std::size_t skip = any; skip <= text.size(); ++skip) {
    if (Matches(rest, text.substr(skip))) return true;
  }
  return false;
}

/// A line `...` of the pattern stands for any number of lines.
bool Matches(std::span<const std::string> pattern, std::span<const std::string> lines) {
  std::size_t next = 0;
  std::size_t behind_any = 0;  // the place behind the last `...`, and the first line that it leaves
  std::size_t left = 0;
  for (std::size_t line = 0; line < lines.size();) {
    if (next < pattern.size() && pattern[next] == "...") {
      behind_any = ++next;
      left = line;
    } else if (next < pattern.size() && Matches(std::string_view(pattern[next]), lines[line])) {
      ++next;
      ++line;
    } else if (behind_any > 0) {
      next = behind_any;
      line = ++left;
    } else {
      return false;
    }
  }
  return std::ranges::all_of(pattern.subspan(next), [](const auto& p) { return p == "..."; });
}

/// The lines that are not blank.
Lines LinesOf(const std::string& text) {
  std::istringstream stream(text);
  Lines lines;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

class Case : public testing::Test {
 public:
  explicit Case(fs::path file) : file_(std::move(file)) {
    fs::create_directories(temporary_.path() / "bin");
    fs::create_directories(folder_);
    fs::create_symlink(GAUNTLET_PROGRAM, temporary_.path() / "bin/gauntlet");
  }

  void TestBody() override {
    for (const Step& step : ReadSteps(file_)) {
      const std::set<std::string> before = Files();
      const ProgramResult result = RunProgram(
          {"/bin/bash", "-c", step.script},
          {.environment = {{"PATH", (temporary_.path() / "bin").string() + ":/usr/bin:/bin"},
                           {"LC_ALL", "C.UTF-8"},
                           {"SOURCE", SourceDir()}},
           .working_directory = folder_,
           .timeout = std::chrono::minutes(5)});  // with sanitizers, on a busy machine
      const Lines output = LinesOf(result.standard_output);
      const Lines error = LinesOf(result.standard_error);
      if (result.exit_code != step.exit_code || !Matches(step.output, output) ||
          !Matches(step.error, error)) {
        ADD_FAILURE_AT(file_.c_str(), step.line) << "answered:\n"
                                                 << Answer(result.exit_code, output, error);
        return;
      }
      if (result.exit_code == 2) ExpectRefusal(step, error, before);
    }
  }

 private:
  /// An answer as it is written in a case.
  static std::string Answer(int exit_code, const Lines& output, const Lines& error) {
    Lines lines = output;
    for (const std::string& line : error) lines.push_back("! " + line);
    std::string text = std::string(kExit) + std::to_string(exit_code) + "\n";
    for (std::size_t i = 0; i < lines.size() && i < 60; ++i) text += lines[i] + "\n";
    return text;
  }

  /// A mistake is told in one short line that a terminal can show, and no file is made.
  void ExpectRefusal(const Step& step, const Lines& error,
                     const std::set<std::string>& before) const {
    EXPECT_EQ(std::ranges::count_if(error, IsNoWarning), 1) << step.script;
    EXPECT_LE(error.at(0).size(), 400u) << step.script;
    EXPECT_TRUE(std::ranges::none_of(error.at(0), [](char c) {
      return (c >= 0 && c < ' ') || c == 127;
    })) << step.script;
    for (const std::string& name : Files()) {
      EXPECT_TRUE(before.contains(name) || step.script.find("> " + name) != std::string::npos)
          << name;
    }
  }

  static bool IsNoWarning(const std::string& line) {
    return !line.starts_with("gauntlet: warning: ");
  }

  std::set<std::string> Files() const {
    std::set<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      files.insert(entry.path().lexically_relative(folder_).string());
    }
    return files;
  }

  fs::path file_;
  TemporaryDirectory temporary_;
  fs::path folder_ = temporary_.path() / "folder";
};

/// Runs the steps of cases with a program of which one call on a file of theirs fails.
class DisturbedCase {
 public:
  /// What one script did.
  struct Outcome {
    Lines ends;  // of each call of the program: "EXIT CODE, LAST LINE OF STANDARD ERROR"
    ProgramResult result;
    long calls = 0;  // most of a call of the program
  };

  explicit DisturbedCase(const fs::path& file) : steps_(ReadSteps(file)) {
    fs::create_directories(Place("bin"));
    // The shell and its tools are not disturbed.
    std::ofstream(Place("bin/gauntlet"))
        << "#!/bin/bash\n"
           "LD_PRELOAD=$FAILING_CALLS " GAUNTLET_PROGRAM
           " \"$@\" 2> \"$ENDS.$$\"\n"
           "code=$?\n"
           "cat \"$ENDS.$$\" >&2\n"
           "echo \"$code, $(tail -n 1 \"$ENDS.$$\")\" >> \"$ENDS\"\n"
           "exit $code\n";
    fs::permissions(Place("bin/gauntlet"), fs::perms::owner_all);
  }

  std::size_t steps() const { return steps_.size(); }
  const Step& step(std::size_t index) const { return steps_[index]; }

  /// Runs all steps, in a new folder, of which one with its `call` failing; none for 0.
  Outcome Run(std::size_t disturbed, long call, int error) {
    fs::remove_all(Place("folder"));
    fs::create_directories(Place("folder"));
    for (std::size_t i = 0; i < disturbed; ++i) RunStep(steps_[i], 0, 0);
    return RunStep(steps_[disturbed], call, error);
  }

 private:
  fs::path Place(const char* name) const { return temporary_.path() / name; }

  Outcome RunStep(const Step& step, long call, int error) {
    fs::remove(Place("log"));
    fs::remove(Place("ends"));
    Outcome outcome;
    outcome.result = RunProgram({"/bin/bash", "-c", step.script},
                                {.environment = {{"PATH", Place("bin").string() + ":/usr/bin:/bin"},
                                                 {"LC_ALL", "C.UTF-8"},
                                                 {"SOURCE", SourceDir()},
                                                 {"FAILING_CALLS", GAUNTLET_FAILING_CALLS},
                                                 {"ENDS", Place("ends").string()},
                                                 {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                                 {"GAUNTLET_FAIL_BELOW", Place("folder").string()},
                                                 {"GAUNTLET_FAIL_LOG", Place("log").string()},
                                                 {"GAUNTLET_FAIL_CALL", std::to_string(call)},
                                                 {"GAUNTLET_FAIL_ERROR", std::to_string(error)}},
                                 .working_directory = Place("folder"),
                                 .timeout = std::chrono::minutes(2)});
    outcome.ends = LinesOf(ReadFile(Place("ends")));
    std::ranges::sort(outcome.ends);  // those of a pipe end in any order
    for (const std::string& line : LinesOf(ReadFile(Place("log")))) {
      if (line.starts_with("calls ")) {
        outcome.calls = std::max(outcome.calls, std::stol(line.substr(6)));
      }
    }
    return outcome;
  }

  std::vector<Step> steps_;
  TemporaryDirectory temporary_;
};

/// A clear end of each call of the program; without one line more, the answer of the case.
void ExpectClearEnd(const Step& step, const DisturbedCase::Outcome& undisturbed,
                    const DisturbedCase::Outcome& outcome) {
  EXPECT_FALSE(outcome.result.timed_out);
  constexpr int kReaderGone = 141;  // as in `gauntlet .. | head`, now and then
  for (const std::string& end : outcome.ends) {
    const int exit_code = std::stoi(end);
    if (exit_code == 0 || exit_code == kReaderGone) continue;
    EXPECT_LE(exit_code, 2) << end;
    const bool is_usual = std::ranges::find(undisturbed.ends, end) != undisturbed.ends.end();
    EXPECT_TRUE(is_usual || end.find(", gauntlet: ") != std::string::npos) << end;
  }
  if (outcome.ends == undisturbed.ends &&
      outcome.result.standard_error == undisturbed.result.standard_error) {
    EXPECT_TRUE(Matches(step.output, LinesOf(outcome.result.standard_output)))
        << outcome.result.standard_output;
  }
}

// A tenth of the cases, another one each time; GAUNTLET_TEST_SEED repeats it.
TEST(DisturbedCases, EndClearlyWhateverCallFails) {
  GAUNTLET_LONG_TEST();
  constexpr auto kMostTime = std::chrono::seconds(15);  // then no further call is tried
  constexpr std::size_t kShare = 10;
  const char* const given = std::getenv("GAUNTLET_TEST_SEED");
  const auto seed =
      given != nullptr ? static_cast<unsigned>(std::stoul(given)) : std::random_device()();
  std::cout << "GAUNTLET_TEST_SEED=" << seed << "\n";
  std::mt19937 random(seed);
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(SourceDir() + "/tests/cli/cases")) {
    if (!entry.is_directory()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::ranges::shuffle(files, random);
  files.resize((files.size() + kShare - 1) / kShare);
  const auto begin = std::chrono::steady_clock::now();
  int tried = 0;
  int noticed = 0;
  for (std::size_t f = 0; f < files.size(); ++f) {
    DisturbedCase disturbed(files[f]);
    const auto until = begin + kMostTime * (f + 1) / files.size();
    const auto has_time = [until] { return std::chrono::steady_clock::now() < until; };
    do {
      const std::size_t step = random() % disturbed.steps();
      const DisturbedCase::Outcome undisturbed = disturbed.Run(step, 0, 0);
      if (undisturbed.calls == 0) continue;
      for (int repeat = 0; repeat < 4 && (repeat == 0 || has_time()); ++repeat) {
        const long call =
            1 + static_cast<long>(random() % static_cast<unsigned long>(undisturbed.calls));
        const int error = random() % 2 == 0 ? EIO : ENOSPC;
        const DisturbedCase::Outcome outcome = disturbed.Run(step, call, error);
        SCOPED_TRACE(files[f].filename().string() + ":" +
                     std::to_string(disturbed.step(step).line) + ", call " + std::to_string(call) +
                     ": " + std::strerror(error) + "\n" + outcome.result.standard_error);
        ExpectClearEnd(disturbed.step(step), undisturbed, outcome);
        ++tried;
        noticed += outcome.ends != undisturbed.ends ? 1 : 0;
      }
    } while (has_time());
  }
  std::cout << tried << " failing calls in " << files.size() << " cases, " << noticed
            << " changed the end of a command\n";
}

const bool kAreRegistered = [] {
  for (const auto& entry : fs::recursive_directory_iterator(SourceDir() + "/tests/cli/cases")) {
    const fs::path file = entry.path();
    if (entry.is_directory()) continue;
#ifdef GAUNTLET_SHORT  // as tests/support/long_test.h has it
    if (file.parent_path().filename() == "long") continue;
#endif
    testing::RegisterTest("Cases", file.stem().c_str(), nullptr, nullptr, file.c_str(), 1,
                          [file] { return new Case(file); });
  }
  return true;
}();

}  // namespace
}  // namespace gauntlet::test
