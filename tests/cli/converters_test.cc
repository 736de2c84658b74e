// A glove with signed converters and converters of different widths through a whole run.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "sim/trial/trace_reader.h"
#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/working_folder.h"

namespace gauntlet::test {
namespace {

using testing::HasSubstr;

constexpr int kChannels = 18;

// Only the ends of the converter tell a saturated sensor.
constexpr const char* kScenario = R"(question: q
glove:
  motion: {kind: random, duration_s: 3}
  faults: [{kind: saturated, rate_per_s: 5}, {kind: spikes}, {kind: offset_jump, start_s: 1}]
score: {noise_free_twin: false}
controllers:
  plain: {filter: {kind: moving_average, window: 5}, untrusted: {jump_share: 0}}
  raw: {filter: none, untrusted: {jump_share: 0.25}}
)";

class Converters : public testing::Test {
 protected:
  Converters() { folder_.Write("s.yaml", kScenario); }
  sim::TraceFile TraceOf(const std::string& out, const std::vector<std::string>& settings) {
    std::vector<std::string> command = {"run", "s.yaml", "--out", out};
    for (const std::string& setting : settings) {
      command.insert(command.end(), {"--set", setting});
    }
    const ProgramResult result = folder_.Run(command);
    EXPECT_EQ(result.exit_code, 0) << result.standard_error;
    return sim::ReadTraceFile(folder_.In(out) / "trace.h5");
  }
  WorkingFolder folder_{GAUNTLET_PROGRAM};
};

TEST_F(Converters, OfSignedCountsGiveTheCommandsOfCountsFromZero) {
  GAUNTLET_LONG_TEST();
  const sim::TraceFile from_zero = TraceOf("zero", {});
  std::vector<int> least(kChannels, 0);
  for (int c = 1; c < kChannels; c += 2) least[static_cast<std::size_t>(c)] = -512;
  const sim::TraceFile mixed =
      TraceOf("signed", {fmt::format("glove.converter.min_counts=[{}]", fmt::join(least, ","))});
  EXPECT_EQ(mixed.counts.col(0), from_zero.counts.col(0));
  EXPECT_EQ(mixed.counts.col(1).minCoeff(), -512.0) << "saturated at the lower end";
  EXPECT_EQ(from_zero.counts.col(1).minCoeff(), 0.0);
  ASSERT_EQ(mixed.traces.size(), 2U);
  for (std::size_t i = 0; i < mixed.traces.size(); ++i) {
    EXPECT_EQ(mixed.traces[i].command_counts, from_zero.traces[i].command_counts) << i;
    const auto difference =
        mixed.traces[i].filtered_angle_rad - from_zero.traces[i].filtered_angle_rad;
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6);
  }
  // The controller would follow what it did not notice.
  const sim::TraceFile trusting =
      TraceOf("trusting", {"controllers.plain.untrusted.full_scale=false"});
  EXPECT_NE(trusting.traces[0].command_counts, from_zero.traces[0].command_counts);
}

TEST_F(Converters, OfDifferentWidthsGiveTheSameAnglesToARoundingOfCounts) {
  const sim::TraceFile narrow = TraceOf("narrow", {});
  std::vector<int> bits(kChannels, 10), least(kChannels, 0);
  for (std::size_t c = 0; c < kChannels; c += 3) bits[c] = 12;
  for (std::size_t c = 0; c < kChannels; c += 6) least[c] = -2048;
  const sim::TraceFile mixed =
      TraceOf("mixed", {fmt::format("glove.converter.bits=[{}]", fmt::join(bits, ",")),
                        fmt::format("glove.converter.min_counts=[{}]", fmt::join(least, ","))});
  EXPECT_EQ(mixed.counts.col(6).minCoeff(), -2048.0);
  EXPECT_EQ(mixed.counts.col(3).maxCoeff(), 4095.0);
  const auto& of_narrow = narrow.traces[0].filtered_angle_rad;
  const auto& of_mixed = mixed.traces[0].filtered_angle_rad;
  for (Eigen::Index c = 0; c < kChannels; ++c) {
    // Where a value is at an end of one converter and one count beside that of the other, only one
    // of both is not trusted.
    const double rad_per_count = 2.6 / 818.4;  // at most, of 10 bits
    const auto difference = (of_mixed.col(c) - of_narrow.col(c)).array().abs();
    const auto apart = (difference > 0.7 * rad_per_count).count();
    EXPECT_LE(apart, of_narrow.rows() / 50) << c;
    // Every third channel has the finer converter, which rounds otherwise.
    EXPECT_EQ(difference.maxCoeff() > 0.0, c % 3 == 0) << c;
  }
}

TEST_F(Converters, ThatCannotBeAreRefusedWithTheirPlace) {
  const auto complaint = [&](const std::string& setting) {
    const ProgramResult result = folder_.Run({"run", "s.yaml", "--set", setting});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1);
    return result.standard_error;
  };
  EXPECT_THAT(complaint("glove.converter.bits=[10,12]"),
              HasSubstr("glove.converter.bits: has 2 values, must have 1 or 18"));
  EXPECT_THAT(complaint("glove.converter.bits=10.5"),
              HasSubstr("glove.converter.bits: is 10.5, must be a whole number"));
  std::string list = "glove.converter.bits=[10.5";
  for (int c = 1; c < kChannels; ++c) list += ",10";
  EXPECT_THAT(complaint(list + "]"),
              HasSubstr("glove.converter.bits: is 10.5, must be a whole number"));
  EXPECT_THAT(
      complaint("glove.converter.min_counts=1e9"),
      HasSubstr("glove.converter.min_counts: is 1e+09, must be from -16777216 to 16777216"));
  EXPECT_THAT(complaint("glove.converter.min_counts=-0.5"),
              HasSubstr("glove.converter.min_counts: is -0.5, must be a whole number"));
}

}  // namespace
}  // namespace gauntlet::test
