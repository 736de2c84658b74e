// Filters that are programs: whole commands, and programs that do what they should not.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>  // SIGINT

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "controller/controller_config.h"
#include "controller/filters/filter_registry.h"
#include "sim/trial/external/external_filters.h"
#include "tests/support/program.h"
#include "tests/support/read_file.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

/// What all programs begin with; `step` has lines of Python that make `out` of `values`, the list
/// of numbers of sample number `n`.
std::string PythonFilter(const std::string& step) {
  return R"(import json, os, random, sys, time
header = json.loads(sys.stdin.readline())
parameters = header["parameters"]
assert header["channel_count"] == len(header["channels"])
state = None
for n, line in enumerate(sys.stdin, 1):
    values = [float(word) for word in line.split(",")]
    out = values
)" + step +
         R"(
    print(",".join(map(repr, out)), flush=True)
)";
}

constexpr const char* kIdentity = "    pass";
/// As kind exponential.
constexpr const char* kExponential = R"(    state = state or values
    alpha = parameters["alpha"]
    out = state = [y + alpha * (z - y) for y, z in zip(state, values)])";

/// Waits a moment for its end. One that has ended is not running, even if its parent does not wait.
bool IsRunning(pid_t process) {
  for (int look = 0; look < 100; ++look) {
    const std::string status = ReadFile(fmt::format("/proc/{}/stat", process));
    const std::size_t name_end = status.rfind(") ");
    if (name_end == std::string::npos || status[name_end + 2] == 'Z') return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

class Programs : public testing::Test {
 protected:
  void Put(const std::string& name, const std::string& text) const {
    std::ofstream(In(name)) << text;
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  void PutScenario(const std::string& controllers, double duration_s = 0.4) const {
    Put("s.yaml", fmt::format("question: q\n"
                              "glove: {{channels: [index_mcp, middle_mcp], motion: {{kind: sine, "
                              "duration_s: {}}}}}\n"
                              "controllers:\n{}",
                              duration_s, controllers));
  }
  ProgramResult Gauntlet(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments,
                      {.working_directory = folder_.path(), .timeout = std::chrono::seconds(120)});
  }
  /// Of `run` and `compare`, the values of a controller without its name and what names it.
  nlohmann::json Scores(const std::string& folder, std::size_t controller) const {
    const auto scores = nlohmann::json::parse(ReadFile(In(folder + "/scores.json")));
    auto of = scores["controllers"][controller];
    return {{"summary", of["summary"]}, {"channels", of["channels"]}};
  }

  TemporaryDirectory folder_;
};

TEST_F(Programs, RunOnlyWithTheConsentOfTheCommandLine) {
  Put("f.py", "open('was_here', 'w')\n" + PythonFilter(kIdentity));
  PutScenario(
      "  none: {filter: none}\n"
      "  mine: {filter: {kind: external, command: python3 f.py}}\n");
  Put("sweep.yaml",
      "scenario: s.yaml\nquestion: q\nseeds: 1\nscores: [tracking_rmse_deg]\n"
      "axes: [{key: controllers.mine.filter.timeout_ms, values: [1000, 2000]}]\n");
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"run", "s.yaml"},
           {"compare", "s.yaml", "--seeds", "2"},
           {"robust", "s.yaml", "--hands", "1"},
           {"sweep", "sweep.yaml"},
           {"tune", "s.yaml", "--controller", "mine", "--free", "filter.timeout_ms=100:200"}}) {
    const ProgramResult refused = Gauntlet(command);
    EXPECT_EQ(refused.exit_code, 2) << command[0];
    EXPECT_THAT(refused.standard_error,
                HasSubstr("command: is the program python3 f.py, which runs only with "
                          "--allow-programs"))
        << command[0];
  }
  EXPECT_FALSE(fs::exists(In("was_here")));
  EXPECT_EQ(Gauntlet({"run", "s.yaml", "--allow-programs"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(In("was_here")));
  // Nor does what a run leaves behind give it.
  const std::string resolved = ReadFile(In("out/s/scenario.resolved.yaml"));
  EXPECT_THAT(resolved, HasSubstr("It repeats only with the programs of its filters"));
  EXPECT_EQ(Gauntlet({"run", "out/s/scenario.resolved.yaml", "--out", "again"}).exit_code, 2);
  EXPECT_EQ(Gauntlet({"run", "out/s/scenario.resolved.yaml", "--out", "again", "--allow-programs"})
                .exit_code,
            0);
  EXPECT_EQ(Scores("out/s", 1), Scores("again", 1));
  const ProgramResult exported = Gauntlet({"export", "out/s", "--controller", "mine"});
  EXPECT_EQ(exported.exit_code, 2);
  EXPECT_THAT(exported.standard_error, HasSubstr("is a program"));
  const ProgramResult live = Gauntlet({"live", "s.yaml", "--controller", "mine"});
  EXPECT_EQ(live.exit_code, 2);
  EXPECT_THAT(live.standard_error,
              HasSubstr("is a program or its answers (kind external), which has no place"));
}

TEST_F(Programs, ThatPassTheirInputScoreAsNoneToTheLastBit) {
  Put("f.py", PythonFilter(kIdentity));
  PutScenario(
      "  none: {filter: none}\n"
      "  mine: {filter: {kind: external, command: python3 f.py}}\n"
      "  one: {filter: {kind: external, command: python3 f.py, channels: [middle_mcp]}}\n");
  ASSERT_EQ(Gauntlet({"run", "s.yaml", "--allow-programs"}).exit_code, 0);
  EXPECT_EQ(Scores("out/s", 1), Scores("out/s", 0));
  EXPECT_EQ(Scores("out/s", 2), Scores("out/s", 0));
  ASSERT_EQ(Gauntlet({"compare", "s.yaml", "--seeds", "2", "--allow-programs", "--jobs", "2",
                      "--out", "c"})
                .exit_code,
            0);
  const auto summary = Scores("c", 1)["summary"]["tracking_rmse_deg"];
  EXPECT_EQ(summary, Scores("c", 0)["summary"]["tracking_rmse_deg"]);
  EXPECT_GT(summary["mean"], 0.0);
}

TEST_F(Programs, ComputeWhatOursCompute) {
  Put("f.py", PythonFilter(kExponential));
  PutScenario(
      "  ours: {filter: {kind: exponential, alpha: 0.1}}\n"
      "  mine: {filter: {kind: external, command: python3 f.py, parameters: {alpha: 0.1}}}\n"
      "  other: {filter: {kind: external, command: python3 f.py, parameters: {alpha: 0.2}}}\n",
      0.6);
  ASSERT_EQ(Gauntlet({"run", "s.yaml", "--allow-programs"}).exit_code, 0);
  const auto of = [&](std::size_t controller, const char* metric) {
    return Scores("out/s", controller)["summary"][metric].get<double>();
  };
  for (const char* metric : {"tracking_rmse_deg", "peak_error_deg"}) {
    EXPECT_NEAR(of(1, metric), of(0, metric), 1e-9 * of(0, metric)) << metric;
    EXPECT_GT(std::abs(of(2, metric) - of(0, metric)), 1e-3 * of(0, metric)) << metric;
  }
  // Without the hand, and its own parameter as an axis.
  const ProgramResult tuned = Gauntlet({"tune", "s.yaml", "--controller", "mine", "--free",
                                        "filter.parameters.alpha=0.05:0.9", "--filter-only",
                                        "--evaluations", "5", "--allow-programs", "--out", "t"});
  EXPECT_EQ(tuned.exit_code, 0) << tuned.standard_error;
  EXPECT_THAT(tuned.standard_output, HasSubstr("alpha="));
}

/// A program that fails, and the end of the sentence about it.
struct Failure {
  const char* name;
  const char* step;
  const char* problem;
};
void PrintTo(const Failure& failure, std::ostream* stream) { *stream << failure.name; }

class FailingPrograms : public Programs, public testing::WithParamInterface<Failure> {};

TEST_P(FailingPrograms, CostTheirOwnTrialsOnly) {
  Put("f.py", PythonFilter(GetParam().step));
  PutScenario(
      "  none: {filter: none}\n"
      "  mine: {filter: {kind: external, command: python3 f.py, timeout_ms: 400}}\n",
      0.2);
  const ProgramResult result = Gauntlet(
      {"compare", "s.yaml", "--seeds", "2", "--causes", "none", "--allow-programs", "--out", "c"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_error,
              AllOf(HasSubstr("mine failed in 2 of 2 trials and is not ranked: python3 f.py: at "
                              "sample "),
                    HasSubstr(GetParam().problem)));
  const auto scores = nlohmann::json::parse(ReadFile(In("c/scores.json")));
  EXPECT_EQ(scores["controllers"][0].value("failed_trials", 0), 0);
  EXPECT_GT(scores["controllers"][0]["summary"]["tracking_rmse_deg"]["mean"], 0.0);
  EXPECT_EQ(scores["controllers"][1]["failed_trials"], 2);
  EXPECT_TRUE(scores["controllers"][1]["summary"]["tracking_rmse_deg"]["mean"].is_null());
  EXPECT_TRUE(fs::exists(In("c/report.html")));
}

INSTANTIATE_TEST_SUITE_P(
    All, FailingPrograms,
    testing::Values(Failure{"Dies", "    if n == 100: raise ValueError('no more')",
                            "at sample 100: ended with exit code 1: ValueError: no more"},
                    Failure{"DiesAtOnce", "    sys.exit('not today')",
                            "at sample 1: ended with exit code 1: not today"},
                    Failure{"IsKilled", "    if n == 7: os.kill(os.getpid(), 9)",
                            "at sample 7: ended by signal 9"},
                    Failure{"Sleeps", "    if n == 50: time.sleep(600)",
                            "at sample 50: did not answer within 400 ms"},
                    Failure{
                        "Babbles", "    if n == 3: print('three', flush=True); continue",
                        "at sample 3: answered \"three\", must be 2 finite numbers with commas"},
                    Failure{"IsNotFinite", "    if n == 3: out = [float('nan'), 1.0]",
                            "at sample 3: answered \"nan,1.0\", must be 2 finite numbers"},
                    Failure{"AnswersOneValue", "    if n == 4: out = values[:1]",
                            "at sample 4: answered 1 value, must be 2"},
                    Failure{"AnswersTwice", "    if n == 5: print(line.strip(), flush=False)",
                            "answered more than it was asked: "},
                    Failure{"ClosesItsOutput", "    if n == 6: os.close(1); time.sleep(600)",
                            "at sample 6: closed its input or output"},
                    Failure{"WritesManyErrors",
                            "    sys.stderr.write('x' * 300000 + '\\nlast\\n'); "
                            "sys.stderr.flush()\n    if n == 9: sys.exit(3)",
                            "at sample 9: ended with exit code 3: last"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(Programs, ThatDoNotReadAreNoticed) {
  Put("f.py", "import time\nwhile True: print('1,2', flush=True); time.sleep(0.01)\n");
  PutScenario("  mine: {filter: {kind: external, command: python3 f.py}}\n");
  const ProgramResult slow = Gauntlet({"run", "s.yaml", "--allow-programs"});
  EXPECT_EQ(slow.exit_code, 1);
  EXPECT_THAT(slow.standard_error, HasSubstr("answered more than it was asked"));
  Put("f.py", "import time\ntime.sleep(600)\n");
  PutScenario("  mine: {filter: {kind: external, command: python3 f.py, timeout_ms: 30}}\n");
  const ProgramResult silent = Gauntlet({"run", "s.yaml", "--allow-programs"});
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.standard_error, HasSubstr("at sample 1: did not answer within 300 ms"));
}

TEST_F(Programs, AsASharedLibraryGiveTheBytesOfOurs) {
  fs::copy_file(GAUNTLET_ODD_FILTER, In("odd.so"));
  PutScenario(
      "  ours: {filter: {kind: exponential, alpha: 0.1}}\n"
      "  mine: {filter: {kind: external, library: ./odd.so, parameters: {alpha: 0.1}}}\n"
      "  other: {filter: {kind: external, library: ./odd.so, parameters: {alpha: 0.2}}}\n",
      1.5);
  const ProgramResult refused = Gauntlet({"run", "s.yaml"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.standard_error,
              HasSubstr("library: is the library ./odd.so, which runs only with --allow-programs"));
  ASSERT_EQ(Gauntlet({"run", "s.yaml", "--allow-programs"}).exit_code, 0);
  EXPECT_EQ(Scores("out/s", 1), Scores("out/s", 0));
  EXPECT_NE(Scores("out/s", 2), Scores("out/s", 0));
  const ProgramResult exported = Gauntlet({"export", "out/s", "--controller", "mine"});
  EXPECT_EQ(exported.exit_code, 2);
  // In real time, too: the same samples, and what they give.
  const ProgramResult live =
      Gauntlet({"live", "s.yaml", "--controller", "mine", "--shadow", "ours", "--allow-programs"});
  EXPECT_EQ(live.exit_code, 0) << live.standard_error;
  const auto of = nlohmann::json::parse(ReadFile(In("out/s_live/live.json")))["controllers"];
  for (const char* metric : {"jitter_rms_deg", "tracking_rmse_deg", "delay_ms"}) {
    if (of[0][metric].is_null()) continue;  // of a session too short
    const double value = of[0][metric];     // what a shadow asks for is noted as float
    EXPECT_NEAR(of[1][metric], value, 1e-4 * value) << metric;
  }
}

TEST_F(Programs, AsASharedLibraryThatFailsCostTheirOwnTrialsOnly) {
  fs::copy_file(GAUNTLET_ODD_FILTER, In("odd.so"));
  PutScenario(
      "  none: {filter: none}\n"
      "  fails: {filter: {kind: external, library: ./odd.so, parameters: {fail_at: 7}}}\n"
      "  nan: {filter: {kind: external, library: ./odd.so, parameters: {nan_at: 9}}}\n",
      0.2);
  const ProgramResult result = Gauntlet({"run", "s.yaml", "--allow-programs"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.standard_error, HasSubstr("./odd.so: at sample 7: returned 3, must be 0"));
  EXPECT_THAT(result.standard_output, HasSubstr("./odd.so: at sample 9: returned a"));
  EXPECT_GT(Scores("out/s", 0)["summary"]["tracking_rmse_deg"], 0.0);
  const ProgramResult live =
      Gauntlet({"live", "s.yaml", "--controller", "fails", "--allow-programs"});
  EXPECT_EQ(live.exit_code, 1);
  EXPECT_THAT(live.standard_error,
              HasSubstr("fails: ./odd.so: at sample 7: returned 3, must be 0; from there on"));

  Put("text.so", "no library\n");
  for (const auto& [filter, problem] : std::vector<std::pair<std::string, std::string>>{
           {"library: ./odd.so, parameters: {alpha: -1}", "library: refuses: alpha must be"},
           {"library: ./none.so", "none.so: no such file"},
           {"library: ./text.so", "text.so"},
           {"library: /lib/x86_64-linux-gnu/libm.so.6", "has no function gauntlet_filter_1()"},
           {"library: ./odd.so, command: cat", "command: is there beside a library"}}) {
    if (problem.starts_with("has no") && !fs::exists("/lib/x86_64-linux-gnu/libm.so.6")) continue;
    PutScenario("  mine: {filter: {kind: external, " + filter + "}}\n");
    const ProgramResult mistake = Gauntlet({"run", "s.yaml", "--allow-programs", "--out", "m"});
    EXPECT_EQ(mistake.exit_code, 2) << filter << mistake.standard_error;
    EXPECT_THAT(mistake.standard_error, AllOf(HasSubstr("mine"), HasSubstr(problem))) << filter;
  }
}

TEST(LibraryFilter, ThatFailsPassesItsInputOnAlsoInPlace) {
  sim::AllowPrograms();
  controller::ExternalConfig external;
  external.library = GAUNTLET_ODD_FILTER;
  external.parameters = {{"nan_at", 2.0}};
  controller::ControllerConfig config;
  config.filters = {{.settings = external}};
  const sim::TrialPrograms programs(config);
  const std::vector<std::string> names = {"index_mcp"};
  const auto filter = controller::MakeFilter(programs.config().filters[0], names, 1000.0);
  for (double value : {5.0, 7.0, 9.0}) {
    std::array values = {value};
    filter->Step(values, values);
    EXPECT_EQ(values[0], value);
    EXPECT_EQ(programs.ok(), value == 5.0);
  }
  sim::AllowPrograms(false);
}

TEST_F(Programs, ThatAreNotThereAreMistakes) {
  const auto refusal = [&](const std::string& filter) {
    PutScenario("  mine: {filter: {kind: external, " + filter + "}}\n");
    const ProgramResult result = Gauntlet({"run", "s.yaml", "--allow-programs"});
    EXPECT_EQ(result.exit_code, 2) << filter;
    return result.standard_error;
  };
  EXPECT_THAT(
      refusal("command: no_such_program_x"),
      AllOf(HasSubstr("s.yaml:4:"), HasSubstr("controllers.mine.filter[0].command: "
                                              "no_such_program_x: no program of this name")));
  EXPECT_THAT(refusal("command: ./f.py"), HasSubstr("f.py: no program that can be run"));
  EXPECT_THAT(refusal("command: \"python3 'f.py\""), HasSubstr("a quote ' that does not end"));
  EXPECT_THAT(refusal("folder: nowhere, command: python3"), HasSubstr("nowhere: no such folder"));
  EXPECT_THAT(refusal("command: \"\""), HasSubstr("command"));
  EXPECT_THAT(refusal("timeout_ms: 5"), HasSubstr("command: is missing"));
  EXPECT_THAT(refusal("command: python3, parameters: {a: b}"),
              HasSubstr("parameters.a: is \"b\", must be a number"));
  EXPECT_THAT(refusal("command: python3, parameters: 3"), HasSubstr("must be names with a number"));
  const ProgramResult stream = RunProgram({GAUNTLET_PROGRAM, "filter", "external"}, {});
  EXPECT_EQ(stream.exit_code, 2);
}

TEST_F(Programs, RunInTheFolderOfTheirScenario) {
  fs::create_directory(In("theirs"));
  Put("theirs/f.py", PythonFilter(kIdentity));
  PutScenario("  mine: {filter: {kind: external, command: \"python3 'f.py'\"}}\n");
  fs::rename(In("s.yaml"), In("theirs/s.yaml"));
  EXPECT_EQ(Gauntlet({"run", "theirs/s.yaml", "--allow-programs"}).exit_code, 0);
}

TEST_F(Programs, AreRunAgainUnlessTheyAreDeterministic) {
  Put("f.py", "open('starts', 'a').write('x')\n" +
                  PythonFilter("    out = [v + random.random() for v in values]"));
  const auto starts = [&] {
    const std::uintmax_t count = fs::exists(In("starts")) ? fs::file_size(In("starts")) : 0;
    fs::remove(In("starts"));
    return count;
  };
  const auto compare = [&] {
    return Gauntlet({"compare", "s.yaml", "--seeds", "3", "--causes", "none", "--allow-programs"})
        .exit_code;
  };
  for (const bool deterministic : {false, true}) {
    PutScenario(
        fmt::format("  none: {{filter: none}}\n  mine: {{filter: {{kind: external, command: "
                    "python3 f.py, deterministic: {}}}}}\n",
                    deterministic),
        0.2);
    ASSERT_EQ(compare(), 0);
    const std::uintmax_t first = starts();
    EXPECT_GE(first, 3u);
    ASSERT_EQ(compare(), 0);
    // The first seed runs again, as its signals are shown.
    if (deterministic) {
      EXPECT_LT(starts(), first);
    } else {
      EXPECT_EQ(starts(), first);
    }
  }
  // Other bytes are another program.
  Put("f.py", "open('starts', 'a').write('x')\n" + PythonFilter(kIdentity));
  ASSERT_EQ(compare(), 0);
  EXPECT_GE(starts(), 3u);
}

TEST_F(Programs, InheritNoDescriptorAndLeaveNoProcess) {
  Put("f.py",
      "import os, subprocess\n"
      "descriptors = ' '.join(sorted(os.listdir('/proc/self/fd')))\n"
      "open('descriptors', 'w').write(descriptors)\n"
      "open('processes', 'w').write(str(os.getpid()) + ' ' + "
      "str(subprocess.Popen(['sleep', '600'], stdout=subprocess.DEVNULL).pid))\n" +
          PythonFilter(kIdentity));
  PutScenario("  mine: {filter: {kind: external, command: python3 f.py}}\n", 0.2);
  ASSERT_EQ(Gauntlet({"run", "s.yaml", "--allow-programs", "--causes", "none"}).exit_code, 0);
  // The fourth is that of the listing.
  EXPECT_EQ(ReadFile(In("descriptors")), "0 1 2 3");
  std::istringstream processes(ReadFile(In("processes")));
  for (pid_t process = 0; processes >> process;) {
    EXPECT_FALSE(IsRunning(process)) << process;
  }
}

/// Writes its number into the file `name`.
constexpr const char* kOtherProcesses = R"(import os, signal, subprocess, sys, time
def note(name):
    with open(name + '.part', 'w') as file: file.write(str(os.getpid()))
    os.rename(name + '.part', name)
def stay(name):
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    note(name)
    time.sleep(600)
    os._exit(0)
if not os.fork(): stay('in_group')
if not os.fork():
    os.setsid()
    stay('in_session')
if not os.fork():  # a daemon: its parent ends before it
    os.setsid()
    if not os.fork(): stay('daemon')
    os._exit(0)
while not all(map(os.path.exists, ['in_group', 'in_session', 'daemon'])): time.sleep(0.01)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
note('own')
)";

class EndedPrograms : public Programs, public testing::WithParamInterface<int> {};

TEST_P(EndedPrograms, LeaveNothingOfWhatTheyStarted) {
  Put("f.py", kOtherProcesses + PythonFilter("    if n == 20: note('waits'); time.sleep(600)"));
  PutScenario("  mine: {filter: {kind: external, command: python3 f.py, timeout_ms: 300000}}\n");
  Program gauntlet({GAUNTLET_PROGRAM, "compare", "s.yaml", "--seeds", "2", "--allow-programs"},
                   {.working_directory = folder_.path(), .timeout = std::chrono::seconds(60)});
  ASSERT_TRUE(gauntlet.WaitForPath(In("waits")));
  gauntlet.SendSignal(GetParam());
  const ProgramResult& result = gauntlet.Wait();
  if (GetParam() == SIGKILL) {
    EXPECT_EQ(result.signal, SIGKILL);
  } else {
    EXPECT_EQ(result.exit_code, 128 + GetParam()) << result.standard_error;
    EXPECT_THAT(result.standard_error, HasSubstr("interrupted; nothing half-written was left"));
  }
  for (const char* name : {"own", "in_group", "in_session", "daemon"}) {
    EXPECT_FALSE(IsRunning(std::stoi(ReadFile(In(name))))) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, EndedPrograms, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGKILL),
                         [](const auto& signal) {
                           return std::string("BySignal") + std::to_string(signal.param);
                         });

TEST_F(Programs, WhoseProcessesLeftTheirGroupAreNamedOnce) {
  Put("f.py", kOtherProcesses + PythonFilter(kIdentity));
  PutScenario("  mine: {filter: {kind: external, command: python3 f.py}}\n", 0.2);
  const ProgramResult result =
      Gauntlet({"compare", "s.yaml", "--seeds", "2", "--causes", "none", "--allow-programs"});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  const std::string warning =
      "gauntlet: warning: python3 f.py started processes that left its process group (python3); "
      "they were ended with it\n";
  EXPECT_THAT(result.standard_error, HasSubstr(warning));
  EXPECT_EQ(result.standard_error.find("warning"), result.standard_error.rfind("warning"));
  for (const char* name : {"own", "in_group", "in_session", "daemon"}) {
    EXPECT_FALSE(IsRunning(std::stoi(ReadFile(In(name))))) << name;
  }
}

// It ends by itself when its input is closed.
TEST_F(Programs, MayLeaveTheirGroupThemselves) {
  Put("f.py", PythonFilter(kIdentity) + "open('ended', 'w').close()\n");
  PutScenario(
      "  none: {filter: none}\n"
      "  mine: {filter: {kind: external, command: setsid python3 f.py}}\n");
  const ProgramResult result = Gauntlet({"run", "s.yaml", "--allow-programs", "--causes", "none"});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, Not(HasSubstr("warning")));
  EXPECT_TRUE(fs::exists(In("ended")));
  EXPECT_EQ(Scores("out/s", 1), Scores("out/s", 0));
}

TEST_F(Programs, HearEverySignalByDefault) {
  Put("f.sh",
      "grep -E '^Sig(Blk|Ign)' /proc/self/status > signals\n"
      "read header; while read -r line; do echo \"$line\"; done\n");
  PutScenario("  mine: {filter: {kind: external, command: sh f.sh}}\n", 0.1);
  // As below nohup.
  const ProgramResult result = RunProgram(
      {"sh", "-c", "trap '' HUP INT; exec \"$0\" run s.yaml --allow-programs", GAUNTLET_PROGRAM},
      {.working_directory = folder_.path(), .timeout = std::chrono::seconds(120)});
  EXPECT_EQ(result.exit_code, 0) << result.standard_error;
  // Two of the C library's own are what the test's posix_spawn() left.
  EXPECT_THAT(ReadFile(In("signals")),
              MatchesRegex("SigBlk:\t0000000000000000\nSigIgn:\t0000000[01][08]0000000\n"));
}

TEST_F(Programs, EndWithCtrlC) {
  Put("f.py", "import os\nopen('process', 'w').write(str(os.getpid()))\n" +
                  PythonFilter("    if n == 2: open('waits', 'w').close(); time.sleep(600)"));
  PutScenario("  mine: {filter: {kind: external, command: python3 f.py, timeout_ms: 300000}}\n");
  Program gauntlet({GAUNTLET_PROGRAM, "run", "s.yaml", "--allow-programs"},
                   {.working_directory = folder_.path(), .timeout = std::chrono::seconds(60)});
  ASSERT_TRUE(gauntlet.WaitForPath(In("waits")));
  gauntlet.SendSignal(SIGINT);
  EXPECT_EQ(gauntlet.Wait().exit_code, 130);
  const pid_t process = std::stoi(ReadFile(In("process")));
  EXPECT_FALSE(IsRunning(process));
}

}  // namespace
}  // namespace gauntlet::test
