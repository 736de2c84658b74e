// What `cmake --install` gives: a program that runs from wherever it lies, its pages and
// completion.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The commands that `help --all` lists, and no other indented lines of it.
std::vector<std::string> Commands() {
  const std::string help = RunProgram({GAUNTLET_PROGRAM, "help", "--all"}).standard_output;
  static const std::regex kCommand("  ([a-z]+)  +[A-Z].*");
  std::vector<std::string> commands;
  for (const std::string& line : Lines(help)) {
    std::smatch found;
    if (std::regex_match(line, found, kCommand)) commands.push_back(found.str(1));
  }
  return commands;
}

/// What the sanitizers are told, in builds that have them.
std::map<std::string, std::string> SanitizerVariables() {
  std::map<std::string, std::string> variables;
  for (const char* name : {"ASAN_OPTIONS", "LSAN_OPTIONS", "TSAN_OPTIONS", "UBSAN_OPTIONS"}) {
    if (const char* value = std::getenv(name)) variables[name] = value;
  }
  return variables;
}

/// Gauntlet, installed and then moved; it runs without any variable of its user.
class InstalledTest : public testing::Test {
 protected:
  InstalledTest() {
    const fs::path first = root_ / "first";
    const ProgramResult install = RunProgram(
        {"cmake", "--install", GAUNTLET_BUILD_DIR, "--prefix", first.string(), "--strip"});
    if (install.exit_code != 0) throw std::runtime_error(install.standard_error);
    fs::rename(first, prefix_);
  }

  ProgramResult Gauntlet(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), prefix_ / "bin/gauntlet");
    return RunProgram(arguments, {.environment = SanitizerVariables(),
                                  .inherit_environment = false,
                                  .working_directory = "/"});
  }

  /// What bash offers for the last of the words, in an empty folder.
  std::vector<std::string> Completions(const std::string& words) {
    const std::string script = fmt::format(
        "compopt() {{ :; }}; source '{}'; COMP_WORDS=({}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - "
        "1))\n"
        "_gauntlet gauntlet; printf '%s\\n' \"${{COMPREPLY[@]}}\"",
        (prefix_ / "share/bash-completion/completions/gauntlet").string(), words);
    const std::string path = (prefix_ / "bin").string() + ":/usr/bin:/bin";
    const fs::path folder = root_ / "empty";
    fs::create_directory(folder);
    const ProgramResult result = RunProgram(
        {"bash", "-c", script}, {.environment = {{"PATH", path}}, .working_directory = folder});
    EXPECT_EQ(result.standard_error, "") << words;
    return Lines(result.standard_output);
  }

  TemporaryDirectory folder_;
  const fs::path root_ = fs::canonical(folder_.path());
  const fs::path prefix_ = root_ / "a moved one";
};

TEST_F(InstalledTest, RunsFromWhereverItLies) {
  const ProgramResult list = Gauntlet({"list", "scenarios"});
  ASSERT_EQ(list.exit_code, 0) << list.standard_error;
  const std::string scenarios = prefix_ / "share/gauntlet/scenarios";
  EXPECT_THAT(list.standard_output,
              HasSubstr(scenarios.substr(1) + "/door_opening.yaml\n"));  // as seen from /

  const std::vector<std::string> rest = {"--controllers", "raw", "--set",
                                         "glove.motion.duration_s=0.2", "--out"};
  const auto run = [&](std::vector<std::string> start, const std::string& out) {
    start.insert(start.end(), rest.begin(), rest.end());
    start.push_back(root_ / out);
    return start;
  };
  const ProgramResult installed =
      Gauntlet(run({"run", "scenarios/hold_still.yaml"}, "of_installed"));
  ASSERT_EQ(installed.exit_code, 0) << installed.standard_error;
  const ProgramResult built = RunProgram(
      run({GAUNTLET_PROGRAM, "run", SourceDir() + "/scenarios/hold_still.yaml"}, "of_built"));
  ASSERT_EQ(built.exit_code, 0) << built.standard_error;
  EXPECT_EQ(installed.standard_output, built.standard_output);
  for (const char* file : {"scores.csv", "trace.h5", "scenario.resolved.yaml"}) {
    EXPECT_EQ(ReadFile(root_ / "of_installed" / file), ReadFile(root_ / "of_built" / file)) << file;
  }
}

TEST_F(InstalledTest, HasNoOtherModelsThanItsOwn) {
  fs::remove_all(prefix_ / "share/gauntlet/models");
  const ProgramResult result =
      Gauntlet({"run", "scenarios/hold_still.yaml", "--out", root_ / "out"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_error,
              AllOf(HasSubstr("no models in " + (prefix_ / "share/gauntlet").string()),
                    HasSubstr("GAUNTLET_DATA_DIR")));
}

TEST_F(InstalledTest, DrawsWithItsOwnLibraryAndSaysWhereItShouldBe) {
  const std::string out = root_ / "out";
  ASSERT_EQ(Gauntlet({"run", "scenarios/hold_still.yaml", "--controllers", "raw", "--set",
                      "glove.motion.duration_s=0.5", "--out", out})
                .exit_code,
            0);
  const std::vector<std::string> render = {"render", out, "--frame", "0.2"};
  const ProgramResult drawn = Gauntlet(render);
  EXPECT_EQ(drawn.exit_code, 0) << drawn.standard_error;
  fs::remove_all(prefix_ / "lib/gauntlet");
  const ProgramResult missing = Gauntlet(render);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.standard_error,
              HasSubstr("a part of Gauntlet is missing: no gauntlet_drawing.so in " +
                        (prefix_ / "lib/gauntlet").string()));
}

TEST_F(InstalledTest, HasAPageForEveryCommand) {
  const fs::path pages = prefix_ / "share/man/man1";
  EXPECT_THAT(ReadFile(pages / "gauntlet.1"), HasSubstr("\n.TH GAUNTLET \"1\" \"\""));
  const std::vector<std::string> commands = Commands();
  EXPECT_THAT(commands, AllOf(Contains("run"), Contains("list")));
  for (const std::string& command : commands) {
    const std::string page = ReadFile(pages / fmt::format("gauntlet-{}.1", command));
    EXPECT_THAT(page, HasSubstr(fmt::format("\n.SH NAME\ngauntlet-{} \\- ", command)));
    for (const char* section : {"SYNOPSIS", "OPTIONS", "EXAMPLES", "\"EXIT STATUS\"", "FILES"}) {
      EXPECT_THAT(page, HasSubstr(fmt::format("\n.SH {}\n", section))) << command;
    }
    EXPECT_THAT(ReadFile(pages / "gauntlet.1"), HasSubstr(fmt::format("gauntlet-{} (1)", command)));
  }
}

TEST_F(InstalledTest, CompletesWhatTheProgramKnows) {
  std::vector<std::string> commands = Commands();
  commands.insert(commands.end(), {"--help", "--version"});
  EXPECT_EQ(Completions("gauntlet ''"), commands);
  EXPECT_THAT(Completions("gauntlet run --se"), ElementsAre("--seed", "--set"));
  EXPECT_THAT(Completions("gauntlet run scenarios/hold"), ElementsAre("scenarios/hold_still.yaml"));
  EXPECT_THAT(Completions("gauntlet run scenarios/hold_still.yaml --controllers raw,pap"),
              ElementsAre("raw,paper_kalman"));
  EXPECT_THAT(Completions("gauntlet run scenarios/hold_still.yaml --set controllers.raw.filter_"),
              ElementsAre("controllers.raw.filter_on=", "controllers.raw.filter_at="));
  EXPECT_THAT(Completions("gauntlet compare --set glove.tremor.rm"),
              ElementsAre("glove.tremor.rms_deg="));
  EXPECT_THAT(Completions("gauntlet filter moving_average --set w"), ElementsAre("window="));
  EXPECT_THAT(Completions("gauntlet filter one"), ElementsAre("one_euro"));
  EXPECT_THAT(Completions("gauntlet list me"), ElementsAre("metrics"));
  EXPECT_THAT(Completions("gauntlet calibrate --linearisation tw"), ElementsAre("two_point"));
  EXPECT_THAT(Completions("gauntlet run hold"), ElementsAre("hold_still"));
  EXPECT_THAT(Completions("gauntlet run hold_still --controllers raw,pap"),
              ElementsAre("raw,paper_kalman"));
  // Keys of what the scenario has, not only of its defaults.
  EXPECT_THAT(Completions("gauntlet run hold_still --set controllers.mean_20.filter.w"),
              ElementsAre("controllers.mean_20.filter.window="));
  EXPECT_THAT(Completions("gauntlet tune hold_still --controller mean"), ElementsAre("mean_20"));
  EXPECT_THAT(Completions("gauntlet sweep studies/"), Contains(StartsWith("studies/")));
  EXPECT_THAT(Completions("gauntlet render out --s"), ElementsAre("--speed", "--size"));
  EXPECT_THAT(Completions("gauntlet render out --channel index_m"), ElementsAre("index_mcp"));
  EXPECT_THAT(Completions("gauntlet render out --quality b"), ElementsAre("best"));
  EXPECT_THAT(Completions("gauntlet help ide"), ElementsAre("identify"));
  EXPECT_THAT(Completions("gauntlet help -"), ElementsAre("--all"));
  EXPECT_THAT(Completions("gauntlet nosuch --x"), ElementsAre(""));
}

TEST_F(InstalledTest, KnowsEveryOptionOfEveryCommand) {
  for (const std::string& command : Commands()) {
    const std::string help = Gauntlet({command, "--help"}).standard_output;
    const std::string offered = Gauntlet({"--complete", command, "-"}).standard_output;
    std::set<std::string> known;
    for (const std::string& line : Lines(offered)) known.insert(line.substr(0, line.find('\t')));
    const std::regex option(R"(^  (?:-[a-z],)?(--[a-z-]+))");
    for (const std::string& line : Lines(help)) {
      std::smatch found;
      if (!std::regex_search(line, found, option)) continue;
      EXPECT_EQ(known.count(found.str(1)), 1u) << command << " " << found.str(1);
    }
    EXPECT_THAT(known, Not(IsEmpty())) << command;
  }
}

TEST_F(InstalledTest, CompletesForZsh) {
  const auto offered = [&](const std::string& words) {
    const std::string script = fmt::format(
        "_describe() {{ shift; print -l -- ${{(P)1}} $@[2,-1] }}; _files() {{ print files $@ }}\n"
        "_it() {{ local -a words=({}); local CURRENT=$#words; source '{}' }}; _it",
        words, (prefix_ / "share/zsh/vendor-completions/_gauntlet").string());
    const ProgramResult result =
        RunProgram({"zsh", "-fc", script},
                   {.environment = {{"PATH", (prefix_ / "bin").string() + ":/usr/bin:/bin"}}});
    EXPECT_EQ(result.standard_error, "") << words;
    return Lines(result.standard_output);
  };
  EXPECT_THAT(offered("gauntlet list me"), ElementsAre("metrics"));
  EXPECT_THAT(offered("gauntlet run hold_still --see"),
              ElementsAre(StartsWith("--seed:seed of all random numbers")));
  EXPECT_THAT(offered("gauntlet run hold_still --set event.del"),
              ElementsAre(StartsWith("event.delay_ms=:"), "-S"));
  EXPECT_THAT(offered("gauntlet calibrate rec"), ElementsAre("files", ""));
  EXPECT_THAT(offered("gauntlet render ''"), ElementsAre("files -/", ""));
}

// Elsewhere debug information and assertions name their files.
#ifdef NDEBUG
TEST_F(InstalledTest, DoesNotNameThePlaceWhereItWasBuilt) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(prefix_)) {
    if (!entry.is_regular_file()) continue;
    const std::string bytes = ReadFile(entry.path());
    EXPECT_EQ(bytes.find(SourceDir()), std::string::npos) << entry.path();
    EXPECT_EQ(bytes.find(GAUNTLET_BUILD_DIR), std::string::npos) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 80);
}
#endif

TEST(Version, IsTheSameWhereverItIsWritten) {
  const auto first_match = [](const char* file, const char* pattern) {
    for (const std::string& line : Lines(ReadFile(fs::path(SourceDir()) / file))) {
      std::smatch found;
      if (std::regex_search(line, found, std::regex(pattern))) return found.str(1);
    }
    return std::string("not found");
  };
  const std::string version = RunProgram({GAUNTLET_PROGRAM, "--version"}).standard_output;
  EXPECT_THAT(version, StartsWith("gauntlet "));
  const std::string number = Lines(version).at(0).substr(9);
  EXPECT_EQ(first_match("debian/changelog", R"(^gauntlet \((.*)\))"), number);
  EXPECT_EQ(first_match("CITATION.cff", "^version: (.*)$"), number);
  EXPECT_EQ(first_match("CHANGELOG.md", R"(^## \[([0-9.]+)\])"), number);
  const std::string day = first_match("CHANGELOG.md", R"(^## \[[0-9.]+\] - (.*)$)");
  EXPECT_EQ(first_match("CITATION.cff", "^date-released: \"(.*)\"$"), day);
}

}  // namespace
}  // namespace gauntlet::test
