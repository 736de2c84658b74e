// Whatever call on the output folder fails: a clear end, whole files only, and the same command
// again gives what it would have given.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::StartsWith;

class FailingCalls : public testing::TestWithParam<std::string> {
 protected:
  /// The scenario; of a sweep a study file with two cells of it.
  std::string Question() const {
    const std::string scenario = SourceDir() + "/scenarios/hold_still.yaml";
    if (GetParam() != "sweep") return scenario;
    const fs::path study = folder_.path() / "study.yaml";
    std::ofstream(study) << "question: Does it fail well?\nscenario: " << scenario
                         << "\ncontrollers: [tuned_kalman]\nphysics: false\naxes:\n"
                            "  - {key: controllers.tuned_kalman.filter.q, values: [0.01, 0.1]}\n";
    return study;
  }
  /// The command with its results in `out`; the call of this number fails, if there is one.
  ProgramResult Run(const fs::path& out, long call, int error) const {
    std::vector<std::string> command = {
        GAUNTLET_PROGRAM, GetParam(),  Question(), "--set", "glove.motion.duration_s=0.6",
        "--out",          out.string()};
    if (GetParam() != "sweep") command.insert(command.end(), {"--controllers", "raw"});
    if (GetParam() != "run") command.insert(command.end(), {"--seeds", "2", "--jobs", "1"});
    return RunProgram(command, {.environment = {{"LD_PRELOAD", GAUNTLET_FAILING_CALLS},
                                                {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                                {"GAUNTLET_FAIL_BELOW", out.string()},
                                                {"GAUNTLET_FAIL_CALL", std::to_string(call)},
                                                {"GAUNTLET_FAIL_ERROR", std::to_string(error)},
                                                {"GAUNTLET_FAIL_LOG", log_.string()}}});
  }

  /// What has a name to be used: not the database, which is in between its trials.
  static std::map<std::string, std::string> Results(const fs::path& out) {
    std::map<std::string, std::string> results;
    if (!fs::exists(out)) return results;
    for (const auto& entry : fs::directory_iterator(out)) {
      const std::string name = entry.path().filename();
      if (name.starts_with('.') || name.starts_with("study.db")) continue;
      results[name] = ReadFile(entry.path());
    }
    return results;
  }

  TemporaryDirectory folder_;
  fs::path log_ = folder_.path() / "log";
};

TEST_P(FailingCalls, LeaveWholeFilesAndCanBeRepeated) {
  const fs::path first = folder_.path() / "undisturbed";
  ASSERT_EQ(Run(first, 0, 0).exit_code, 0);
  const auto undisturbed = Results(first);
  ASSERT_GE(undisturbed.size(), GetParam() == "sweep" ? 2u : 4u);
  const std::string log = ReadFile(log_);
  ASSERT_THAT(log, StartsWith("calls "));
  const long calls = std::stol(log.substr(6));
  ASSERT_GT(calls, 20);

  constexpr int kTries = 12;
  for (int i = 0; i < kTries; ++i) {
    fs::remove(log_);
    const long call = 1 + (calls - 1) * i / (kTries - 1);
    const int error = i % 2 == 0 ? EIO : ENOSPC;
    const fs::path out = folder_.path() / std::to_string(call);
    const ProgramResult result = Run(out, call, error);
    SCOPED_TRACE(ReadFile(log_) + result.standard_error);
    EXPECT_EQ(result.signal, 0);
    EXPECT_GE(result.exit_code, 0);
    EXPECT_LE(result.exit_code, 2);
    const auto results = Results(out);
    for (const auto& [name, text] : results) EXPECT_EQ(text, undisturbed.at(name)) << name;
    if (result.exit_code == 0) {
      EXPECT_EQ(results.size(), undisturbed.size());
    } else {
      std::string said = result.standard_error;
      if (GetParam() == "sweep" && !said.starts_with("gauntlet: ")) {
        said.erase(0, said.find('\n') + 1);  // how long it will take
      }
      EXPECT_THAT(said, StartsWith("gauntlet: "));
      EXPECT_EQ(std::ranges::count(said, '\n'), 1);
    }

    const ProgramResult again = Run(out, 0, 0);
    EXPECT_EQ(again.exit_code, 0) << again.standard_error;
    EXPECT_TRUE(Results(out) == undisturbed);
    for (const auto& entry : fs::directory_iterator(out)) {
      EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, FailingCalls, testing::Values("run", "compare", "sweep"),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace gauntlet::test
