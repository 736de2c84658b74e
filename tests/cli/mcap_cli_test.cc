// MCAP through whole commands: what run --mcap writes is what run --csv writes, and can be played
// and identified again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/number.h"
#include "sim/base/csv_line.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/mcap_writer.h"
#include "sim/tables/message_type.h"
#include "sim/tables/text_lines.h"
#include "tests/support/long_test.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"
#include "tests/support/table_text.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

ProgramResult RunGauntlet(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
  return RunProgram(arguments);
}

/// Columns of a text table by name; NaN for empty cells.
std::map<std::string, std::vector<double>> ColumnsOf(const std::string& text) {
  std::map<std::string, std::vector<double>> columns;
  const std::vector<std::string_view> lines = sim::SplitLines(text);
  const std::vector<std::string_view> names = sim::SplitCells(lines.at(0), ',');
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string_view> cells = sim::SplitCells(lines[i], ',');
    for (std::size_t c = 0; c < cells.size(); ++c) {
      columns[std::string(names.at(c))].push_back(
          controller::ParseNumberOfProgram(cells[c]).value_or(controller::kNaN));
    }
  }
  return columns;
}

// Their names are compared with one another, and few are printed.
TEST(Mcap, OfTensOfThousandsOfTopicsIsListedAtOnce) {
  TemporaryDirectory folder;
  const fs::path file = folder.path() / "many.mcap";
  constexpr int kTopics = 40'000;
  std::ofstream stream(file, std::ios::binary);
  sim::McapWriter writer([&stream](std::string_view part) { stream << part; });
  std::uint16_t last = 0;
  for (int k = 0; k < kTopics; ++k) {
    last = writer.AddTopic("/t" + std::to_string(k), "sensor_msgs/msg/JointState",
                           sim::KnownMessage("sensor_msgs/JointState"));
  }
  for (int k = 0; k < 3; ++k) {
    sim::CdrWriter message;
    message.Time(k * std::int64_t{10'000'000});
    message.Text("");
    message.Texts({"index_mcp"});
    message.Numbers(std::vector{0.1 * k});
    message.Numbers({});
    message.Numbers({});
    writer.AddMessage(last, k * std::int64_t{10'000'000}, message.message());
    if (k > 0) writer.AddMessage(last - 1, k * std::int64_t{10'000'000}, message.message());
  }
  writer.Finish();
  stream.close();
  const ProgramResult result = RunGauntlet({"inspect", file.string()});
  EXPECT_EQ(result.exit_code, 2);
  // Those with signals first.
  EXPECT_THAT(result.standard_output,
              testing::MatchesRegex("topic[^\n]*\n/t39998 [^\n]*\n/t39999 .*"));
  EXPECT_EQ(std::ranges::count(result.standard_output, '\n'), 52);
  EXPECT_THAT(result.standard_output, HasSubstr("\nand 39950 more, in --json\n"));
  EXPECT_THAT(result.standard_error,
              HasSubstr("has several topics: /t39998, /t39999; --topic NAME takes one"));
}

TEST(McapOfARun, HasTheValuesAndTimesOfItsCsv) {
  GAUNTLET_LONG_TEST();
  TemporaryDirectory folder;
  const fs::path out = folder.path() / "out";
  const ProgramResult run =
      RunGauntlet({"run", SourceDir() + "/scenarios/hold_still.yaml", "--mcap", "--csv", "--causes",
                   "none", "--controllers", "raw", "--out", out.string()});
  ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  EXPECT_THAT(run.standard_error, HasSubstr("trace.mcap"));
  const auto csv = ColumnsOf(sim::BytesOf(sim::FileSource(out / "trace.raw.csv")));
  const std::size_t ticks = csv.at("t_s").size();
  ASSERT_GT(ticks, 1000U);
  const fs::path mcap = out / "trace.mcap";
  const auto expect_same = [&](const std::string& topic, const std::string& signal,
                               const std::string& prefix, const std::string& suffix) {
    SCOPED_TRACE(topic);
    const auto columns = ColumnsOf(TextOf(sim::TableSource(mcap, topic)));
    std::size_t compared = 0;
    for (const auto& [name, values] : csv) {
      if (!name.starts_with(signal + ".")) continue;
      const auto& found = columns.at(prefix + name.substr(signal.size() + 1) + suffix);
      std::size_t row = 0;
      for (std::size_t k = 0; k < ticks; ++k) {
        if (std::isnan(values[k])) continue;  // between the samples of the glove
        ASSERT_EQ(columns.at("time_s").at(row), csv.at("t_s")[k]);
        ASSERT_EQ(found.at(row), values[k]) << name << " " << k;
        ++row;
        ++compared;
      }
    }
    EXPECT_GE(compared, ticks);
    EXPECT_EQ(columns.at("time_s").size(), compared / (columns.size() - 1));
  };
  expect_same("/wearer/true_angle_rad", "true_angle_rad", "", "_rad");
  expect_same("/glove/counts", "counts", "value_", "");
  expect_same("/raw/hand_angle_rad", "hand_angle_rad", "", "_rad");
  expect_same("/raw/target_angle_rad", "target_angle_rad", "", "_rad");
  expect_same("/raw/spool_speed_rad_s", "spool_speed_rad_s", "velocity_", "");
  expect_same("/raw/command_counts", "command_counts", "value_", "");
  expect_same("/raw/tension_n", "tension_n", "value_", "");
}

TEST(McapOfARun, IsARecordingThatCanBePlayed) {
  TemporaryDirectory folder;
  const std::string out = (folder.path() / "out").string();
  ASSERT_EQ(RunGauntlet({"run", SourceDir() + "/scenarios/door_opening.yaml", "--mcap", "--causes",
                         "none", "--controllers", "raw", "--out", out})
                .exit_code,
            0);
  // As the argument of run, with a topic.
  const ProgramResult played = RunGauntlet(
      {"run", out + "/trace.mcap", "--topic", "/wearer/true_angle_rad", "--causes", "none",
       "--controllers", "raw", "--json", "--out", (folder.path() / "played").string()});
  ASSERT_EQ(played.exit_code, 0) << played.standard_error;
  const ProgramResult asked = RunGauntlet({"run", out + "/trace.mcap"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.standard_error, HasSubstr("has several topics: /wearer/true_angle_rad, "));
  // A result with an MCAP file in it stays a result.
  EXPECT_THAT(RunGauntlet({"identify", out}).standard_error, HasSubstr("out/trace.h5: "));
}

/// A log of a servo with a known delay, as a controller of ROS 2 publishes its state.
TEST(McapLog, OfCommandsAndAnglesIsIdentified) {
  GAUNTLET_LONG_TEST();
  TemporaryDirectory folder;
  const fs::path file = folder.path() / "servo.mcap";
  std::ofstream stream(file, std::ios::binary);
  sim::McapWriter writer(
      [&](std::string_view bytes) { stream.write(bytes.data(), std::ssize(bytes)); });
  const std::uint16_t topic =
      writer.AddTopic("/controller/state", "my_msgs/msg/ServoState",
                      "builtin_interfaces/Time stamp\nfloat64[] index_mcp_command_deg\nfloat64[] "
                      "index_mcp_deg\n");
  constexpr double kDelay_s = 0.060;
  const auto command_deg = [](double t) {
    return 30.0 + 12.0 * std::sin(5.0 * t) + 6.0 * std::sin(11.3 * t) + 3.0 * std::sin(23.0 * t);
  };
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.01 * k;
    const std::int64_t ns = std::int64_t{1700000000} * 1000000000 + std::int64_t{k} * 10000000;
    sim::CdrWriter message;
    message.Time(ns);
    message.Numbers(std::vector<double>{command_deg(t)});
    message.Numbers(std::vector<double>{command_deg(t - kDelay_s)});
    writer.AddMessage(topic, ns + 1000 * (k % 7), message.message());
  }
  writer.Finish();
  stream.close();
  const fs::path map = folder.path() / "map.csv";
  std::ofstream(map) << "column,channel,joint,unit\n"
                        "time_s,time,,s\n"
                        "index_mcp_command_deg_1,command,index_mcp,deg\n"
                        "index_mcp_deg_1,angle,index_mcp,deg\n";
  const ProgramResult result =
      RunGauntlet({"identify", file.string(), "--topic", "controller/state", "--map", map.string(),
                   "--json", "--out", (folder.path() / "servo.chain.yaml").string()});
  ASSERT_EQ(result.exit_code, 0) << result.standard_error;
  const auto found = nlohmann::json::parse(result.standard_output);
  EXPECT_THAT(result.standard_output, HasSubstr("delay_ms"));
  const std::string text = found.dump();
  const std::size_t at = text.find("\"delay_ms\":");
  ASSERT_NE(at, std::string::npos) << text;
  EXPECT_NEAR(found["parts"][0]["delay_ms"]["value"].get<double>(), 1e3 * kDelay_s, 1.0) << text;
}

}  // namespace
}  // namespace gauntlet::test
