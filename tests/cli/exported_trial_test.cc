// What gauntlet export writes, run by a program of its own, gives the motors what they got in the
// trial: count for count, over as many samples as the paper's recording has.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "sim/trial/trace_reader.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;

constexpr int kSamples = 94'096;
constexpr int kDelayTicks = 30;

// Every stage of a controller does something, and converters are of 10 and 12 bits, signed or not.
constexpr const char* kScenario = R"(question: q
glove:
  motion: {{kind: random, duration_s: {}}}
  converter:
    bits: [10, 12, 12, 10, 12, 10, 12, 10, 12, 10, 12, 10, 12, 10, 12, 10, 12, 10]
    min_counts: [0, -2048, 0, -512, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -512]
event: {{delay_ms: {}}}
score: {{noise_free_twin: false}}
controllers:
  tuned:
    filter: [{{kind: hampel, window: 5}}, {{kind: kalman, q: 0.001}}]
    prediction: {{kind: fitted, horizon_ms: 20, order: 2, tap_ms: 10, tap_means: true, weights: [-1.4, -0.7],
      position_weights: [0.1, 0.09, 0.08, 0.07, 0.06, 0.05, 0.04, 0.03, 0.02, -0.02, -0.03, -0.04, -0.05, -0.06, -0.07, -0.08, -0.09, -0.1],
      offset_deg: [1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, -0.2, -0.3, -0.4, -0.5, -0.6, -0.7, -0.8, -0.9, -1]}}
    motor: {{rounding: hysteresis}}
)";

class ExportedTrial : public testing::Test {
 protected:
  ProgramResult Run(const std::vector<std::string>& command, const std::string& input = "") {
    ProgramOptions options;
    options.working_directory = folder_.path();
    options.standard_input = input;
    options.timeout = std::chrono::minutes(10);  // with sanitizers, on a busy machine
    return RunProgram(command, options);
  }
  void Expect(const ProgramResult& result) {
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  }
  fs::path In(const std::string& name) const { return folder_.path() / name; }

  TemporaryDirectory folder_;
};

/// Holds what the program printed against what the servos held when its frames arrived.
void ExpectCommandsOf(const sim::Trace& trace, const std::string& printed) {
  std::istringstream lines(printed);
  int events = 0;
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    Eigen::Index tick = 0;
    words >> tick;
    const std::vector<int> command{std::istream_iterator<int>(words), {}};
    ASSERT_EQ(std::ssize(command), trace.command_counts.cols());
    const Eigen::Index arrival = tick + kDelayTicks;
    if (arrival >= trace.command_counts.rows()) break;
    for (Eigen::Index m = 0; m < trace.command_counts.cols(); ++m) {
      ASSERT_EQ(command[static_cast<std::size_t>(m)], trace.command_counts(arrival, m))
          << "tick " << tick << ", motor " << m;
    }
    ++events;
  }
  EXPECT_EQ(events, (kSamples - kDelayTicks + 19) / 20);
}

TEST_F(ExportedTrial, GivesTheCommandsOfTheTraceAsAFileAndText) {
  std::ofstream(In("s.yaml")) << fmt::format(kScenario, 1e-3 * kSamples, kDelayTicks);
  Expect(Run({GAUNTLET_PROGRAM, "run", "s.yaml", "--out", "out"}));
  Expect(Run({GAUNTLET_PROGRAM, "export", "out", "--controller", "tuned"}));
  Expect(Run({GAUNTLET_PROGRAM, "export", "out", "--controller", "tuned", "--text"}));
  const sim::TraceFile file = sim::ReadTraceFile(In("out/trace.h5"));
  ASSERT_EQ(file.counts.rows(), kSamples);
  ASSERT_GT((file.traces.front().command_counts.array().bottomRows(kSamples - 1) !=
             file.traces.front().command_counts.array().topRows(kSamples - 1))
                .count(),
            1000)
      << "the motors move";
  std::string samples;  // behind where the motors are before the first frame arrives
  for (const int counts : file.traces.front().command_counts.row(0)) {
    fmt::format_to(std::back_inserter(samples), "{} ", counts);
  }
  for (const auto row : file.counts.rowwise()) {
    for (const double counts : row) fmt::format_to(std::back_inserter(samples), "{} ", counts);
  }

  const ProgramResult of_file = Run({GAUNTLET_REPLAY, "out/tuned.robot.yaml"}, samples);
  Expect(of_file);
  ExpectCommandsOf(file.traces.front(), of_file.standard_output);

  const ProgramResult of_text = Run({GAUNTLET_FROM_C, "out/tuned.robot.txt"}, samples);
  Expect(of_text);
  EXPECT_TRUE(of_text.standard_output == of_file.standard_output);
}

}  // namespace
}  // namespace gauntlet::test
