// The promises of SECURITY.md, of whole commands. What a single part promises is tested there:
// damaged files in tests/fuzz and odd_input_test, whole files in failing_calls_test, pages in
// tests/report, the controller in tests/controller.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Security : public testing::Test {
 protected:
  Security() {
    Put("s.yaml",
        "question: q\nglove: {motion: {kind: hold, duration_s: 0.3}}\n"
        "controllers: {raw: {filter: none}, tuned_kalman: {filter: {kind: kalman, q: 0.01}}}\n");
  }
  void Put(const std::string& name, const std::string& text) const {
    std::ofstream(In(name)) << text;
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  ProgramResult Gauntlet(std::vector<std::string> arguments,
                         std::map<std::string, std::string> environment = {}) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.environment = std::move(environment),
                                  .working_directory = folder_.path(),
                                  .timeout = std::chrono::seconds(120)});
  }

  TemporaryDirectory folder_;
};

// Whoever made the folder can guess names: of earlier versions, and the numbers of processes.
TEST_F(Security, AReceivedFolderWithLinksLeadsNoFileOutOfIt) {
  ASSERT_EQ(Gauntlet({"run", "s.yaml", "--out", "theirs"}).exit_code, 0);
  Put("victim.txt", "mine");
  fs::create_directory(In("precious"));
  Put("precious/thesis.tex", "mine");
  Put("precious/report.html", "mine");
  for (int process = getpid(); process < getpid() + 500; ++process) {
    for (const char* name : {"frame.png", "report.html", "scores.json", "manifest.json"}) {
      fs::create_symlink("../victim.txt", In(fmt::format("theirs/.{}.{}.part", name, process)));
    }
    fs::create_symlink("../precious", In(fmt::format("theirs/.results.{}.part", process)));
  }
  for (const char* name : {"frame.png", "comparison.mp4", "raw.robot.yaml", "trace.raw.csv"}) {
    fs::create_symlink("../victim.txt", In(fmt::format("theirs/{}", name)));
  }
  EXPECT_EQ(Gauntlet({"render", "theirs", "--frame", "0.1", "--out", "theirs/frame.png"}).exit_code,
            0);
  EXPECT_EQ(Gauntlet({"export", "theirs", "--controller", "raw"}).exit_code, 0);
  EXPECT_EQ(Gauntlet({"run", "s.yaml", "--csv", "--out", "theirs"}).exit_code, 0);
  EXPECT_EQ(Gauntlet({"run", "s.yaml", "--seed", "3", "--out", "theirs"}).exit_code, 0);
  EXPECT_EQ(ReadFile(In("victim.txt")), "mine");
  EXPECT_EQ(ReadFile(In("precious/thesis.tex")), "mine");
  EXPECT_EQ(ReadFile(In("precious/report.html")), "mine");
  EXPECT_EQ(std::distance(fs::directory_iterator(In("precious")), {}), 2);
}

TEST_F(Security, APipeInPlaceOfAFileIsOneLineAtOnce) {
  ASSERT_EQ(mkfifo(In("pipe").c_str(), 0600), 0);
  const auto scenario = [this](const std::string& motion, const std::string& raw) {
    Put("p.yaml",
        "question: q\nglove: {motion: " + motion + "}\ncontrollers: {raw: " + raw + "}\n");
  };
  const auto expect_refused = [this](const std::vector<std::string>& arguments) {
    const ProgramResult result = Gauntlet(arguments);
    EXPECT_FALSE(result.timed_out);
    EXPECT_EQ(result.exit_code, 2) << arguments[0];
    EXPECT_THAT(result.standard_error, HasSubstr("pipe: is a pipe, must be a regular file"));
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1);
  };
  const std::string hold = "{kind: hold, duration_s: 0.2}";
  for (const auto& [motion, raw] : std::vector<std::pair<std::string, std::string>>{
           {hold, "{filter: none, calibration: pipe}"},
           {hold, "!include pipe"},
           {"{kind: recording, file: pipe}", "{filter: none}"}}) {
    scenario(motion, raw);
    expect_refused({"run", "p.yaml"});
  }
  scenario(hold, "{filter: none}");
  expect_refused({"run", "p.yaml", "--set", "hand.model_path=" + In("pipe").string()});
  for (const char* command :
       {"run", "compare", "sweep", "robust", "inspect", "identify", "calibrate"}) {
    expect_refused({command, "pipe"});
  }
}

TEST_F(Security, InsideAFolderNothingElseIsRead) {
  fs::create_directory(In("jail"));
  Put("secret.yaml", "secret_word: 1\n");
  Put("secret.csv", "time_s,index_mcp\n0,secret_word\n");
  const auto expect_refused = [this](const std::string& scenario, const std::string& more) {
    Put("jail/s.yaml", scenario);
    std::vector<std::string> arguments = {"run", "jail/s.yaml", "--inside", "jail", "--out", "o"};
    if (!more.empty()) arguments.insert(arguments.end(), {"--set", more});
    const ProgramResult result = Gauntlet(arguments);
    EXPECT_EQ(result.exit_code, 2) << scenario;
    EXPECT_THAT(result.standard_error, testing::Not(HasSubstr("secret_word")));
    EXPECT_FALSE(fs::exists(In("o")));
  };
  const std::string hold = "question: q\nglove: {motion: {kind: hold, duration_s: 0.2}}\n";
  expect_refused(hold + "controllers: {a: !include ../secret.yaml}\n", "");
  expect_refused(hold + "controllers: {a: !include " + In("secret.yaml").string() + "}\n", "");
  expect_refused(hold + "controllers: {a: {filter: none, calibration: ../secret.yaml}}\n", "");
  const std::string raw = "controllers: {a: {filter: none}}\n";
  expect_refused("question: q\nglove: {motion: {kind: recording, file: ../secret.csv}}\n" + raw,
                 "");
  expect_refused("question: q\nglove: {motion: {kind: recording, files: \"../*.csv\"}}\n" + raw,
                 "");
  fs::create_symlink("../secret.csv", In("jail/link.csv"));
  expect_refused("question: q\nglove: {motion: {kind: recording, file: link.csv}}\n" + raw, "");

  // A hand and its parts; the first of them is named so that only the engine finds it.
  fs::copy(SourceDir() + "/models", In("hands"), fs::copy_options::recursive);
  expect_refused(hold + raw, "hand.model_path=" + In("hands/hand_arm.xml").string());
  fs::copy(In("hands/parts"), In("jail/parts"), fs::copy_options::recursive);
  std::string xml = ReadFile(In("hands/hand_arm.xml"));
  xml.replace(xml.find("\"parts/"), 7, "\"&#46;./hands/parts/");
  Put("jail/hand.xml", xml);
  const std::string model = "hand.model_path=" + In("jail/hand.xml").string();
  expect_refused(hold + raw, model);
  EXPECT_EQ(Gauntlet({"run", "jail/s.yaml", "--set", model, "--out", "o"}).exit_code, 0);

  fs::copy(In("hands"), In("jail/hands"), fs::copy_options::recursive);
  const std::string own = "hand.model_path=" + In("jail/hands/hand_arm.xml").string();
  const ProgramResult inside =
      Gauntlet({"run", "jail/s.yaml", "--inside", "jail", "--set", own, "--out", "o"});
  EXPECT_EQ(inside.exit_code, 0) << inside.standard_error;
  const ProgramResult ready = Gauntlet({"run", "hold_still", "--set", "glove.motion.duration_s=0.2",
                                        "--inside", "jail", "--out", "ready"});
  EXPECT_EQ(ready.exit_code, 0) << ready.standard_error;  // Gauntlet's own files
}

TEST_F(Security, NoConnectionIsOpenedAndNoOtherProgramStarted) {
  const std::map<std::string, std::string> watched = {{"LD_PRELOAD", GAUNTLET_WATCHED_CALLS},
                                                      {"ASAN_OPTIONS", "verify_asan_link_order=0"},
                                                      {"GAUNTLET_WATCH_LOG", In("log").string()}};
  // The watch sees such a call.
  RunProgram({"/bin/sh", "-c", "/bin/true; exit 0"}, {.environment = watched});
  ASSERT_THAT(ReadFile(In("log")), HasSubstr("/bin/true"));
  fs::remove(In("log"));
  Put("rec.csv", "time_s,index_mcp\n0,500\n0.02,510\n0.04,530\n0.06,500\n");
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"compare", "s.yaml", "--seeds", "2", "--video", "--out", "o"},
           {"export", "o", "--controller", "raw"},
           {"diff", "o", "o"},
           {"inspect", "rec.csv", "--write-scenario", "g.yaml", "--plot", "g.png"}}) {
    const ProgramResult result = Gauntlet(arguments, watched);
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  }
  EXPECT_EQ(ReadFile(In("log")), "");
  EXPECT_THAT(ReadFile(In("o/report.html")),
              testing::Not(testing::ContainsRegex("(src|href|url\\()=?[\"']?https?:")));
}

}  // namespace
}  // namespace gauntlet::test
