// Whatever call on the output folder fails, wherever the disk is full, whenever the program is
// killed: a clear end, whole files only, and the same command again gives what it would have given.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <thread>

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::StartsWith;

const std::string kScenario = SourceDir() + "/scenarios/hold_still.yaml";

/// A study file with two cells of a scenario.
std::string Study(const fs::path& folder) {
  std::ofstream(folder / "study.yaml")
      << "question: Does it fail well?\nscenario: " << kScenario
      << "\ncontrollers: [tuned_kalman]\nphysics: false\naxes:\n"
         "  - {key: controllers.tuned_kalman.filter.q, values: [0.01, 0.1]}\n";
  return folder / "study.yaml";
}

/// Ten seconds of a servo that follows its commands 33 ms late, at 100 Hz.
std::string Log(const fs::path& folder) {
  std::ofstream log(folder / "claw.csv");
  log << "time_s,claw_command_deg,claw_deg\n";
  const auto command_deg = [](double t) {
    return 30.0 * std::sin(3.0 * t) + 8.0 * std::sin(7.1 * t + 0.4 * t * t);
  };
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.01 * k;
    log << fmt::format("{:.2f},{:.4f},{:.4f}\n", t, command_deg(t), command_deg(t - 0.033));
  }
  return folder / "claw.csv";
}

/// Three seconds of two sensors at 100 Hz.
std::string Recording(const fs::path& folder) {
  std::ofstream recording(folder / "glove.csv");
  recording << "time_s,index_mcp,middle_mcp\n";
  for (int k = 0; k < 300; ++k) {
    recording << fmt::format("{:.2f},{:.0f},{:.0f}\n", 0.01 * k, 500 + 300 * std::sin(0.03 * k),
                             520 + 200 * std::cos(0.05 * k));
  }
  return folder / "glove.csv";
}

struct Command {
  std::string name;
  std::size_t results = 0;  // that it writes, at least
  int tries = 12;           // fewer of a command that takes longer
  /// More arguments for other results; none for a command that writes no manifest.
  std::vector<std::string> other;
  /// Its arguments. `given`: a folder for its inputs; `out`: where its results go.
  std::vector<std::string> (*arguments)(const fs::path& given, const std::string& out);
};

bool IsLong(const Command& command) {
  return command.name == "robust" || command.name == "identify";
}

const Command kCommands[] = {
    {"run",
     6,
     12,
     {"--set", "seed=7"},
     [](const fs::path&, const std::string& out) -> std::vector<std::string> {
       return {"run",           kScenario, "--set", "glove.motion.duration_s=0.6",
               "--controllers", "raw",     "--out", out};
     }},
    {"compare",
     6,
     12,
     {"--set", "seed=7"},
     [](const fs::path&, const std::string& out) -> std::vector<std::string> {
       return {"compare",       kScenario, "--set",   "glove.motion.duration_s=0.6",
               "--controllers", "raw",     "--seeds", "2",
               "--jobs",        "1",       "--out",   out};
     }},
    {"sweep",
     3,
     10,
     {"--set", "seed=7"},
     [](const fs::path& given, const std::string& out) -> std::vector<std::string> {
       return {"sweep",   Study(given), "--set",  "glove.motion.duration_s=0.6",
               "--seeds", "2",          "--jobs", "1",
               "--out",   out};
     }},
    {"tune",
     4,
     6,
     {"--set", "seed=7"},
     [](const fs::path&, const std::string& out) -> std::vector<std::string> {
       return {"tune",
               kScenario,
               "--set",
               "glove.motion.duration_s=0.6",
               "--controller",
               "tuned_kalman",
               "--free",
               "filter.q=0.001:1:log",
               "--filter-only",
               "--evaluations",
               "2",
               "--seeds",
               "2",
               "--held-out",
               "2",
               "--jobs",
               "1",
               "--out",
               out};
     }},
    {"robust",
     6,
     3,
     {"--set", "seed=7"},
     [](const fs::path&, const std::string& out) -> std::vector<std::string> {
       return {"robust",        kScenario,
               "--set",         "glove.motion.duration_s=0.3",
               "--controllers", "raw,tuned_kalman",
               "--hands",       "2",
               "--seeds",       "2",
               "--jobs",        "1",
               "--out",         out};
     }},
    {"identify",
     4,
     8,
     {"--held"},
     [](const fs::path& given, const std::string& out) -> std::vector<std::string> {
       return {"identify", Log(given), "--out", out + "/claw.chain.yaml"};
     }},
    {"inspect",
     3,
     10,
     {},
     [](const fs::path& given, const std::string& out) -> std::vector<std::string> {
       return {"inspect",           Recording(given), "--write-scenario",
               out + "/glove.yaml", "--plot",         out + "/glove.png"};
     }},
};

void PrintTo(const Command& command, std::ostream* stream) { *stream << command.name; }

class DisturbedCommand : public testing::TestWithParam<Command> {
 protected:
  std::vector<std::string> Arguments(const fs::path& out) const {
    std::vector<std::string> arguments = GetParam().arguments(folder_.path(), out.string());
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return arguments;
  }
  /// `disturbance`: variables of failing_calls.cc. `more`: arguments.
  ProgramResult Run(const fs::path& out, std::map<std::string, std::string> disturbance = {},
                    const std::vector<std::string>& more = {}) const {
    fs::remove(log_);
    disturbance.insert({{"LD_PRELOAD", GAUNTLET_FAILING_CALLS},
                        {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                        {"GAUNTLET_FAIL_BELOW", out.string()},
                        {"GAUNTLET_FAIL_LOG", log_.string()}});
    std::vector<std::string> arguments = Arguments(out);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(arguments, {.environment = std::move(disturbance)});
  }

  /// What has a name to be used: not the database, which is in between its trials, nor a manifest
  /// that says that it is not finished.
  static std::map<std::string, std::string> Results(const fs::path& out) {
    std::map<std::string, std::string> results;
    if (!fs::exists(out)) return results;
    for (const auto& entry : fs::directory_iterator(out)) {
      const std::string name = entry.path().filename();
      if (name.starts_with('.') || name.starts_with("study.db")) continue;
      std::string text = ReadFile(entry.path());
      if (text.find("\"finished\": false") == std::string::npos) results[name] = std::move(text);
    }
    return results;
  }

  /// The results of a run that nothing disturbs, and the number of its calls.
  void RunUndisturbed() {
    const fs::path out = folder_.path() / "undisturbed";
    ASSERT_EQ(Run(out).exit_code, 0);
    undisturbed_ = Results(out);
    ASSERT_GE(undisturbed_.size(), GetParam().results);
    const std::string log = ReadFile(log_);
    ASSERT_THAT(log, StartsWith("calls "));
    calls_ = std::stol(log.substr(6));
    ASSERT_GT(calls_, 10);
  }
  /// A clear end, and whole files only.
  void ExpectWhole(const ProgramResult& result, const fs::path& out) const {
    EXPECT_EQ(result.signal, 0);
    EXPECT_GE(result.exit_code, 0);
    EXPECT_LE(result.exit_code, 2);
    const auto results = Results(out);
    for (const auto& [name, text] : results) EXPECT_EQ(text, undisturbed_.at(name)) << name;
    if (result.exit_code == 0) {
      EXPECT_EQ(results.size(), undisturbed_.size());
      return;
    }
    // Before it there may be how long it will take, and what was written before.
    std::string said = result.standard_error;
    ASSERT_THAT(said, testing::EndsWith("\n"));
    said.erase(0, said.rfind('\n', said.size() - 2) + 1);
    EXPECT_THAT(said, StartsWith("gauntlet: "));
  }
  void ExpectSameAgain(const fs::path& out) const {
    const ProgramResult again = Run(out);
    EXPECT_EQ(again.exit_code, 0) << again.standard_error;
    EXPECT_TRUE(Results(out) == undisturbed_);
    for (const auto& entry : fs::directory_iterator(out)) {
      EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    }
  }

  TemporaryDirectory folder_;
  fs::path log_ = folder_.path() / "log";
  std::map<std::string, std::string> undisturbed_;
  long calls_ = 0;
};

TEST_P(DisturbedCommand, LeavesWholeFilesWhateverCallFails) {
  if (IsLong(GetParam()) || GetParam().name == "run" || GetParam().name == "compare") {
    GAUNTLET_LONG_TEST();
  }
  ASSERT_NO_FATAL_FAILURE(RunUndisturbed());
  const int tries = GetParam().tries;
  for (int i = 0; i < tries; ++i) {
    const long call = 1 + (calls_ - 1) * i / (tries - 1);
    const fs::path out = folder_.path() / std::to_string(call);
    const ProgramResult result =
        Run(out, {{"GAUNTLET_FAIL_CALL", std::to_string(call)},
                  {"GAUNTLET_FAIL_ERROR", std::to_string(i % 2 == 0 ? EIO : ENOSPC)}});
    SCOPED_TRACE(ReadFile(log_) + result.standard_error);
    ExpectWhole(result, out);
    ExpectSameAgain(out);
  }
}

TEST_P(DisturbedCommand, LeavesWholeFilesOnAFullDisk) {
  if (IsLong(GetParam())) GAUNTLET_LONG_TEST();
  ASSERT_NO_FATAL_FAILURE(RunUndisturbed());
  const int tries = (GetParam().tries + 1) / 2;
  for (int i = 0; i < tries; ++i) {
    const long call = 1 + (calls_ - 1) * i / tries;
    const fs::path out = folder_.path() / std::to_string(call);
    const ProgramResult result = Run(out, {{"GAUNTLET_FAIL_CALL", std::to_string(call)},
                                           {"GAUNTLET_FAIL_ERROR", std::to_string(ENOSPC)},
                                           {"GAUNTLET_FAIL_FULL", "1"}});
    SCOPED_TRACE(ReadFile(log_) + result.standard_error);
    EXPECT_EQ(result.exit_code, 1);
    ExpectWhole(result, out);
    ExpectSameAgain(out);
  }
}

TEST_P(DisturbedCommand, KilledAtRandomMomentsItEndsWithTheSameBytes) {
  if (IsLong(GetParam())) GAUNTLET_LONG_TEST();
  ASSERT_NO_FATAL_FAILURE(RunUndisturbed());
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Run(folder_.path() / "timed").exit_code, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  std::mt19937 random(20261125);  // moments only; no result depends on them
  const fs::path out = folder_.path() / "killed";
  for (int kill = 0; kill < GetParam().tries; ++kill) {
    Program program(Arguments(out));
    std::this_thread::sleep_for(whole * (static_cast<double>(random() % 1000) / 1000.0));
    program.SendSignal(SIGKILL);
    program.Wait();
  }
  ExpectSameAgain(out);
}

/// A command that writes a manifest.
class RepeatedCommand : public DisturbedCommand {};

// Two runs, of which the second is killed at each rename in turn.
TEST_P(RepeatedCommand, NeverLeavesFilesOfTwoRunsUnmarked) {
  GAUNTLET_LONG_TEST();
  const fs::path first = folder_.path() / "first";
  const fs::path out = folder_.path() / "out";
  ASSERT_EQ(Run(first).exit_code, 0);
  const auto of_first = Results(first);
  ASSERT_EQ(Run(out, {}, GetParam().other).exit_code, 0);
  const auto of_second = Results(out);
  ASSERT_NE(of_first, of_second);
  int marked = 0;
  for (int rename = 1;; ++rename) {
    fs::remove_all(out);
    fs::copy(first, out);
    const ProgramResult result = Run(out,
                                     {{"GAUNTLET_FAIL_ONLY", "renameat"},
                                      {"GAUNTLET_FAIL_CALL", std::to_string(rename)},
                                      {"GAUNTLET_FAIL_KILL", "1"}},
                                     GetParam().other);
    if (result.signal != SIGKILL) break;
    const auto results = Results(out);
    const bool is_marked = std::ranges::none_of(
        results, [](const auto& file) { return file.first.ends_with("manifest.json"); });
    marked += is_marked;
    EXPECT_TRUE(is_marked || results == of_first || results == of_second) << rename;
    ASSERT_EQ(Run(out, {}, GetParam().other).exit_code, 0);
    EXPECT_EQ(Results(out), of_second) << rename;
  }
  EXPECT_GE(marked, 2);
}

constexpr auto kNameOf = [](const testing::TestParamInfo<Command>& tested) {
  return tested.param.name;
};
INSTANTIATE_TEST_SUITE_P(Each, DisturbedCommand, testing::ValuesIn(kCommands), kNameOf);
INSTANTIATE_TEST_SUITE_P(Each, RepeatedCommand,
                         testing::ValuesIn(kCommands, std::end(kCommands) - 1), kNameOf);

}  // namespace
}  // namespace gauntlet::test
