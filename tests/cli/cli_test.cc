// The program as a program: exit codes, messages, files, determinism.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kProgram = GAUNTLET_PROGRAM;
const std::string kScenarios = SourceDir() + "/scenarios/";

// One and a half seconds of motion: enough for every stage to work, little enough for many tests.
const std::vector<std::string> kShort = {"--set", "glove.motion.duration_s=1.5"};

const std::string kGood =
    "question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\ncontrollers: {raw: {}}\n";

ProgramResult Filter(std::vector<std::string> arguments, const std::string& input) {
  arguments.insert(arguments.begin(), {kProgram, "filter"});
  ProgramOptions options;
  options.standard_input = input;
  return RunProgram(arguments, options);
}

/// Compares without printing a whole file when it fails.
bool SameBytes(const fs::path& a, const fs::path& b) { return ReadFile(a) == ReadFile(b); }

/// In columns of a terminal.
std::size_t WidestLine(const std::string& text) {
  std::size_t width = 0;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    width = std::max<std::size_t>(width, std::ranges::count_if(line, [](unsigned char c) {
                                    return c >= ' ' && (c & 0xC0U) != 0x80U;
                                  }));
  }
  return width;
}

class CliTest : public testing::Test {
 protected:
  ProgramResult Gauntlet(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), kProgram);
    ProgramOptions options;
    options.working_directory = folder_.path();
    options.timeout = std::chrono::minutes(5);  // reproduce, with sanitizers, on a busy machine
    return RunProgram(arguments, options);
  }
  ProgramResult ShortRun(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), kShort.begin(), kShort.end());
    return Gauntlet(std::move(arguments));
  }
  fs::path Out(const std::string& name) const { return folder_.path() / name; }
  std::string WriteScenario(const std::string& text) const {
    std::ofstream(folder_.path() / "scenario.yaml") << text;
    return "scenario.yaml";
  }
  /// What is left in the working folder besides the scenario.
  std::vector<std::string> Leftovers() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      if (entry.path().filename() != "scenario.yaml") names.push_back(entry.path().string());
    }
    return names;
  }

  /// By how much the content of a page, and of each of its parts that scroll sideways, is wider
  /// than its place in a browser. The page may have no script of its own.
  std::vector<int> Overhang_px(std::string page, int window_px) const {
    const std::size_t policy = page.find("<meta http-equiv=\"Content-Security-Policy\"");
    page.erase(policy, page.find('>', policy) - policy + 1);
    page += R"(<script>
      const parts = [document.documentElement, ...document.querySelectorAll(".scroll")];
      document.title = "overhang " + parts.map((p) => p.scrollWidth - p.clientWidth).join(" ") + ";";
    </script>)";
    std::ofstream(Out("page.html")) << page;
    const ProgramResult result =
        RunProgram({"chromium", "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
                    "--user-data-dir=" + Out("profile").string(),
                    "--window-size=" + std::to_string(window_px) + ",900", "--dump-dom",
                    "file://" + Out("page.html").string()});
    const std::string mark = "<title>overhang ";
    const std::size_t begin = result.standard_output.find(mark);
    if (begin == std::string::npos) return {};
    std::istringstream text(result.standard_output.substr(begin + mark.size()));
    std::vector<int> overhang_px;
    for (int value = 0; text >> value;) overhang_px.push_back(value);
    return overhang_px;
  }

  TemporaryDirectory folder_;
};

TEST_F(CliTest, RunPrintsATableAndWritesTheFiles) {
  const ProgramResult result = ShortRun({"run", kScenarios + "random_motion.yaml", "--out", "a"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output,
              AllOf(HasSubstr("tracking "), HasSubstr("raw"), HasSubstr("paper_kalman"),
                    HasSubstr("One seed tells nothing about chance")));
  for (const char* name :
       {"report.html", "scores.json", "scores.csv", "trace.h5", "scenario.resolved.yaml"}) {
    EXPECT_TRUE(fs::exists(Out("a") / name)) << name;
  }
  EXPECT_FALSE(fs::exists(Out("MUJOCO_LOG.TXT")));
  const auto json = nlohmann::json::parse(ReadFile(Out("a") / "scores.json"));
  EXPECT_EQ(json["scenario"], "random_motion");
  EXPECT_EQ(json["controllers"][0]["name"], "raw");
  EXPECT_TRUE(json["controllers"][0]["summary"]["tracking_rmse_deg"].is_number());
  EXPECT_TRUE(json["controllers"][0]["channels"]["index_mcp"]["jitter_rms_deg"].is_number());
}

TEST_F(CliTest, TheSameSeedGivesTheSameBytesAndAnotherSeedDoesNot) {
  const std::string scenario = kScenarios + "random_motion.yaml";
  ASSERT_EQ(ShortRun({"run", scenario, "--out", "a"}).exit_code, 0);
  ASSERT_EQ(ShortRun({"run", scenario, "--out", "b"}).exit_code, 0);
  ASSERT_EQ(ShortRun({"run", scenario, "--out", "c", "--seed", "2"}).exit_code, 0);
  EXPECT_TRUE(SameBytes(Out("a") / "scores.json", Out("b") / "scores.json"));
  EXPECT_TRUE(SameBytes(Out("a") / "trace.h5", Out("b") / "trace.h5"));
  EXPECT_FALSE(SameBytes(Out("a") / "scores.json", Out("c") / "scores.json"));
}

TEST_F(CliTest, TheResolvedScenarioRepeatsTheRun) {
  ASSERT_EQ(
      ShortRun({"run", kScenarios + "random_motion.yaml", "--out", "a", "--seed", "5"}).exit_code,
      0);
  const ProgramResult again = Gauntlet({"run", "a/scenario.resolved.yaml", "--out", "b"});
  ASSERT_EQ(again.exit_code, 0) << again.standard_error;
  for (const char* name : {"scores.json", "scores.csv", "trace.h5", "scenario.resolved.yaml"}) {
    EXPECT_TRUE(SameBytes(Out("a") / name, Out("b") / name)) << name;
  }
}

TEST_F(CliTest, WarnsWhereAScenarioWasResolvedOnAnotherKindOfProcessor) {
  ASSERT_EQ(Gauntlet({"run", WriteScenario(kGood), "--out", "a"}).exit_code, 0);
  const std::string warning = "differ in the last bits";
  const ProgramResult same = Gauntlet({"run", "a/scenario.resolved.yaml", "--out", "b"});
  EXPECT_THAT(same.standard_error, Not(HasSubstr(warning)));

  std::string resolved = ReadFile(Out("a") / "scenario.resolved.yaml");
  const std::string key = "mathematics: \"";
  ASSERT_NE(resolved.find(key), std::string::npos);
  resolved.replace(resolved.find(key) + key.size(), 4, "none");
  const ProgramResult other = Gauntlet({"run", WriteScenario(resolved), "--out", "c"});
  EXPECT_EQ(other.exit_code, 0);
  EXPECT_THAT(other.standard_error, HasSubstr(warning));
}

TEST_F(CliTest, ReproduceMeasuresThePaper) {
  const ProgramResult result = Gauntlet({"reproduce", "--quick", "--out", "paper"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output,
              AllOf(HasSubstr("Much less local jumps"), HasSubstr("Of 9 claims: ")));
  const std::string page = ReadFile(Out("paper") / "reproduce.html");
  for (const char* row : {">P1</td>", ">P17</td>", "Figure 4", "Figure 7", "Figure 9", "Figure 10",
                          "Figure 12: channel 16"}) {
    EXPECT_THAT(page, HasSubstr(row));
  }
  EXPECT_THAT(page, testing::Not(HasSubstr("http-equiv=\"refresh\"")));
  for (const char* name : {"figure_04.svg", "figure_07.svg", "figure_09.svg", "figure_10.svg",
                           "figure_12_channel_01.svg", "scores.json", "trace.h5"}) {
    EXPECT_TRUE(fs::exists(Out("paper") / name)) << name;
  }
  if (RunProgram({"sh", "-c", "command -v chromium"}).exit_code != 0) return;
  // 500 px is the narrowest window of chromium; the layout of a phone begins at 768.
  const std::vector<int> overhang_px = Overhang_px(page, 500);
  EXPECT_EQ(overhang_px.size(), 5u);  // the page and its four tables
  EXPECT_THAT(overhang_px, testing::Each(testing::Le(0)));
}

TEST_F(CliTest, AComparisonDoesNotDependOnTheNumberOfJobs) {
  const std::string scenario = kScenarios + "hold_still.yaml";
  ASSERT_EQ(ShortRun({"compare", scenario, "--seeds", "3", "--jobs", "1", "--out", "a"}).exit_code,
            0);
  ASSERT_EQ(ShortRun({"compare", scenario, "--seeds", "3", "--jobs", "3", "--out", "b"}).exit_code,
            0);
  for (const char* name : {"scores.json", "scores.csv", "trace.h5"}) {
    EXPECT_TRUE(SameBytes(Out("a") / name, Out("b") / name)) << name;
  }
  const auto json = nlohmann::json::parse(ReadFile(Out("a") / "scores.json"));
  EXPECT_EQ(json["seeds"].size(), 3u);
  const auto& jitter = json["controllers"][0]["summary"]["jitter_rms_deg"];
  EXPECT_LE(jitter["ci95_low"], jitter["mean"]);
  EXPECT_LE(jitter["mean"], jitter["ci95_high"]);
}

TEST_F(CliTest, TablesFitTheTerminalAndHaveColoursOnlyThere) {
  const std::string scenario = WriteScenario(
      "question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\n"
      "controllers: {raw: {}, slow: {filter: {kind: moving_average, window: 90}}}\n");
  const auto compare = [&](const std::string& variables, const std::string& more) {
    // A terminal of 60 columns; what the program says on standard error is left out.
    const ProgramResult result = RunProgram(
        {"script", "--quiet", "--return", "--command",
         fmt::format("stty cols 60; cd '{}'; env -u COLUMNS -u NO_COLOR {} '{}' compare {} --seeds "
                     "2 {} 2>/dev/null",
                     folder_.path().string(), variables, kProgram, scenario, more),
         "/dev/null"});
    EXPECT_EQ(result.exit_code, 0) << result.standard_output;
    return result.standard_output;
  };
  const std::string plain = compare("NO_COLOR=1", "");
  EXPECT_THAT(plain, AllOf(HasSubstr("tracking"), Not(HasSubstr("\033["))));
  EXPECT_LE(WidestLine(plain), 60u);
  EXPECT_GT(WidestLine(compare("NO_COLOR=1", "--wide")), 60u);
  EXPECT_GT(WidestLine(compare("NO_COLOR=1 COLUMNS=90", "")), 60u);
  EXPECT_THAT(compare("", ""), HasSubstr("\033["));
  EXPECT_THAT(compare("", "--color never"), Not(HasSubstr("\033[")));
  EXPECT_THAT(compare("NO_COLOR=1", "--color always"), HasSubstr("\033["));

  const ProgramResult piped = Gauntlet({"compare", scenario, "--seeds", "2"});
  EXPECT_THAT(piped.standard_output, Not(HasSubstr("\033[")));
  EXPECT_LE(WidestLine(piped.standard_output), 80u);
  EXPECT_THAT(Gauntlet({"compare", scenario, "--color", "yes"}).standard_error,
              HasSubstr("--color: yes not in {auto,always,never}"));
}

TEST_F(CliTest, JsonGoesToStandardOutput) {
  const ProgramResult result =
      ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "a", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_output, ReadFile(Out("a") / "scores.json"));
}

TEST_F(CliTest, CsvTracesHaveARowPerSample) {
  ASSERT_EQ(ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "a", "--csv", "--controllers",
                      "raw"})
                .exit_code,
            0);
  const std::string text = ReadFile(Out("a") / "trace.raw.csv");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1501);
  EXPECT_THAT(text, StartsWith("t_s,true_angle_rad.thumb_rotation,"));
}

TEST_F(CliTest, RenderMakesAVideoOfAFinishedRun) {
  ASSERT_EQ(ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "a", "--set",
                      "video.width_px=640", "--set", "video.height_px=360"})
                .exit_code,
            0);
  const ProgramResult result = Gauntlet({"render", "a", "--controllers", "raw,mean_20"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_GT(fs::file_size(Out("a") / "comparison.mp4"), 1000u);
  EXPECT_EQ(Gauntlet({"render", "a", "--controllers", "rav"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"render", "a", "--controllers", "raw,raw"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"render", "a", "--out", "video.avi"}).exit_code, 2);
  EXPECT_FALSE(fs::exists(Out("video.avi")));

  ASSERT_EQ(Gauntlet({"render", "a", "--frame", "1", "--camera", "arm", "--channel", "middle_pip",
                      "--size", "800x450", "--controllers", "raw"})
                .exit_code,
            0);
  EXPECT_TRUE(fs::exists(Out("a") / "comparison.png"));
  ASSERT_EQ(Gauntlet({"render", "a", "--from", "0.5", "--to", "0.7", "--speed", "0.5", "--quality",
                      "small", "--fps", "25", "--controllers", "raw", "--out", "b.webm"})
                .exit_code,
            0);
  EXPECT_TRUE(fs::exists(Out("b.webm")));
  ASSERT_EQ(Gauntlet({"render", "a", "--from", "0.5", "--to", "0.7", "--fps", "20", "--controllers",
                      "raw", "--out", "b.gif"})
                .exit_code,
            0);
  EXPECT_THAT(ReadFile(Out("b.gif")), StartsWith("GIF89a"));
  const auto refusal = [&](std::vector<std::string> options) {
    options.insert(options.begin(), {"render", "a"});
    const ProgramResult refused = Gauntlet(options);
    EXPECT_EQ(refused.exit_code, 2);
    return refused.standard_error;
  };
  ASSERT_EQ(Gauntlet({"render", "--overlay", "mean_20,raw", "a", "--frame", "1", "--out", "o.png"})
                .exit_code,
            0);
  EXPECT_NE(ReadFile(Out("o.png")), ReadFile(Out("a") / "comparison.png"));
  EXPECT_THAT(refusal({"--overlay", "raw"}), HasSubstr("--overlay raw: must be two controllers"));
  EXPECT_THAT(refusal({"--overlay", "raw,raw"}), HasSubstr("not one twice"));
  EXPECT_THAT(refusal({"--overlay", "raw,mean_2"}),
              HasSubstr("--overlay: mean_2: unknown controller (did you mean mean_20?)"));
  EXPECT_THAT(refusal({"--overlay", "raw,mean_20", "--controllers", "raw"}),
              HasSubstr("leave --controllers out"));
  EXPECT_THAT(refusal({"--camera", "amr"}), HasSubstr("--camera amr: amr is not a camera"));
  EXPECT_THAT(refusal({"--channel", "x"}), HasSubstr("--channel x: x is not"));
  EXPECT_THAT(refusal({"--size", "100x450"}), HasSubstr("--size 100x450: is 100, must be from"));
  EXPECT_THAT(refusal({"--size", "800"}), HasSubstr("as 1280x720"));
  EXPECT_THAT(refusal({"--size", "801x450"}), HasSubstr("even"));
  EXPECT_THAT(refusal({"--fps", "0"}), HasSubstr("--fps 0: is 0, must be from 1 to 120"));
  EXPECT_THAT(refusal({"--speed", "0"}),
              HasSubstr("--speed: is '0', must be a number from 0.01 to 100"));
  EXPECT_THAT(refusal({"--from", "2", "--to", "1"}), HasSubstr("--from must come before --to"));
  EXPECT_THAT(refusal({"--from", "99"}), HasSubstr("nothing to show from"));
  EXPECT_THAT(refusal({"--frame", "99"}), HasSubstr("--frame 99: must be from 0 to"));
  EXPECT_THAT(refusal({"--quality", "x"}), HasSubstr("small, good and best"));
  EXPECT_THAT(refusal({"--look", "x"}), HasSubstr("--look x: must be one of fast, good and best"));
  EXPECT_THAT(refusal({"--frame", "1", "--out", "x.mp4"}), HasSubstr("must end in .png"));
  EXPECT_EQ(Gauntlet({"render", "nowhere"}).exit_code, 2);
}

#if !defined(__SANITIZE_ADDRESS__)  // its shadow memory takes terabytes of addresses
TEST_F(CliTest, TooLittleMemoryForAVideoIsOneErrorAndNoCrash) {
  ASSERT_EQ(Gauntlet({"run", WriteScenario(kGood), "--out", "a"}).exit_code, 0);
  const auto before = Leftovers();
  int failed = 0;
  // How much a library needs differs from machine to machine: some of these fail in drawing, some
  // in encoding, the largest may do.
  for (const int limit_kb : {450'000, 500'000, 550'000, 600'000, 700'000}) {
    ProgramOptions options;
    options.working_directory = folder_.path();
    const ProgramResult result =
        RunProgram({"sh", "-c", fmt::format("ulimit -v {}; exec \"$0\" \"$@\"", limit_kb), kProgram,
                    "render", "a", "--out", "b.mp4"},
                   options);
    SCOPED_TRACE(fmt::format("{} kB: {}", limit_kb, result.standard_error));
    EXPECT_EQ(result.signal, 0);
    if (result.exit_code == 0) {
      fs::remove(Out("b.mp4"));
      continue;
    }
    ++failed;
    EXPECT_THAT(result.standard_error,
                testing::AnyOf(HasSubstr("gauntlet"), HasSubstr("Sanitizer")));
    EXPECT_EQ(Leftovers(), before);
  }
  EXPECT_GT(failed, 0);
}
#endif

TEST_F(CliTest, AGloveWithoutTheChannelOfTheVideoTakesAnother) {
  const std::string scenario = WriteScenario(kGood);
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command = {"run", scenario, "--out",
                                        "a",   "--set",  "glove.channels=[thumb_ip,elbow_flexion]"};
    command.insert(command.end(), more.begin(), more.end());
    return Gauntlet(command);
  };
  EXPECT_EQ(run({}).exit_code, 0);
  EXPECT_THAT(ReadFile(Out("a") / "scenario.resolved.yaml"), HasSubstr("channel: \"thumb_ip\""));
  const ProgramResult named = run({"--set", "video.channel=index_mcp"});
  EXPECT_EQ(named.exit_code, 0);
  EXPECT_THAT(named.standard_error, HasSubstr("video.channel: index_mcp is not measured by the "
                                              "glove; thumb_ip is shown in its place"));
  EXPECT_THAT(ReadFile(Out("a") / "scenario.resolved.yaml"), HasSubstr("channel: \"thumb_ip\""));
  const ProgramResult unknown = run({"--set", "video.channel=nose"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(
      unknown.standard_error,
      HasSubstr("--set video.channel=nose: video.channel: nose is not a joint of the hand"));
}

TEST_F(CliTest, WhatNoVideoCanShowIsRefusedBeforeAnyTrial) {
  std::string many = "question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\ncontrollers:\n";
  for (char name = 'a'; name <= 'i'; ++name) many += fmt::format("  {}: {{}}\n", name);
  const std::string scenario = WriteScenario(many);
  const auto refuse = [&](std::vector<std::string> more, const char* why) {
    for (const char* command : {"run", "compare"}) {
      std::vector<std::string> arguments = {command, scenario, "--out", "a", "--video"};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const ProgramResult result = Gauntlet(arguments);
      EXPECT_EQ(result.exit_code, 2) << why;
      EXPECT_THAT(result.standard_error, HasSubstr(why));
      EXPECT_THAT(Leftovers(), testing::IsEmpty()) << why;
    }
  };
  refuse({}, "video: 9 controllers, must be from 1 to 8: choose some with --controllers");
  refuse({"--set", "video.width_px=320"}, "video.width_px: is 320, must be from 480 to 3840");
  refuse({"--set", "video.height_px=240"}, "video.height_px: is 240, must be from 270 to 2160");
  refuse({"--set", "video.width_px=481"}, "--set video.width_px=481: video.width_px: is 481");
  refuse(
      {"--set", "video.camera=hnd"},
      "--set video.camera=hnd: video.camera: hnd is not a camera of the hand (did you mean hand?)");

  ASSERT_EQ(Gauntlet({"run", scenario, "--out", "a"}).exit_code, 0);
  EXPECT_THAT(Gauntlet({"render", "a"}).standard_error, HasSubstr("video: 9 controllers"));
  fs::create_directory(Out("b.mp4"));
  const ProgramResult onto_folder =
      Gauntlet({"render", "a", "--controllers", "a", "--out", "b.mp4"});
  EXPECT_EQ(onto_folder.exit_code, 2);
  EXPECT_THAT(onto_folder.standard_error, HasSubstr("b.mp4: is a folder, must be a file"));
  fs::remove(Out("b.mp4"));
  std::string resolved = ReadFile(Out("a") / "scenario.resolved.yaml");
  resolved.replace(resolved.find("\"hand\""), 6, "\"hnd\"");
  std::ofstream(Out("a") / "scenario.resolved.yaml") << resolved;
  fs::remove(Out("a") / "manifest.json");  // which tells that the file was changed
  const ProgramResult camera = Gauntlet({"render", "a", "--controllers", "a"});
  EXPECT_EQ(camera.exit_code, 2);
  EXPECT_THAT(camera.standard_error,
              HasSubstr("a/scenario.resolved.yaml: video.camera: hnd is not a camera"));
  EXPECT_FALSE(fs::exists(Out("a") / "comparison.mp4"));
}

TEST_F(CliTest, WhatAnotherScenarioLeftInTheFolderGoesAway) {
  const auto run = [&](const std::string& seed) {
    return ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "a", "--seed", seed,
                     "--controllers", "raw"});
  };
  const auto leave = [&] {
    for (const char* name : {"comparison.mp4", "trace.raw.csv", "raw.robot.yaml", "notes.txt"}) {
      std::ofstream(Out("a") / name) << "old";
    }
  };
  ASSERT_EQ(run("1").exit_code, 0);
  leave();
  ASSERT_EQ(run("1").exit_code, 0);  // the same again: what is there still belongs to it
  EXPECT_TRUE(fs::exists(Out("a") / "comparison.mp4"));
  ASSERT_EQ(run("2").exit_code, 0);
  EXPECT_FALSE(fs::exists(Out("a") / "comparison.mp4"));
  EXPECT_FALSE(fs::exists(Out("a") / "trace.raw.csv"));
  EXPECT_FALSE(fs::exists(Out("a") / "raw.robot.yaml"));
  EXPECT_TRUE(fs::exists(Out("a") / "notes.txt"));
}

TEST_F(CliTest, ARunDoesNotTakeThePlaceOfAComparisonUnasked) {
  const std::string scenario = WriteScenario(kGood);
  ASSERT_EQ(Gauntlet({"compare", scenario, "--seeds", "2"}).exit_code, 0);
  const std::string scores = ReadFile(Out("out/scenario") / "scores.json");
  const ProgramResult elsewhere = Gauntlet({"run", scenario});
  EXPECT_EQ(elsewhere.exit_code, 0);
  EXPECT_THAT(elsewhere.standard_error,
              HasSubstr("out/scenario holds a comparison, which stays: this run goes to "
                        "out/scenario_run\n"));
  EXPECT_EQ(ReadFile(Out("out/scenario") / "scores.json"), scores);
  EXPECT_TRUE(fs::exists(Out("out/scenario_run") / "scores.json"));

  const ProgramResult told = Gauntlet({"run", scenario, "--out", "out/scenario"});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_THAT(told.standard_error, HasSubstr("this run takes the place of its scores"));
  EXPECT_NE(ReadFile(Out("out/scenario") / "scores.json"), scores);
  EXPECT_THAT(Gauntlet({"run", scenario}).standard_error, Not(HasSubstr("comparison")));
}

TEST_F(CliTest, EveryListPrints) {
  for (const char* list : {"filters", "predictions", "motions", "faults", "servos", "metrics",
                           "channels", "scenarios", "keys"}) {
    const ProgramResult result = Gauntlet({"list", list});
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_GT(result.standard_output.size(), 100u) << list;
  }
  EXPECT_THAT(Gauntlet({"list", "filters"}).standard_output, HasSubstr("moving_average"));
  EXPECT_EQ(Gauntlet({"list", "filtres"}).exit_code, 2);
  EXPECT_THAT(Gauntlet({"list", "metrics"}).standard_output,
              StartsWith("tracking_rmse_deg\n"
                         "    how far the hand is from the wearer, RMS\n"
                         "    = sqrt(mean((hand - reference)^2))\n"
                         "    differences matter from 0.5 on: "));
}

TEST_F(CliTest, FilterIsALineByLineStream) {
  const ProgramResult result = Filter({"moving_average", "--set", "window=2"},
                                      "t_s,a,b\r\n0,1,10\r\n0.001,2,20\n0.002,,nan\n0.003,4,0.1\n");
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_output, "t_s,a,b\n0,1,10\n0.001,1.5,15\n0.002,2,20\n0.003,3,10.05\n");
  EXPECT_THAT(result.standard_error, HasSubstr("2 missing values"));
}

TEST_F(CliTest, FilterStartsAChannelAtItsFirstGoodValue) {
  const ProgramResult result = Filter({"exponential", "--set", "alpha=0.5"}, "a,b\n,8\n4,4\n2,4\n");
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_output, "a,b\nnan,8\n4,6\n3,5\n");
}

TEST_F(CliTest, FilterKeepsTimeNamesAndDigits) {
  // Time as it stands, any names, numbers that read back to the same bits.
  const std::string rows = "k,left thumb,b\n007,0.1,1e-300\n8.50,-0.30000000000000004,5\n";
  EXPECT_EQ(Filter({"none"}, rows).standard_output,
            "k,left thumb,b\n007,0.1,1e-300\n"
            "8.50,-0.30000000000000004,5\n");
  EXPECT_EQ(Filter({"none"}, "x\n1\n").standard_output, "x\n1\n");
}

TEST_F(CliTest, FilterTakesKForTheNumberOfASampleInTheFirstColumnOnly) {
  EXPECT_EQ(
      Filter({"moving_average", "--set", "window=2"}, "i,j,k\n1,1,1\n3,3,3\n").standard_output,
      "i,j,k\n1,1,1\n2,2,2\n");
}

TEST_F(CliTest, FilterGivesFiniteNumbersForFiniteNumbers) {
  for (const char* kind : {"moving_average", "one_euro", "exponential", "kalman_steady"}) {
    std::vector<std::string> arguments = {kind, "--set", "rate_hz=1000"};
    if (kind == std::string("kalman_steady")) {
      arguments.insert(arguments.end(), {"--set", "r=1e-20", "--set", "q=1e20"});
    }
    const ProgramResult result =
        Filter(arguments, "a\n1.7e308\n1e100\n-1e100\n-1.7e308\n0\n0\n5\n");
    EXPECT_EQ(result.exit_code, 0) << kind;
    EXPECT_THAT(result.standard_error, HasSubstr("2 missing values")) << kind;
    const std::string after_the_first = result.standard_output.substr(6);
    EXPECT_THAT(after_the_first, testing::Not(HasSubstr("nan"))) << kind;
    EXPECT_THAT(after_the_first, testing::Not(HasSubstr("inf"))) << kind;
  }
}

TEST_F(CliTest, FilterRefusesSettingsThatMeanSomethingElse) {
  const auto refuse = [](const std::string& setting, const std::string& why) {
    const ProgramResult result = Filter({"kalman", "--set", setting}, "a\n1\n");
    EXPECT_EQ(result.exit_code, 2) << setting;
    EXPECT_THAT(result.standard_error, HasSubstr(why));
    EXPECT_EQ(result.standard_output, "");
  };
  refuse("kind=median", "the kind is an argument: gauntlet filter median");
  refuse("r=21.18,", "ends with a comma");
  refuse("r=1e-300", "r: is 1e-300, must be");
}

TEST_F(CliTest, FilterEndsAtTheFirstSignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string source = "source_" + std::to_string(signal);
    ProgramOptions options;
    options.working_directory = folder_.path();
    Program program({"/bin/sh", "-c",
                     "mkfifo " + source + "; (echo a; echo 1; sleep 60) > " + source +
                         " 2> /dev/null & exec " + kProgram + " filter none < " + source},
                    options);
    ASSERT_TRUE(program.WaitForText("a\n1\n"));
    program.SendSignal(signal);
    EXPECT_EQ(program.Wait().exit_code, 128 + signal);
    EXPECT_EQ(program.Wait().standard_error,
              "gauntlet: interrupted; nothing half-written was left\n");
  }
}

TEST_F(CliTest, FilterTakesOneValueForAllChannelsOrOneForEach) {
  const std::string rows = "k,a,b\n0,0,0\n1,1,1\n2,0,0\n";
  const auto filter = [&](const std::string& r) { return Filter({"kalman", "--set", r}, rows); };
  EXPECT_EQ(filter("r=4,4").standard_output, filter("r=4").standard_output);
  EXPECT_NE(filter("r=4,5").standard_output, filter("r=4").standard_output);
  EXPECT_EQ(filter("r=4,5,6").exit_code, 2);
  EXPECT_EQ(filter("r=-1").exit_code, 2);
}

TEST_F(CliTest, FilterNamesTheRowAndColumnOfAMistake) {
  const auto filter = [&](const std::string& input) { return Filter({"none"}, input); };
  EXPECT_THAT(filter("k,a\n0,x\n").standard_error, HasSubstr("standard input:2:2: is \"x\""));
  EXPECT_THAT(filter("k,a\n0\n").standard_error, HasSubstr("standard input:2: has 1 fields"));
  EXPECT_EQ(filter("").exit_code, 2);
  EXPECT_EQ(Filter({"kalmann"}, "").exit_code, 2);
}

TEST_F(CliTest, FilterWarnsOfAHeaderOfNumbers) {
  const ProgramResult result = Filter({"none"}, "0,1\n3,4\n");
  EXPECT_EQ(result.exit_code, 0);  // data frames name their columns so
  EXPECT_EQ(result.standard_output, "0,1\n3,4\n");
  EXPECT_THAT(result.standard_error, HasSubstr("standard input:1: numbers only"));
}

TEST_F(CliTest, FilterAnswersALiveSourceBeforeItEnds) {
  const ProgramResult result =
      RunProgram({"/bin/sh", "-c",
                  "(printf 'a\\n1\\n'; sleep 2) | timeout 1 " + kProgram + " filter none; true"});
  EXPECT_EQ(result.standard_output, "a\n1\n");
}

TEST_F(CliTest, CalibrateTakesATraceOfKnownPosesAndAScenarioIncludesTheResult) {
  ASSERT_EQ(
      Gauntlet({"run", kScenarios + "known_poses.yaml", "--csv", "--controllers", "raw"}).exit_code,
      0);
  const ProgramResult result =
      Gauntlet({"calibrate", "out/known_poses/trace.raw.csv", "--confidence", "99.99"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output,
              AllOf(HasSubstr("two_point"), HasSubstr("99.99 % interval"), HasSubstr("index_mcp")));
  EXPECT_THAT(result.standard_error, HasSubstr("wrote out/trace.raw.calibration.yaml"));

  const ProgramResult json =
      Gauntlet({"calibrate", "out/known_poses/trace.raw.csv", "--out", "glove.yaml", "--json",
                "--confidence", "99.99", "--linearisation", "two_point"});
  ASSERT_EQ(json.exit_code, 0) << json.standard_error;
  const double paper[] = {21.18, 12.52, 10.62, 9.86, 26.94, 10.08, 9.71,  17.58, 6.05,
                          9.91,  47.19, 11.04, 7.56, 23.94, 26.82, 28.82, 27.69, 31.49};
  const auto channels = nlohmann::json::parse(json.standard_output)["channels"];
  ASSERT_EQ(channels.size(), 18u);
  for (std::size_t i = 0; i < 18; ++i) {
    EXPECT_LE(channels[i]["variance_low_counts2"], paper[i]) << i;
    EXPECT_GE(channels[i]["variance_high_counts2"], paper[i]) << i;
    EXPECT_LT(channels[i]["table_rms_deg"], 1.5) << i;
  }

  const auto tracking = [&](const std::vector<std::string>& overrides) {
    std::vector<std::string> arguments = {"run",
                                          kScenarios + "calibrated_glove.yaml",
                                          "--json",
                                          "--controllers",
                                          "not_calibrated",
                                          "--out",
                                          "b"};
    arguments.insert(arguments.end(), overrides.begin(), overrides.end());
    const ProgramResult run = Gauntlet(arguments);
    EXPECT_EQ(run.exit_code, 0) << run.standard_error;
    return nlohmann::json::parse(
               run.standard_output)["controllers"][0]["summary"]["tracking_rmse_deg"]
        .get<double>();
  };
  EXPECT_LT(tracking({"--set", "controllers.not_calibrated.calibration=glove.yaml"}),
            0.6 * tracking({}));
}

TEST_F(CliTest, CalibrateFitsAPredictorWithComponentsThatAScenarioIncludes) {
  const std::string motion = "glove.motion.duration_s=12";
  ASSERT_EQ(Gauntlet({"run", kScenarios + "random_motion.yaml", "--csv", "--controllers", "raw",
                      "--set", motion, "score.noise_free_twin=false"})
                .exit_code,
            0);
  const auto fit = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"calibrate", "out/random_motion/trace.raw.csv", "--predictor",
                               "--order", "10", "--tap-ms", "10", "--out", "ahead.yaml"});
    return Gauntlet(more);
  };
  EXPECT_THAT(fit({}).standard_output, HasSubstr("counts RMS"));
  const ProgramResult refused = fit({"--components", "2"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.standard_error,
              HasSubstr("--components 2: are sums of angles, must have a --calibration FILE.yaml"));
  const std::string curves = kScenarios + "calibrations/glove_of_seed_1.yaml";
  const ProgramResult fitted = fit({"--components", "2", "--calibration", curves});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.standard_error;
  EXPECT_THAT(fitted.standard_output,
              AllOf(HasSubstr("deg RMS"), HasSubstr("index_mcp"), HasSubstr("left by other fits")));
  std::ofstream(folder_.path() / "scenario.yaml")
      << "question: q\nglove: {motion: {kind: random, duration_s: 2}}\n"
         "controllers:\n  raw: {}\n  ahead: !include ahead.yaml\n";
  const ProgramResult run = Gauntlet({"run", "scenario.yaml", "--json", "--out", "b"});
  ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  const auto controllers = nlohmann::json::parse(run.standard_output)["controllers"];
  const auto delay_ms = [&](int i) { return controllers[i]["summary"]["delay_ms"].get<double>(); };
  EXPECT_LT(delay_ms(1), delay_ms(0) - 30.0);
}

TEST_F(CliTest, CalibrateRefusesBadInputInOneLineAndWritesNothing) {
  const auto refuse = [&](const std::string& csv, std::vector<std::string> more,
                          const std::string& message) {
    std::ofstream(folder_.path() / "scenario.yaml") << csv;  // a name that Leftovers() expects
    more.insert(more.begin(), {"calibrate", "scenario.yaml"});
    const ProgramResult result = Gauntlet(more);
    EXPECT_EQ(result.exit_code, 2) << csv;
    EXPECT_THAT(result.standard_error, HasSubstr(message));
    EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1)
        << result.standard_error;
    EXPECT_EQ(result.standard_output, "");
    EXPECT_THAT(Leftovers(), testing::IsEmpty());
  };
  std::string ramp = "t_s,index_mcp_counts,index_mcp_deg\n";
  for (int k = 0; k < 3000; ++k) ramp += fmt::format("{},{},{}\n", k * 1e-3, k / 3, 0.03 * k);
  refuse("", {}, "holds no data");
  refuse("t_s,index_mcp_counts,index_mcp_deg\n0,1,x\n", {},
         "scenario.yaml:2:3: 'x' is not a number");
  refuse("t_s,index_mcp_count\n0,1\n", {}, "scenario.yaml:1:2: unknown column 'index_mcp_count'");
  refuse(ramp, {}, "scenario.yaml: index_mcp: has 0 poses");
  refuse(ramp, {"--out", "scenario.yaml", "--settle-ms", "0"}, "is an input of this command");
  refuse(ramp, {"--linearisation", "spline"}, "spline");
  refuse(ramp, {"--degree", "0"}, "--degree");
  refuse(ramp, {"--full-scale", "500"}, "must be from 0 to the converter's full scale of 500");
  EXPECT_EQ(Gauntlet({"calibrate", "nowhere.csv"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"calibrate"}).exit_code, 2);
}

TEST_F(CliTest, CalibrateTakesAnyGloveAndSaysWhatItLeftOut) {
  std::string csv = "time_ms,my sensor_counts,indx_mcp_counts\n";
  for (int k = 0; k < 2000; ++k) {
    const int noise = k % 4 < 2 ? 3 : -3;  // variance 9
    csv += fmt::format("{},{},{}\n", k, 500 + noise + (k % 100 == 50 ? 124 : 0),
                       k == 1000 ? 70'000 : 300);
  }
  std::ofstream(folder_.path() / "poses.csv") << csv;
  const ProgramResult result = Gauntlet({"calibrate", "poses.csv", "--out", "glove.yaml"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.standard_output, AllOf(HasSubstr("my sensor"), HasSubstr("20 spikes left out"),
                                            HasSubstr("rounding hides it")));
  EXPECT_THAT(result.standard_error,
              AllOf(HasSubstr("1 rows with a count below 0 or above 1023 left out"),
                    HasSubstr("indx_mcp is not a channel of the simulated glove (did you mean "
                              "index_mcp?)"),
                    HasSubstr("indx_mcp: rounding hides the noise, R is at most 0.")));
}

TEST_F(CliTest, IdentifyFindsADelayThatWasAddedToTheLink) {
  const auto delay_ms = [&](const std::string& link_ms, const std::vector<std::string>& more) {
    const ProgramResult run = Gauntlet({"run", kScenarios + "probe_chain.yaml", "--out", "b",
                                        "--set", "score.noise_free_twin=false",
                                        "glove.motion.duration_s=6", "event.delay_ms=" + link_ms});
    EXPECT_EQ(run.exit_code, 0) << run.standard_error;
    std::vector<std::string> identify = {"identify", "b", "--json", "--out", "chain.yaml"};
    identify.insert(identify.end(), more.begin(), more.end());
    const ProgramResult result = Gauntlet(identify);
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_THAT(result.standard_error, testing::EndsWith("and chain.html\n"));
    const auto json = nlohmann::json::parse(result.standard_output);
    EXPECT_EQ(json["parts"].size(), 18u);
    const auto& index_mcp = json["parts"][4];
    EXPECT_EQ(index_mcp["part"], "index_mcp");
    EXPECT_LT(index_mcp["residual_rms_deg"], index_mcp["shifted_rms_deg"]);
    return index_mcp["delay_ms"]["value"].get<double>();
  };
  const double before = delay_ms("25", {});
  EXPECT_NEAR(delay_ms("65", {}) - before, 40.0, 4.0);
  // From the targets on there is no glove, no wait for the next frame.
  EXPECT_LT(delay_ms("25", {"--from", "target"}), before);
  EXPECT_THAT(ReadFile(folder_.path() / "chain.yaml"),
              AllOf(HasSubstr("horizon_ms: ["), HasSubstr("friction_deg: ["),
                    HasSubstr("part: \"little_pip\"")));
}

/// The numbers behind `horizon_ms: [` of a file.
std::vector<double> HorizonsIn(const std::string& text) {
  const std::string key = "horizon_ms: [";
  std::istringstream numbers(text.substr(text.find(key) + key.size()));
  std::vector<double> horizons;
  char separator = ',';
  for (double value = 0.0; separator == ',' && numbers >> value >> separator;) {
    horizons.push_back(value);
  }
  return horizons;
}

TEST_F(CliTest, ReadyScenariosLookAsFarAheadAsIdentifyFindsTheHandToBeLate) {
  Gauntlet({"run", kScenarios + "probe_chain.yaml", "--out", "b", "--set",
            "score.noise_free_twin=false"});
  const ProgramResult table = Gauntlet({"identify", "b", "--out", "chain.yaml"});
  ASSERT_EQ(table.exit_code, 0) << table.standard_error;
  EXPECT_THAT(table.standard_output, AllOf(HasSubstr("hysteresis"), HasSubstr("index_mcp")));
  EXPECT_LE(WidestLine(table.standard_output), 80u);
  const std::vector<double> identified = HorizonsIn(ReadFile(folder_.path() / "chain.yaml"));
  ASSERT_EQ(identified.size(), 18u);
  for (const char* name : {"random_motion", "fast_bursts", "door_opening", "paper_claims"}) {
    EXPECT_THAT(HorizonsIn(ReadFile(kScenarios + name + ".yaml")),
                testing::Pointwise(testing::DoubleNear(1.0), identified))
        << name;
  }
}

TEST_F(CliTest, IdentifyRefusesBadInputInOneLineAndWritesNothing) {
  const auto refuse = [&](const std::string& csv, std::vector<std::string> more,
                          const std::string& message) {
    std::ofstream(folder_.path() / "scenario.yaml") << csv;  // a name that Leftovers() expects
    more.insert(more.begin(), {"identify", "scenario.yaml"});
    const ProgramResult result = Gauntlet(more);
    EXPECT_EQ(result.exit_code, 2) << csv;
    EXPECT_THAT(result.standard_error, HasSubstr(message));
    EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1)
        << result.standard_error;
    EXPECT_EQ(result.standard_output, "");
    EXPECT_THAT(Leftovers(), testing::IsEmpty());
  };
  std::string still = "t_s,index_mcp_command_deg,index_mcp_deg\n";
  for (int k = 0; k < 1000; ++k) still += fmt::format("{},10,20\n", k * 1e-2);
  refuse(still, {}, "scenario.yaml: index_mcp: its command does not move");
  const std::string short_log = still.substr(0, still.find("\n3,") + 1);
  refuse(short_log, {}, "index_mcp: is 3 s long, must be at least 5 s");
  refuse(still, {"--out", "scenario.yaml"}, "is an input of this command");
  refuse(still, {"--controller", "raw"}, "a CSV has but one");
  refuse(still, {"--from", "motor"}, "motor");
  refuse("t_s,index_mcp_deg\n0,1\n", {}, "scenario.yaml:1:1: there is no part with a command");
  EXPECT_EQ(Gauntlet({"identify", "nowhere"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"identify", "nowhere.h5"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"identify"}).exit_code, 2);
}

TEST_F(CliTest, HelpHasAnExample) {
  for (const char* command :
       {"run", "compare", "render", "list", "filter", "calibrate", "identify", "inspect"}) {
    const ProgramResult result = Gauntlet({command, "--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.standard_output, HasSubstr("Example")) << command;
  }
}

TEST_F(CliTest, HelpNamesTheProgramAsItWasCalled) {
  fs::create_symlink(kProgram, folder_.path() / "gauntlet");
  const auto call = [&](std::vector<std::string> command) {
    ProgramOptions options;
    options.working_directory = folder_.path();
    const ProgramResult result = RunProgram(command, options);
    return result.standard_output + result.standard_error;
  };
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--help"}, {"run", "--help"}, {"sweep", "--help"}, {"rnu"}, {}}) {
    std::vector<std::string> command = {"./gauntlet"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const std::string here = call(command);
    command.front() = kProgram;
    std::string anywhere = call(command);
    EXPECT_THAT(here, HasSubstr(" ./gauntlet "));
    EXPECT_THAT(anywhere, Not(HasSubstr("./gauntlet")));
    EXPECT_THAT(here, Not(testing::ContainsRegex("[ (]gauntlet [a-z]"))) << here;
  }
  EXPECT_EQ(call({"./gauntlet", "--version"}), call({kProgram, "--version"}));
}

TEST_F(CliTest, WordsThatMeanAnOptionDoAsItDoes) {
  EXPECT_EQ(Gauntlet({"version"}).standard_output, Gauntlet({"--version"}).standard_output);
  EXPECT_EQ(Gauntlet({"help"}).standard_output, Gauntlet({"--help"}).standard_output);
  EXPECT_EQ(Gauntlet({"help", "run"}).standard_output, Gauntlet({"run", "--help"}).standard_output);
}

TEST_F(CliTest, WhatIsNotUnderstoodIsExplained) {
  const std::string scenario = kScenarios + "hold_still.yaml";
  const auto explained = [&](const std::vector<std::string>& arguments) {
    const ProgramResult result = Gauntlet(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.standard_output, "");
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1);
    return result.standard_error;
  };
  EXPECT_EQ(explained({"comapre", "a.yaml"}),
            "gauntlet: comapre: no such command (did you mean compare?); see gauntlet --help\n");
  EXPECT_THAT(explained({"xyz"}), HasSubstr("xyz: no such command (one of: run, compare"));
  EXPECT_THAT(explained({}), HasSubstr("a command is missing (one of: run, compare"));
  EXPECT_THAT(explained({"--sed"}), HasSubstr("--sed: gauntlet has no such option"));
  EXPECT_EQ(explained({"compare", scenario, "--seds", "3"}),
            "gauntlet: --seds: compare has no such option (did you mean --seeds?); see gauntlet "
            "compare --help\n");
  EXPECT_THAT(explained({"run", scenario, "--sed", "3"}),
              HasSubstr("--sed: run has no such option (did you mean --seed?)"));
  EXPECT_THAT(explained({"run", scenario, "--seeds=2"}),
              HasSubstr("--seeds: run has no such option; compare has; see gauntlet run --help"));
  EXPECT_THAT(explained({"run", scenario, "--seed", "abc"}),
              HasSubstr("--seed: is 'abc', must be a whole number from 0 to 2147483647; see"));
  EXPECT_THAT(explained({"compare", scenario, "--jobs", "0"}),
              HasSubstr("--jobs: is '0', must be a whole number from 1 to 1024"));
  EXPECT_THAT(explained({"render", "a", "--frame", "x"}),
              HasSubstr("--frame: is 'x', must be a number from 0 to 1000000"));
  EXPECT_THAT(explained({"diff", "a", "b", "--json=x"}),
              HasSubstr("--json: is 'x', must be true or false"));
  EXPECT_THAT(explained({"run", scenario, "more"}), HasSubstr("more: more than run takes"));
  EXPECT_THAT(explained({"run"}), HasSubstr("scenario is required; see gauntlet run --help"));
  EXPECT_THAT(explained({"run", "hold_stil"}),
              HasSubstr("hold_stil: no such file or scenario (did you mean hold_still?)"));
  EXPECT_THAT(explained({"run", "hold_still.yaml"}), HasSubstr("hold_still.yaml: no such file"));
}

TEST_F(CliTest, AReadyScenarioIsFoundByItsName) {
  EXPECT_EQ(ShortRun({"run", "hold_still", "--out", "a", "--controllers", "raw"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(Out("a") / "scores.json"));
}

struct BadScenario {
  std::string name;
  std::string text;
  std::string message;
};

/// What CTest shows of a case: its name, not the bytes of the struct.
void PrintTo(const BadScenario& scenario, std::ostream* out) { *out << scenario.name; }

class BadScenarioTest : public CliTest, public testing::WithParamInterface<BadScenario> {};

TEST_P(BadScenarioTest, IsOneClearLineAndLeavesNothing) {
  const ProgramResult result = Gauntlet({"run", WriteScenario(GetParam().text), "--out", "a/b"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error, HasSubstr(GetParam().message));
  EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1)
      << result.standard_error;
  EXPECT_EQ(result.standard_output, "");
  EXPECT_THAT(Leftovers(), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    All, BadScenarioTest,
    testing::Values(
        BadScenario{"UnknownKey", kGood + "sede: 3\n",
                    "scenario.yaml:4:1: sede: unknown key (did you mean seed?)"},
        BadScenario{"DuplicateKey", kGood + "seed: 1\nseed: 2\n",
                    "scenario.yaml:5:1: seed: is given twice"},
        BadScenario{"MissingKey", "controllers: {raw: {}}\n", "question: is missing"},
        BadScenario{"NotFinite", kGood + "event: {delay_ms: .inf}\n",
                    "scenario.yaml:4:19: event.delay_ms"},
        BadScenario{"WrongType", kGood + "event: {delay_ms: soon}\n", "must be a number"},
        BadScenario{"NoControllers", "question: q\ncontrollers: {}\n", "controllers: is empty"},
        BadScenario{"ControllersMissing", "question: q\n", "controllers: is missing"},
        BadScenario{"UnknownFilter", "question: q\ncontrollers: {a: {filter: kalmann}}\n",
                    "controllers.a.filter"},
        BadScenario{"WrongChannel", kGood + "video: {channel: index_mpc}\n",
                    "did you mean index_mcp?"},
        BadScenario{"NegativeStiffness", kGood + "hand: {cable: {stiffness_scale: -1}}\n",
                    "scenario.yaml:4:33: hand.cable.stiffness_scale: is -1"},
        BadScenario{"NoDiameter", kGood + "hand: {object: {diameter_mm: 0}}\n",
                    "scenario.yaml:4:30: hand.object.diameter_mm: is 0"},
        BadScenario{"TooLittleTravel", kGood + "hand: {servo: {travel_deg: 200}}\n",
                    "scenario.yaml:4:28: hand.servo.travel_deg: 200 is too little"},
        BadScenario{"UnknownJoint",
                    "question: q\nglove: {channels: [index_mpc]}\ncontrollers: {raw: {}}\n",
                    "scenario.yaml:2:19: glove.channels: unknown channel 'index_mpc' (did you mean "
                    "index_mcp?)"},
        BadScenario{"UnknownChannelOfAFault",
                    "question: q\nglove: {faults: [spikes, {kind: stuck, channels: [index_mpc]}]}\n"
                    "controllers: {raw: {}}\n",
                    "scenario.yaml:2:50: glove.faults[1].channels: unknown channel"},
        BadScenario{"FewFrequencies",
                    "question: q\nglove: {motion: {kind: sine, frequency_hz: [1, 2]}}\n"
                    "controllers: {raw: {}}\n",
                    "scenario.yaml:2:44: glove.motion.frequency_hz: has 2 values"},
        BadScenario{"UnknownPosture",
                    "question: q\nglove: {motion: {kind: sequence, parts: [{kind: moves, postures: "
                    "[opn]}]}}\ncontrollers: {raw: {}}\n",
                    "scenario.yaml:2:66: glove.motion.parts[0].postures: "},
        BadScenario{"LongerThanAnHour",
                    "question: q\nglove: {motion: {kind: grasp, repeats: 1000, rest_s: 60}}\n"
                    "controllers: {raw: {}}\n",
                    "s, must be at most 3600"},
        BadScenario{"MissingRecording",
                    "question: q\nglove: {motion: {kind: recording, file: no.csv}}\ncontrollers: "
                    "{raw: {}}\n",
                    "no.csv"}),
    [](const auto& test) { return test.param.name; });

class BadRecordingTest : public CliTest, public testing::WithParamInterface<BadScenario> {};

TEST_P(BadRecordingTest, IsOneClearLineWithRowAndColumn) {
  WriteScenario(
      "question: q\nglove: {motion: {kind: recording, file: bad.csv}}\ncontrollers: {raw: {}}\n");
  std::ofstream(folder_.path() / "bad.csv") << GetParam().text;
  const ProgramResult result = Gauntlet({"run", "scenario.yaml", "--out", "a"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.standard_error, HasSubstr(GetParam().message));
  EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1)
      << result.standard_error;
  EXPECT_FALSE(fs::exists(Out("a")));
}

std::string ThreeRows(const std::string& last) {
  std::string text = ReadFile(kScenarios + "recordings/door_opening/angles.csv");
  std::size_t end = 0;
  for (int line = 0; line < 3; ++line) end = text.find('\n', end) + 1;
  return text.substr(0, end) + last;
}

INSTANTIATE_TEST_SUITE_P(
    All, BadRecordingTest,
    testing::Values(BadScenario{"Empty", "", "bad.csv"},
                    BadScenario{"TextInANumber", ThreeRows("0.02,abc\n"), "bad.csv:4"},
                    BadScenario{"HalfARow", ThreeRows("0.02,1.5"), "bad.csv:4"}),
    [](const auto& test) { return test.param.name; });

TEST_F(CliTest, TellsWhatWasRepairedInARecording) {
  WriteScenario(
      "question: q\nglove: {motion: {kind: recording, file: in.csv, problems: repair}}\n"
      "controllers: {raw: {}}\n");
  std::ofstream recording(folder_.path() / "in.csv");
  recording << "time_s,index_mcp\n";
  for (int i = 0; i < 50; ++i) recording << 0.02 * i << ',' << (i == 20 ? "?" : "10") << '\n';
  recording.close();
  const ProgramResult result = Gauntlet({"run", "scenario.yaml", "--out", "a"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.standard_error, HasSubstr("in.csv: not a number: 1 times, first in row 22"));
}

TEST_F(CliTest, MistakesOnTheCommandLineExitWithTwo) {
  EXPECT_EQ(Gauntlet({}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"rnu"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"run"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"run", "nowhere.yaml"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"compare", kScenarios + "hold_still.yaml", "--seeds", "0"}).exit_code, 2);
  EXPECT_EQ(ShortRun({"run", kScenarios + "hold_still.yaml", "--controllers", "rav"}).exit_code, 2);
  EXPECT_THAT(Leftovers(), testing::IsEmpty());
}

TEST_F(CliTest, AnUnwritablePlaceIsFoundBeforeTheWork) {
  std::ofstream(folder_.path() / "file") << "x";
  const ProgramResult result = ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "file/a"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_error, HasSubstr("file/a"));
  EXPECT_EQ(std::count(result.standard_error.begin(), result.standard_error.end(), '\n'), 1);
  const ProgramResult file = ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "file"});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.standard_error, HasSubstr("--out file: is a file, must be a folder"));
  EXPECT_EQ(ReadFile(Out("file")), "x");
}

TEST_F(CliTest, TwoProgramsDoNotWriteIntoOneFolder) {
  ProgramOptions options;
  options.working_directory = folder_.path();
  Program first({kProgram, "run", kScenarios + "paper.yaml", "--out", "a"}, options);
  ASSERT_TRUE(first.WaitForPath(Out("a")));
  const ProgramResult second = ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "a"});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.standard_error, HasSubstr("a: another gauntlet writes into this folder"));
  first.SendSignal(SIGINT);
  EXPECT_EQ(first.Wait().exit_code, 130);
  EXPECT_EQ(ShortRun({"run", kScenarios + "hold_still.yaml", "--out", "a"}).exit_code, 0);
}

TEST_F(CliTest, AFullStandardOutputIsAFailure) {
  const ProgramResult result =
      RunProgram({"/bin/sh", "-c", kProgram + " list metrics > /dev/full"});
  EXPECT_EQ(result.exit_code, 1);
}

TEST_F(CliTest, CtrlCLeavesNothingBehind) {
  ProgramOptions options;
  options.working_directory = folder_.path();
  Program program({kProgram, "run", kScenarios + "paper.yaml", "--out", "a/b"}, options);
  ASSERT_TRUE(program.WaitForPath(Out("a/b")));
  program.SendSignal(SIGINT);
  EXPECT_EQ(program.Wait().exit_code, 130);
  EXPECT_THAT(Leftovers(), testing::IsEmpty());
}

}  // namespace
}  // namespace gauntlet::test
