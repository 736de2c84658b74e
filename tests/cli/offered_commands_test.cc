// Every command that a table, a message or a page offers is run as it stands there, by bash, from a
// folder whose name a shell would take apart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const std::string kFolder = "it's 100 % $(touch made) `touch made`; -n";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// Commands at the beginning of a line or behind a colon, to the end of the line or of those that
/// go on behind a backslash; and those with nothing to fill in: `gauntlet list metrics`.
void AddCommands(const std::string& text, std::set<std::string>& commands) {
  static const std::regex kCommand(
      R"((?:^|\n|: )(gauntlet [a-z]+ (?:\\\n|[^\n])*)|(gauntlet (?:list [a-z]+|[a-z]+ --help)))");
  for (std::sregex_iterator match(text.begin(), text.end(), kCommand), end; match != end; ++match) {
    commands.insert((*match)[1].matched ? match->str(1) : match->str(2));
  }
}

/// In the texts of a page, and in its data.
void AddCommandsOfPage(const std::string& page, std::set<std::string>& commands) {
  static const std::regex kPre(R"(<pre[^>]*>([^<]*)</pre>)");
  for (std::sregex_iterator match(page.begin(), page.end(), kPre), end; match != end; ++match) {
    std::string text = match->str(1);
    for (const auto& [escaped, letter] : std::initializer_list<std::pair<const char*, const char*>>{
             {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "&"}}) {
      text = Replaced(text, escaped, letter);
    }
    AddCommands(text, commands);
  }
  const std::string head = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(head) + head.size();
  for (const auto& point :
       nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin))) {
    AddCommands(point["command"], commands);
  }
}

class OfferedCommands : public testing::Test {
 protected:
  OfferedCommands() {
    fs::create_directories(home_ / "bin");
    fs::create_directory(home_ / kFolder);
    fs::create_symlink(GAUNTLET_PROGRAM, home_ / "bin/gauntlet");
    Write("s.yaml",
          "question: Which filter?\n"
          "glove:\n"
          "  rate_hz: 60\n"
          "  channels: [index_mcp]\n"
          "  motion: {kind: random, duration_s: 0.3, bandwidth_hz: 1}\n"
          "score: {noise_free_twin: false}\n"
          "controllers:\n"
          "  raw: {}\n"
          "  -tuned: {filter: [median, {kind: kalman, q: 0.01}]}\n");
    Write("study.yaml",
          "question: Which q?\n"
          "scenario: s.yaml\n"
          "set: ['event.delay_ms=20']\n"
          "controllers: [-tuned]\n"
          "seeds: 2\n"
          "axes: [{key: 'controllers.-tuned.filter.1.q', values: [0.1, 0.01]}]\n");
  }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(home_ / kFolder / name) << text;
  }
  std::string Here(const std::string& name) const { return kFolder + "/" + name; }
  std::map<std::string, std::string> Environment() const {
    return {{"PATH", (home_ / "bin").string() + ":/usr/bin:/bin"}};
  }

  /// Runs what is to be looked at; what it says is searched, too.
  void Gauntlet(std::vector<std::string> words, std::set<std::string>& commands,
                const fs::path& folder = {}) const {
    words.insert(words.begin(), GAUNTLET_PROGRAM);
    const ProgramResult result =
        RunProgram(words, {.environment = Environment(),
                           .working_directory = folder.empty() ? home_ : folder,
                           .timeout = std::chrono::minutes(5)});
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    AddCommands(result.standard_output, commands);
    AddCommands(result.standard_error, commands);
  }

  void ExpectAllRun(const std::set<std::string>& commands, const fs::path& folder) const {
    for (const std::string& command : commands) {
      const ProgramResult result =
          RunProgram({"/bin/bash", "-c", command}, {.environment = Environment(),
                                                    .working_directory = folder,
                                                    .timeout = std::chrono::minutes(5)});
      EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.standard_error;
    }
    for (const auto& entry : fs::recursive_directory_iterator(home_)) {
      EXPECT_NE(entry.path().filename(), "made") << entry.path();
    }
  }

  TemporaryDirectory temporary_;
  fs::path home_ = temporary_.path();
};

TEST_F(OfferedCommands, OfASweepAndItsPageRun) {
  std::set<std::string> commands;
  Gauntlet({"sweep", Here("study.yaml"), "--out", Here("o")}, commands);
  EXPECT_THAT(commands, SizeIs(1));  // of the table
  AddCommandsOfPage(ReadFile(home_ / kFolder / "o/report.html"), commands);
  EXPECT_THAT(commands, SizeIs(2));  // of the other cell
  ExpectAllRun(commands, home_);
}

TEST_F(OfferedCommands, OfTuningAndItsPagesRun) {
  std::set<std::string> commands;
  Gauntlet({"tune", Here("s.yaml"), "--controller=-tuned", "--free", "filter.1.q=0.001:1:log",
            "--evaluations", "2", "--seeds", "2", "--held-out", "2", "--filter-only", "--out",
            Here("one")},
           commands);
  AddCommandsOfPage(ReadFile(home_ / kFolder / "one/report.html"), commands);
  EXPECT_THAT(commands, SizeIs(2));
  Gauntlet({"tune", Here("s.yaml"), "--controller", "raw", "--all", "--evaluations", "1", "--seeds",
            "2", "--held-out", "2", "--filter-only", "--out", Here("all")},
           commands);
  AddCommandsOfPage(ReadFile(home_ / kFolder / "all/report.html"), commands);
  EXPECT_GT(commands.size(), 10u);
  ExpectAllRun(commands, home_);
}

TEST_F(OfferedCommands, OfRobustRunInTheFolderOfItsPage) {
  std::set<std::string> commands;
  Gauntlet({"robust", Here("s.yaml"), "--hands", "2", "--seeds", "2", "--out", Here("o")},
           commands);
  ExpectAllRun(commands, home_);
  commands.clear();
  AddCommandsOfPage(ReadFile(home_ / kFolder / "o/report.html"), commands);
  EXPECT_GT(commands.size(), 10u);
  ExpectAllRun(commands, home_ / kFolder / "o");
}

TEST_F(OfferedCommands, OfRobustAreTheSameWhereverItRan) {
  std::set<std::string> commands;
  const std::vector<std::string> robust = {"--hands", "2", "--seeds", "2", "--out"};
  const auto words = [&](const std::string& scenario, const std::string& out) {
    std::vector<std::string> all = {"robust", scenario};
    all.insert(all.end(), robust.begin(), robust.end());
    all.push_back(out);
    return all;
  };
  Gauntlet(words(Here("s.yaml"), "here"), commands);
  Gauntlet(words("s.yaml", "../deep/er/there"), commands, home_ / kFolder);
  EXPECT_EQ(ReadFile(home_ / "here/report.html"), ReadFile(home_ / "deep/er/there/report.html"));
}

TEST_F(OfferedCommands, OfAnInspectedRecordingRun) {
  std::string text = "time_s,index_mcp_deg\n";
  for (int row = 0; row < 60; ++row) {
    text += std::to_string(row / 60.0) + "," + std::to_string(row % 30) + "\n";
  }
  Write("glove.csv", text);
  std::set<std::string> commands;
  Gauntlet({"inspect", Here("glove.csv"), "--write-scenario", Here("my glove.yaml")}, commands);
  EXPECT_THAT(commands, SizeIs(1));
  ExpectAllRun(commands, home_);
  // Beginning with what would be an option.
  commands.clear();
  Gauntlet({"inspect", "glove.csv", "--write-scenario=-x.yaml"}, commands, home_ / kFolder);
  EXPECT_THAT(commands, SizeIs(1));
  ExpectAllRun(commands, home_ / kFolder);
}

TEST_F(OfferedCommands, OfComparisonsRun) {
  std::set<std::string> commands;
  Gauntlet({"run", Here("s.yaml"), "--out", Here("run")}, commands);
  Gauntlet({"compare", Here("s.yaml"), "--verbose", "--seeds", "4", "--out", Here("o")}, commands);
  Gauntlet({"compare", Here("s.yaml"), "--seeds", "4", "--out", Here("o")}, commands);
  Gauntlet({"render", Here("o"), "--frame", "0.1", "--size", "480x360"}, commands);
  EXPECT_THAT(commands, Not(IsEmpty()));
  ExpectAllRun(commands, home_);
}

TEST_F(OfferedCommands, OfASweepInSlurmRunAsItsScriptDoes) {
  // sbatch that runs all tasks at once, and squeue that knows no job.
  const auto program = [this](const std::string& name, const std::string& text) {
    std::ofstream(home_ / "bin" / name) << "#!/bin/bash\n" + text;
    fs::permissions(home_ / "bin" / name, fs::perms::owner_all);
  };
  program("sbatch",
          "for task in 1 2; do SLURM_ARRAY_TASK_ID=$task bash \"${@: -1}\" >/dev/null 2>&1; done\n"
          "echo 7\n");
  program("squeue", "echo Invalid job id\n");
  std::vector<std::string> words = {"sweep", Here("study.yaml"), "--slurm", "--seeds",
                                    "3",     "--filter-only",    "--set",   "event.delay_ms=40",
                                    "--out", Here("o"),          "--tasks", "2"};
  std::set<std::string> commands;
  Gauntlet(words, commands);
  EXPECT_THAT(commands, SizeIs(1));
  words.emplace_back("--retry");
  Gauntlet(words, commands);
  ASSERT_THAT(commands, SizeIs(1));  // nothing is missing, and the same is to be done
  const ProgramResult collected =
      RunProgram({"/bin/bash", "-c", *commands.begin()}, {.environment = Environment(),
                                                          .working_directory = home_,
                                                          .timeout = std::chrono::minutes(5)});
  EXPECT_EQ(collected.exit_code, 0) << collected.standard_error;
  EXPECT_THAT(collected.standard_error, HasSubstr("collected 3 trials"));
  EXPECT_THAT(collected.standard_error, Not(HasSubstr("to run")));
  ExpectAllRun(commands, home_);
}

TEST_F(OfferedCommands, InMessagesHaveTheProgramAsItWasCalled) {
  fs::create_symlink(GAUNTLET_PROGRAM, home_ / kFolder / "gauntlet");
  const ProgramResult result =
      RunProgram({"./" + kFolder + "/gauntlet", "run"}, {.working_directory = home_});
  EXPECT_EQ(result.exit_code, 2);
  const std::size_t see = result.standard_error.find("; see ");
  ASSERT_NE(see, std::string::npos) << result.standard_error;
  const std::string command = result.standard_error.substr(see + 6);
  EXPECT_THAT(command, HasSubstr(" run --help"));
  ExpectAllRun({command}, home_);
}

}  // namespace
}  // namespace gauntlet::test
