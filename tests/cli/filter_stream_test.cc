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
#include "tests/support/long_test.h"
#include "tests/support/program.h"

namespace gauntlet::test {
namespace {

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
              "gauntlet: standard input:3:1: the line is longer than 1048576 bytes\n");
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

TEST(FilterMap, GivesTheEnvelopeThatARecordingHasByIt) {
  const std::string map =
      "column,channel,unit,raw_low,raw_high,envelope_ms\nt,time,s,,,\nemg,index_mcp,counts,0,1,"
      "50\n";
  std::string input = "t,emg\n";
  for (int k = 0; k < 300; ++k) {
    input +=
        fmt::format("{:.3f},{}\n", 1e-3 * k, (k % 2 == 0 ? 1.0 : -1.0) * (k < 150 ? 0.1 : 1.0));
  }
  const ProgramResult result = FilterMapped({"none"}, map, input);
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  EXPECT_THAT(result.standard_error, HasSubstr("index_mcp is the envelope of column 2"));
  const TemporaryDirectory folder;
  sim::RecordingFormat format;
  format.map = (folder.path() / "map.csv").string();
  std::ofstream(format.map) << map;
  sim::RecordingReader reader("in.csv", sim::TextSource(input), format);
  double time_s = 0.0;
  double last_deg = 0.0;
  std::vector<double> angle_rad(sim::KnownChannels().size());
  std::istringstream lines(result.standard_output);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "t,index_mcp_deg");
  while (std::getline(lines, line)) {
    ASSERT_TRUE(reader.NextRow(time_s, angle_rad));
    last_deg = angle_rad[sim::ChannelIndex("index_mcp")] * sim::kDegPerRad;
    EXPECT_NEAR(std::stod(line.substr(line.find(',') + 1)), last_deg, 1e-9) << line;
  }
  EXPECT_FALSE(reader.NextRow(time_s, angle_rad));
  EXPECT_GT(last_deg, 20.0) << "a muscle that is active";

  const std::string without_time =
      map.substr(0, map.find("t,time")) + "2,index_mcp,counts,0,1,50\n";
  const ProgramResult refused = FilterMapped({"none"}, without_time, input);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.standard_error,
              testing::StartsWith("gauntlet: --map: envelope_ms: needs the times of the rows"));
  EXPECT_EQ(FilterMapped({"none", "--set", "rate_hz=1000"}, without_time, input).exit_code, 0);
}

TEST(FilterErrors, RepeatLittleOfALongField) {
  GAUNTLET_LONG_TEST();
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
