// No command destroys an input or a result, whatever its output is called.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kScenarioText =
    "question: q\nseed: 1\nglove: {motion: {kind: hold, duration_s: 0.3}}\n"
    "controllers:\n  raw: {filter: none}\n  tuned_kalman: {filter: {kind: kalman, q: 0.01}}\n";

/// Five seconds of a glove at 100 Hz.
std::string Recording() {
  std::string table = "time_s,index_mcp,middle_mcp\n";
  for (int k = 0; k < 500; ++k) {
    table += fmt::format("{:.2f},{:.0f},{:.0f}\n", 0.01 * k, 500.0 + 300.0 * std::sin(0.02 * k),
                         500.0 + 200.0 * std::cos(0.03 * k));
  }
  return table;
}

/// Five seconds of a servo 33 ms behind its command, at 100 Hz.
std::string Log() {
  std::string table = "time_s,claw_command_deg,claw_deg\n";
  const auto command = [](double t) { return 30.0 * std::sin(3.0 * t + 0.4 * t * t); };
  for (int k = 0; k < 500; ++k) {
    const double t = 0.01 * k;
    table += fmt::format("{:.2f},{:.4f},{:.4f}\n", t, command(t), command(t - 0.033));
  }
  return table;
}

class KeptFiles : public testing::Test {
 protected:
  void Put(const std::string& name, const std::string& text) const {
    std::ofstream(In(name), std::ios::binary) << text;
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  ProgramResult Gauntlet(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = folder_.path()});
  }
  void ExpectDone(const std::vector<std::string>& arguments) const {
    const ProgramResult result = Gauntlet(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  }
  std::map<std::string, std::string> Files() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      if (entry.is_regular_file()) {
        files[entry.path().lexically_relative(folder_.path())] = ReadFile(entry.path());
      }
    }
    return files;
  }
  /// Exit code 2, one line that ends so, and every file as it was; none is added.
  void ExpectRefused(const std::vector<std::string>& arguments, const std::string& line) const {
    const auto before = Files();
    const ProgramResult result = Gauntlet(arguments);
    const std::string command = fmt::format("{}", fmt::join(arguments, " "));
    EXPECT_EQ(result.exit_code, 2) << command << "\n" << result.standard_error;
    EXPECT_THAT(result.standard_error, HasSubstr(line)) << command;
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
    EXPECT_TRUE(Files() == before) << command;
  }

  TemporaryDirectory folder_;
};

constexpr const char* kIsInput = "is an input of this command, which no output replaces";
constexpr const char* kIsResult = "is a result of another command, which stays";
constexpr const char* kWasEdited = "was edited, or is no file of this command; --force replaces it";

TEST_F(KeptFiles, ARecordingStaysUnderEveryNameAndForEveryOption) {
  Put("rec.csv", Recording());
  Put("log.csv", Log());
  fs::create_symlink("rec.csv", In("link.csv"));
  fs::create_hard_link(In("rec.csv"), In("same.csv"));
  for (const std::string name : {"rec.csv", "link.csv", "same.csv", "./rec.csv"}) {
    for (const std::string option : {"--plot", "--write-map", "--write-scenario"}) {
      ExpectRefused({"inspect", "rec.csv", option, name}, kIsInput);
    }
  }
  ExpectRefused({"identify", "log.csv", "--out", "log.csv"}, kIsInput);
  ExpectRefused({"inspect", "rec.csv", "--write-map", "a", "--plot", "a"}, "two outputs");
}

TEST_F(KeptFiles, ALogStaysWhateverStandsBesideTheAnswer) {
  Put("x.html", Log());
  Put("y.hand.yaml", Log());
  ExpectRefused({"identify", "x.html", "--out", "x.yaml"}, kIsInput);
  ExpectRefused({"identify", "y.hand.yaml", "--out", "y.yaml"}, kIsInput);
}

TEST_F(KeptFiles, AScenarioStaysWhateverTheResultsAreCalled) {
  for (const char* name : {"tuned_kalman.yaml", "kalman.yaml", "report.html", "cells.csv",
                           "scenario.resolved.yaml", "scores.csv", "robust.csv"}) {
    Put(name, kScenarioText);
  }
  const auto tune = [&](const std::string& scenario) -> std::vector<std::string> {
    return {"tune",
            scenario,
            "--controller",
            "tuned_kalman",
            "--free",
            "filter.q=0.01:1",
            "--seeds",
            "2",
            "--held-out",
            "2",
            "--evaluations",
            "2",
            "--filter-only",
            "--out",
            "."};
  };
  ExpectRefused(tune("tuned_kalman.yaml"), kIsInput);
  ExpectRefused(tune("report.html"), kIsInput);
  ExpectRefused({"tune", "kalman.yaml", "--all", "--controller", "raw", "--seeds", "2",
                 "--held-out", "2", "--evaluations", "2", "--filter-only", "--out", "."},
                kIsInput);
  for (const std::string name : {"report.html", "scenario.resolved.yaml"}) {
    ExpectRefused({"run", name, "--out", "."}, kIsInput);
    ExpectRefused({"compare", name, "--seeds", "2", "--out", "."}, kIsInput);
  }
  ExpectRefused({"robust", "robust.csv", "--hands", "2", "--seeds", "2", "--out", "."}, kIsInput);
  Put("study.yaml",
      "question: q\nscenario: cells.csv\ncontrollers: [tuned_kalman]\nseeds: 2\nphysics: false\n"
      "axes: [{key: controllers.tuned_kalman.filter.q, values: [0.1, 0.01]}]\n");
  ExpectRefused({"sweep", "study.yaml", "--out", "."}, kIsInput);
}

TEST_F(KeptFiles, AnIncludedControllerStays) {
  Put("kalman.yaml", "filter: {kind: kalman, q: 0.01}\n");
  Put("s.yaml",
      "question: q\nglove: {motion: {kind: hold, duration_s: 0.3}}\n"
      "controllers: {raw: {filter: none}, kalman: !include kalman.yaml}\n");
  ExpectRefused({"tune", "s.yaml", "--controller", "kalman", "--free", "filter.q=0.01:1", "--seeds",
                 "2", "--held-out", "2", "--evaluations", "2", "--filter-only", "--out", "."},
                kIsInput);
}

TEST_F(KeptFiles, ResultsStayUnlessTheirOwnCommandRepeatsThem) {
  GAUNTLET_LONG_TEST();
  Put("s.yaml", kScenarioText);
  ExpectDone({"compare", "s.yaml", "--seeds", "2", "--out", "o"});
  for (const std::string name : {"trace.h5", "study.db", "manifest.json", "scores.json",
                                 "scores.csv", "report.html", "scenario.resolved.yaml"}) {
    ExpectRefused({"export", "o", "--controller", "raw", "--out", "o/" + name},
                  "o/" + name + ": is ");
    ExpectRefused({"render", "o", "--out", "o/" + name}, "o/" + name);
    ExpectRefused({"identify", "o", "--out", "o/" + name}, "o/" + name);
  }
  ExpectRefused({"sweep", "study.yaml", "--out", "o"}, "study.yaml: no such file");
  ExpectRefused({"tune", "s.yaml", "--controller", "tuned_kalman", "--free", "filter.q=0.01:1",
                 "--filter-only", "--out", "o"},
                "o: holds results of gauntlet run or compare, which stay");
  ExpectDone({"export", "o", "--controller", "raw"});
  ExpectDone({"export", "o", "--controller", "raw"});  // its own file, made anew
  ExpectDone({"compare", "o/scenario.resolved.yaml", "--seeds", "2", "--out", "o"});
  ExpectDone({"run", "o/scenario.resolved.yaml", "--out", "r"});
  ExpectDone({"run", "r/scenario.resolved.yaml", "--out", "r"});
}

TEST_F(KeptFiles, EditedFilesAreReplacedByForceOnly) {
  GAUNTLET_LONG_TEST();
  Put("rec.csv", Recording());
  Put("log.csv", Log());
  Put("s.yaml", kScenarioText);
  const std::vector<std::vector<std::string>> commands = {
      {"inspect", "rec.csv", "--write-scenario", "g.yaml"},
      {"tune", "s.yaml", "--controller", "tuned_kalman", "--free", "filter.q=0.01:1", "--seeds",
       "2", "--held-out", "2", "--evaluations", "2", "--filter-only", "--out", "t"},
      {"identify", "log.csv", "--out", "c.chain.yaml"}};
  const std::vector<std::vector<std::string>> editable = {
      {"g.yaml", "g.map.csv"}, {"t/tuned_kalman.yaml"}, {"c.chain.yaml", "c.hand.yaml"}};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    ExpectDone(commands[i]);
    ExpectDone(commands[i]);  // not edited: made anew
    for (const std::string& name : editable[i]) {
      const std::string written = ReadFile(In(name));
      ASSERT_THAT(written, testing::StartsWith("# checksum "));
      Put(name, written + "# corrected by hand\n");
      ExpectRefused(commands[i], name + ": " + kWasEdited);
      Put(name, written.substr(written.find('\n') + 1));  // as a spreadsheet leaves it
      ExpectRefused(commands[i], name + ": " + kWasEdited);
      std::vector<std::string> by_force = commands[i];
      by_force.emplace_back("--force");
      ExpectDone(by_force);
      EXPECT_EQ(ReadFile(In(name)), written);
    }
  }
}

TEST_F(KeptFiles, FilesThatPeopleEditAreReadWithTheirChecksum) {
  Put("rec.csv", Recording());
  ExpectDone({"inspect", "rec.csv", "--write-scenario", "g.yaml"});
  ExpectDone({"run", "g.yaml", "--out", "o"});
  Put("s.yaml", kScenarioText);
  ExpectDone({"tune", "s.yaml", "--controller", "tuned_kalman", "--free", "filter.q=0.01:1",
              "--seeds", "2", "--held-out", "2", "--evaluations", "2", "--filter-only", "--out",
              "t"});
  Put("u.yaml",
      "question: q\nglove: {motion: {kind: hold, duration_s: 0.3}}\n"
      "controllers: {raw: {filter: none}, tuned: !include t/tuned_kalman.yaml}\n");
  ExpectDone({"run", "u.yaml", "--out", "p"});
}

}  // namespace
}  // namespace gauntlet::test
