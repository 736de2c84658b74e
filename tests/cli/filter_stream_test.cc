// What gauntlet filter makes of other people's files: their rate, their names, their gaps.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/signal.h"
#include "sim/recordings/recording_reader.h"
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

TEST(FilterLines, AreAsLongAsThoseOfARecording) {
  constexpr std::size_t kLongest = 1 << 20;  // with its end
  const std::string row = "0,1";
  const std::string longest = row + std::string(kLongest - row.size() - 1, ' ');
  EXPECT_EQ(Filter({"none"}, "time_s,a\n" + longest + "\n" + row + "\n").standard_output,
            "time_s,a\n0,1\n0,1\n");
  EXPECT_EQ(Filter({"none"}, "time_s,a\n" + longest).standard_output, "time_s,a\n0,1\n");
  for (const std::string end : {" \n", " "}) {
    const ProgramResult longer = Filter({"none"}, "time_s,a\n" + row + "\n" + longest + end);
    EXPECT_EQ(longer.exit_code, 2);
    EXPECT_EQ(longer.standard_error,
              "gauntlet: standard input:3: the line is longer than 1048576 bytes\n");
    EXPECT_EQ(longer.standard_output, "time_s,a\n0,1\n");
  }
}

TEST(FilterLines, WithoutAnEndAreNotReadToIt) {
  for (const char* header : {"time_s,a\\n", ""}) {
    const TemporaryDirectory folder;
    const ProgramResult result =
        RunProgram({"/bin/bash", "-c",
                    std::string("(printf '") + header +
                        "'; head -c 200000000 /dev/zero | tr '\\0' 1 && touch all_is_read) | " +
                        GAUNTLET_PROGRAM + " filter none; exit ${PIPESTATUS[1]}"},
                   {.working_directory = folder.path()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.standard_error, HasSubstr("the line is longer than 1048576 bytes"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "all_is_read"));
  }
}

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

/// `gauntlet filter` with a map of this text.
ProgramResult FilterMapped(std::vector<std::string> arguments, const std::string& map,
                           const std::string& input) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "map.csv").string();
  std::ofstream(file) << map;
  arguments.insert(arguments.end(), {"--map", file});
  return Filter(arguments, input);
}

TEST(FilterMap, BringsColumnsToDegreesInTheirPlaces) {
  const std::string map =
      "column,channel,unit,sign,offset,raw_low,raw_high,deg_low,deg_high\n"
      "clock,time,ms,,,,,,\n"
      "bend,index_pip,counts,,,312,766,0,90\n"
      "thumb,thumb_ip,rad,-1,,,,,\n"
      "wrist,ignore,,,,,,,\n";
  const ProgramResult result = FilterMapped({"none"}, map,
                                            "label,thumb,clock,bend,wrist,note\n"
                                            "a b,-0.5,0,312,7,x\n"
                                            "V,0.25,10,766,8,y\n"
                                            "V,,20,539,9,\n");
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  std::istringstream lines(result.standard_output);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "label,thumb_ip_deg,clock,index_pip_deg,wrist,note");
  const double thumb_deg[] = {0.5 * 180.0 / std::numbers::pi, -0.25 * 180.0 / std::numbers::pi,
                              -0.25 * 180.0 / std::numbers::pi};  // the last one is held
  const double index_deg[] = {0.0, 90.0, 45.0};
  const std::string others[][3] = {{"a b", "0", "7,x"}, {"V", "10", "8,y"}, {"V", "20", "9,"}};
  for (int row = 0; row < 3; ++row) {
    std::getline(lines, line);
    double thumb = 0.0;
    double index = 0.0;
    const std::string pattern =
        others[row][0] + ",%lf," + others[row][1] + ",%lf," + others[row][2];
    ASSERT_EQ(std::sscanf(line.c_str(), pattern.c_str(), &thumb, &index), 2) << line;
    EXPECT_NEAR(thumb, thumb_deg[row], 1e-9);
    EXPECT_NEAR(index, index_deg[row], 1e-9);
    EXPECT_THAT(line, EndsWith(others[row][2]));
  }
}

TEST(FilterMap, AddsColumnsUpAndGivesOneToSeveral) {
  const std::string map =
      "column,channel,weight\na,index_mcp,0.25\nb,index_mcp,0.75\nc,ring_mcp,\nc,ring_pip,\n";
  EXPECT_EQ(FilterMapped({"none"}, map, "c;b;a\n10,5;20;40\n").standard_output,
            "ring_mcp_deg;ring_pip_deg;index_mcp_deg\n10,5;10,5;25\n");
}

TEST(FilterMap, FiltersTheChannelsThatAreAskedForAndScalesAll) {
  const std::string map = "column,channel,sign\na,index_mcp,1\nb,index_pip,-1\n";
  const std::string input = "a,b\n0,0\n10,-20\n";
  const std::vector<std::string> mean = {"moving_average", "--set", "window=2"};
  EXPECT_EQ(FilterMapped(mean, map, input).standard_output,
            "index_mcp_deg,index_pip_deg\n0,0\n5,10\n");
  std::vector<std::string> only = mean;
  only.insert(only.end(), {"--columns", "index_pip"});
  EXPECT_EQ(FilterMapped(only, map, input).standard_output,
            "index_mcp_deg,index_pip_deg\n0,0\n10,10\n");
  const ProgramResult unknown = FilterMapped({"none", "--columns", "index_pi"}, map, input);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.standard_error,
              HasSubstr("--columns: the map names no channel index_pi (did you mean index_pip?)"));
}

TEST(FilterMap, NamesTheTimeOfWhichTheRateFollows) {
  const std::string map =
      "column,channel,unit\nclock,time,date\nmilli,time,ms\nvalue,index_mcp,deg\n";
  std::string input = "clock,milli,value\n";
  for (int k = 0; k < 400; ++k) {
    input += fmt::format("10:00:{:02d},{},{}\n", k / 100, 10 * (k % 100),
                         std::sin(10.0 * std::numbers::pi * k / 100.0));
  }
  const ProgramResult result = FilterMapped(kFiveHz, map, input);
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(result.standard_error, "");
  std::string last_column;
  std::istringstream lines(result.standard_output);
  for (std::string line; std::getline(lines, line);) {
    last_column += "," + line.substr(line.rfind(',') + 1) + "\n";
  }
  EXPECT_NEAR(AmplitudeOf(last_column), kHalfPower, 0.01);
}

TEST(FilterMap, OfAPresetTakesNumbersWithoutAHeader) {
  const ProgramResult result =
      Filter({"none", "--map", "manus20"}, "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20\n");
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_EQ(std::ranges::count(result.standard_output, '\n'), 1) << "no header in, none out";
  EXPECT_THAT(FilterMapped({"none"}, "column,channel\nc,index_mcp\n", "a,b\n1,2\n").standard_error,
              HasSubstr("standard input has no column 'c', must be one of its names or 1 to 2"));
}

TEST(FilterMap, GivesTheAnglesThatARecordingHasByIt) {
  // The same file by the same map, the one as a stream and the other as a motion.
  const std::string map =
      "column,channel,unit,bits,raw_low,raw_high,deg_low,deg_high\n1,thumb_ip,counts,12,,,,\n"
      "2,index_pip,volts,,2.41,1.12,5,80\n3,middle_pip,share,,,,,\n4,ring_mcp,counts,,,,,\n";
  const std::string input = "1000,2.0,0.25,511.5\n2000,1.5,0.5,300\n";
  const ProgramResult result = FilterMapped({"none"}, map, input);
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const TemporaryDirectory folder;
  sim::RecordingFormat format;
  format.rate_hz = 100.0;
  format.map = (folder.path() / "map.csv").string();
  std::ofstream(format.map) << map;
  sim::RecordingReader reader("in.csv", sim::TextSource(input), format);
  double time_s = 0.0;
  std::vector<double> angle_rad(sim::KnownChannels().size());
  std::istringstream lines(result.standard_output);
  for (std::string line; std::getline(lines, line);) {
    ASSERT_TRUE(reader.NextRow(time_s, angle_rad));
    double deg[4] = {};
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &deg[0], &deg[1], &deg[2], &deg[3]), 4);
    const char* names[] = {"thumb_ip", "index_pip", "middle_pip", "ring_mcp"};
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(deg[i], angle_rad[sim::ChannelIndex(names[i])] * sim::kDegPerRad, 1e-9)
          << names[i];
    }
  }
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
