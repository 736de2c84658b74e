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

#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"
#include "tests/support/source_dir.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string kProgram = GAUNTLET_PROGRAM;
const std::string kScenarios = SourceDir() + "/scenarios/";

// One and a half seconds of motion: enough for every stage to work, little enough for many tests.
const std::vector<std::string> kShort = {"--set", "glove.motion.duration_s=1.5"};

const std::string kGood =
    "question: q\nglove: {motion: {kind: hold, duration_s: 0.1}}\ncontrollers: {raw: {}}\n";

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
    return folder_.Run(std::move(arguments));
  }
  ProgramResult ShortRun(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), kShort.begin(), kShort.end());
    return Gauntlet(std::move(arguments));
  }
  fs::path Out(const std::string& name) const { return folder_.In(name); }
  std::string WriteScenario(const std::string& text) const {
    folder_.Write("scenario.yaml", text);
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

  WorkingFolder folder_{kProgram};
};

TEST_F(CliTest, ReproduceMeasuresThePaper) {
  GAUNTLET_LONG_TEST();
  // Its filter with another Q, whose settled answer leaves so much of the noise.
  const ProgramResult result = Gauntlet(
      {"reproduce", "--quick", "--set", "controllers.paper_kalman.filter.q=0.1", "--out", "paper"});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_output,
              AllOf(testing::StartsWith("Of 11 claims: "), HasSubstr("Much less local jumps"),
                    HasSubstr(" As set here, the"), HasSubstr("leaves 0.45 to 0.57 of the"),
                    HasSubstr("Not as in the paper: controllers.paper_kalman.filter.q=0.1\n")));
  std::istringstream lines(result.standard_output);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  const std::string page = ReadFile(Out("paper") / "reproduce.html");
  for (const char* row : {">P1</td>", ">P17</td>", "Figure 4", "Figure 7", "Figure 9", "Figure 10",
                          "Figure 12: channel 16", "Channel 18, nearer", ">47.19</td>",
                          "not as in the paper: controllers.paper_kalman.filter.q=0.1"}) {
    EXPECT_THAT(page, HasSubstr(row));
  }
  EXPECT_THAT(page, testing::Not(HasSubstr("http-equiv=\"refresh\"")));
  for (const char* name :
       {"figure_04.svg", "figure_07.svg", "figure_09.svg", "figure_10.svg",
        "figure_12_channel_01.svg", "figure_12_channel_02_near.svg", "scores.json", "trace.h5"}) {
    EXPECT_TRUE(fs::exists(Out("paper") / name)) << name;
  }
  if (RunProgram({"sh", "-c", "command -v chromium"}).exit_code != 0) return;
  // 500 px is the narrowest window of chromium; the layout of a phone begins at 768.
  const std::vector<int> overhang_px = Overhang_px(page, 500);
  EXPECT_EQ(overhang_px.size(), 6u);  // the page and its five tables
  EXPECT_THAT(overhang_px, testing::Each(testing::Le(0)));
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
                     "2 --verbose {} 2>/dev/null",
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
              HasSubstr("--color: is 'yes', must be one of auto, always, never"));
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

TEST_F(CliTest, CalibrateTakesATraceOfKnownPosesAndAScenarioIncludesTheResult) {
  GAUNTLET_LONG_TEST();
  ASSERT_EQ(
      Gauntlet({"run", kScenarios + "known_poses.yaml", "--csv", "--controllers", "raw"}).exit_code,
      0);
  const ProgramResult result = Gauntlet(
      {"calibrate", "out/known_poses/trace.raw.csv", "--confidence", "99.99", "--verbose"});
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

TEST_F(CliTest, CalibrateFitsAndJudgesAPredictorThatAScenarioIncludes) {
  GAUNTLET_LONG_TEST();
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
  const ProgramResult refused = fit({"--offset"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.standard_error, HasSubstr("--offset requires --calibration"));
  const std::string curves = kScenarios + "calibrations/glove_of_seed_1.yaml";
  const ProgramResult other =
      Gauntlet({"run", kScenarios + "random_motion.yaml", "--csv", "--controllers", "raw", "--seed",
                "2", "--out", "other", "--set", motion, "score.noise_free_twin=false"});
  ASSERT_EQ(other.exit_code, 0) << other.standard_error;
  const ProgramResult fitted = fit(
      {"--offset", "--all-channels", "--calibration", curves, "--held-out", "other/trace.raw.csv"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.standard_error;
  EXPECT_THAT(fitted.standard_output,
              AllOf(HasSubstr("deg RMS"), HasSubstr("index_mcp"), HasSubstr("left by other fits"),
                    HasSubstr("held-out"), HasSubstr("The prediction leaves "),
                    HasSubstr(" % on held-out"), HasSubstr("written to ahead.yaml")));
  std::ofstream(folder_.path() / "scenario.yaml")
      << "question: q\nglove: {motion: {kind: random, duration_s: 2}}\n"
         "controllers:\n  raw: {}\n  ahead: !include ahead.yaml\n";
  const ProgramResult run = Gauntlet({"run", "scenario.yaml", "--json", "--out", "b"});
  ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  const auto controllers = nlohmann::json::parse(run.standard_output)["controllers"];
  const auto delay_ms = [&](int i) { return controllers[i]["summary"]["delay_ms"].get<double>(); };
  EXPECT_LT(delay_ms(1), delay_ms(0) - 30.0);
}

TEST_F(CliTest, IdentifyFindsADelayThatWasAddedToTheLink) {
  GAUNTLET_LONG_TEST();
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
  EXPECT_THAT(folder_.Read("chain.yaml"),
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
  GAUNTLET_LONG_TEST();
  Gauntlet({"run", kScenarios + "probe_chain.yaml", "--out", "b", "--set",
            "score.noise_free_twin=false"});
  const ProgramResult table = Gauntlet({"identify", "b", "--out", "chain.yaml"});
  ASSERT_EQ(table.exit_code, 0) << table.standard_error;
  EXPECT_THAT(table.standard_output, AllOf(HasSubstr("hysteresis"), HasSubstr("index_mcp")));
  EXPECT_LE(WidestLine(table.standard_output), 80u);
  const std::vector<double> identified = HorizonsIn(folder_.Read("chain.yaml"));
  ASSERT_EQ(identified.size(), 18u);
  std::vector<double> shorter;  // as the scenarios say
  for (const double horizon_ms : identified) shorter.push_back(0.85 * horizon_ms);
  for (const char* name : {"random_motion", "fast_bursts", "door_opening", "paper_claims"}) {
    EXPECT_THAT(HorizonsIn(ReadFile(kScenarios + name + ".yaml")),
                testing::Pointwise(testing::DoubleNear(1.0), shorter))
        << name;
  }
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
