// What gauntlet filter makes of other people's files: their rate, their names, their gaps.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

ProgramResult Filter(std::vector<std::string> arguments, const std::string& input) {
  arguments.insert(arguments.begin(), {GAUNTLET_PROGRAM, "filter"});
  ProgramOptions options;
  options.standard_input = input;
  return RunProgram(arguments, options);
}

/// A sine of 5 Hz, `seconds` long; `time` writes the time of a row.
template <class Time>
std::string Sine(const std::string& name, double rate_hz, double seconds, const Time& time) {
  std::string text = name + ",a\n";
  for (int k = 0; k < rate_hz * seconds; ++k) {
    const double t = k / rate_hz;
    text += fmt::format("{},{}\n", time(t), std::sin(10.0 * std::numbers::pi * t));
  }
  return text;
}

/// Largest value in the second half of what came out.
double AmplitudeOf(const std::string& output) {
  std::istringstream lines(output);
  std::vector<double> values;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) values.push_back(std::stod(line.substr(line.find(',') + 1)));
  return *std::max_element(values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                           values.end());
}

const std::vector<std::string> kFiveHz = {"butterworth", "--set", "cutoff_hz=5"};
constexpr double kHalfPower = 0.70710678118654757;

TEST(FilterRate, IsThatOfTheColumnOfTime) {
  const auto seconds = [](double t) { return fmt::format("{:.6f}", t); };
  const auto unix_time = [](double t) { return fmt::format("{:.3f}", 1.7e9 + t); };
  const auto milliseconds = [](double t) { return fmt::format("{:.0f}", std::floor(1e3 * t)); };
  const auto microseconds = [](double t) { return fmt::format("{:.0f}", 1e6 * t); };
  const std::string inputs[] = {
      Sine("t_s", 100.0, 4.0, seconds),         Sine("timestamp", 100.0, 4.0, unix_time),
      Sine("time_ms", 60.0, 4.0, milliseconds), Sine("Time [us]", 250.0, 4.0, microseconds),
      Sine("millis", 100.0, 4.0, milliseconds), Sine("time", 2000.0, 4.0, seconds)};
  for (const std::string& input : inputs) {
    const ProgramResult result = Filter(kFiveHz, input);
    ASSERT_EQ(result.exit_code, 0) << result.standard_error;
    EXPECT_EQ(result.standard_error, "");
    // -3 dB at its cutoff; a sampled sine may miss its peak, and times may be rounded.
    EXPECT_NEAR(AmplitudeOf(result.standard_output), kHalfPower, 0.01) << input.substr(0, 20);
  }
}

TEST(FilterRate, IsNotMovedByARowThatIsMissing) {
  std::string input = Sine("t_s", 100.0, 4.0, [](double t) { return fmt::format("{:.4f}", t); });
  const std::size_t row = input.find("0.0500,");
  input.erase(row, input.find('\n', row) + 1 - row);
  EXPECT_NEAR(AmplitudeOf(Filter(kFiveHz, input).standard_output), kHalfPower, 0.01);
}

TEST(FilterRate, IsAskedForWhereNothingTellsIt) {
  const ProgramResult refused = Filter(kFiveHz, "a\n0\n1\n");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.standard_output, "");
  EXPECT_EQ(refused.standard_error,
            "gauntlet: filter butterworth: needs the sampling rate: a column of time (as time_s), "
            "or --set rate_hz=HZ\n");
  const auto with = [](const std::string& cutoff_hz, const std::string& rate_hz) {
    return Filter({"butterworth", "--set", "cutoff_hz=" + cutoff_hz, "--set", "rate_hz=" + rate_hz},
                  "a\n0\n1\n1\n1\n")
        .standard_output;
  };
  EXPECT_EQ(with("5", "1000"), with("10", "2000"));
  EXPECT_NE(with("5", "1000"), with("5", "100"));
  EXPECT_EQ(Filter({"one_euro"}, "a\n1\n").exit_code, 2);
  EXPECT_EQ(Filter({"kalman", "--set", "r=4", "--set", "process_noise=white"}, "a\n1\n").exit_code,
            2);
  for (const char* kind : {"none", "moving_average", "median", "hampel", "exponential"}) {
    EXPECT_EQ(Filter({kind}, "a\n1\n").exit_code, 0) << kind << " counts samples only";
  }
  EXPECT_EQ(Filter({"kalman", "--set", "r=4"}, "a\n1\n").exit_code, 0) << "Q = I per step";
}

TEST(FilterRate, IsRefusedWhereTimesDoNotTellIt) {
  const auto complaint = [](const std::string& input) {
    const ProgramResult result = Filter(kFiveHz, input);
    EXPECT_EQ(result.exit_code, 2) << input;
    return result.standard_error;
  };
  EXPECT_THAT(complaint("time,a\n0,1\n10,1\n20,1\n"),
              HasSubstr("standard input:1:1: gives 0.1 Hz, must be 10 to 10000 Hz; name the unit"));
  EXPECT_THAT(complaint("t_s,a\n0,1\n0.01,1\n0.01,1\n"),
              HasSubstr("standard input:4:1: is \"0.01\", must be a time above that of the row"));
  EXPECT_THAT(complaint("t_s,a\n0,1\n,1\n"), HasSubstr("standard input:3:1: is \"\", must be"));
  EXPECT_THAT(complaint("t_s,a\n0,1\n"), HasSubstr("has one row"));
  EXPECT_EQ(Filter(kFiveHz, "t_s,a\n").standard_output, "t_s,a\n");
}

TEST(FilterRate, ThatContradictsTheTimesIsSaid) {
  const std::string input = Sine("t_s", 100.0, 1.0, [](double t) { return fmt::format("{}", t); });
  std::vector<std::string> arguments = kFiveHz;
  arguments.insert(arguments.end(), {"--set", "rate_hz=1000"});
  const ProgramResult result = Filter(arguments, input);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.standard_error,
              HasSubstr("its times say 100 Hz, the filter was made for 1000 Hz"));
}

TEST(FilterColumns, OfTimeAreKnownByTheirUsualNames) {
  for (const char* name :
       {"t_s", "k", "time", "time_s", "time_ms", "T_S", "\"t_s\"", "\xEF\xBB\xBFt_s", "t",
        "timestamp", "Timestamp (ms)", "time [s]", "timestamp_us", "TimeMs", "seconds", "millis",
        "elapsed", "frame", "sample_number"}) {
    const ProgramResult result =
        Filter({"moving_average", "--set", "window=2"}, std::string(name) + ",a\n5,1\n7,3\n");
    EXPECT_EQ(result.exit_code, 0) << name;
    EXPECT_THAT(result.standard_output, EndsWith("a\n5,1\n7,2\n")) << name;
    EXPECT_EQ(result.standard_error, "") << name;
  }
}

TEST(FilterColumns, ThatMayBeTimeAreNamed) {
  for (const char* name : {"index", "date", "system clock", "tick", "id", "local_time", "i"}) {
    const ProgramResult result =
        Filter({"moving_average", "--set", "window=2"}, std::string(name) + ",a\n5,1\n7,3\n");
    EXPECT_EQ(result.exit_code, 0) << name;
    EXPECT_THAT(result.standard_output, EndsWith("a\n5,1\n6,2\n")) << name;
    EXPECT_THAT(
        result.standard_error,
        HasSubstr(fmt::format("warning: standard input:1:1: {} is filtered as a channel", name)));
  }
  for (const char* name : {"thumb", "index_mcp", "middle", "sensor 3", "x"}) {
    EXPECT_EQ(Filter({"none"}, std::string(name) + "\n1\n").standard_error, "") << name;
  }
}

TEST(FilterValues, ThatAreMissingOrTooLargeAreHeld) {
  const ProgramResult result =
      Filter({"none"}, "a\n1\nNA\n2\n1e400\n-1e400\n3\nnull\nN/A\nNaN\ninf\n1e-400\n");
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_output, "a\n1\n1\n2\n2\n2\n3\n3\n3\n3\n3\n0\n");
  EXPECT_EQ(result.standard_error, "gauntlet: 7 missing values held at the last good one\n");
}

TEST(FilterValues, AreWrittenWithTheFewestDigitsThatReadBack) {
  EXPECT_EQ(Filter({"none"}, "a\n0.1\n1e21\n0.30000000000000004\n-0\n123456789\n").standard_output,
            "a\n0.1\n1e+21\n0.30000000000000004\n-0\n123456789\n");
}

TEST(FilterColumns, MayBeSeparatedByOtherThanCommas) {
  const std::vector<std::string> mean = {"moving_average", "--set", "window=2"};
  EXPECT_EQ(Filter(mean, "t_s;a\n0,01;1,5\n0,02;2,5\n").standard_output,
            "t_s;a\n0,01;1,5\n0,02;2\n");
  EXPECT_EQ(Filter(mean, "a\tb\n1\t10\n2\t20\n").standard_output, "a\tb\n1\t10\n1.5\t15\n");
}

TEST(FilterColumns, ThatAreNotAskedForPassThroughAsText) {
  const std::string input = "label,a,b,time_ms\nV,1,10,0\nV,2,20,10\n";
  const std::string only_a = "label,a,b,time_ms\nV,1,10,0\nV,1.5,20,10\n";
  for (const char* asked : {"a", "2"}) {
    EXPECT_EQ(
        Filter({"moving_average", "--set", "window=2", "--columns", asked}, input).standard_output,
        only_a);
  }
  EXPECT_THAT(
      Filter({"moving_average", "--set", "window=2", "--columns", "a,b"}, input).standard_output,
      HasSubstr("V,1.5,15,10\n"));
  const ProgramResult unknown = Filter({"none", "--columns", "c"}, input);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.standard_error, HasSubstr("--columns: standard input has no column c"));
  EXPECT_EQ(Filter({"none", "--columns", "5"}, input).exit_code, 2);
}

TEST(FilterInput, ThatCannotBeReadIsNoEnd) {
  const ProgramResult result =
      RunProgram({"/bin/sh", "-c", std::string(GAUNTLET_PROGRAM) + " filter none < /"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.standard_error, "gauntlet: standard input: cannot be read: Is a directory\n");
}

TEST(FilterErrors, RepeatLittleOfALongField) {
  const std::string garbage(100'000, 'x');
  for (const std::string& input :
       {"a\n" + garbage + "\n", "t_s,a\n" + garbage + ",1\n", garbage + "time\n1\n"}) {
    for (const char* kind : {"none", "one_euro"}) {
      const ProgramResult result = Filter({kind}, input);
      EXPECT_THAT(result.standard_error, Not(HasSubstr(std::string(81, 'x'))));
      EXPECT_LT(result.standard_error.size(), 600u);
    }
  }
}

}  // namespace
}  // namespace gauntlet::test
