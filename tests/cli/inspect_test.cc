// What gauntlet inspect makes of recordings in the shapes that public sources have, and whether the
// files that it writes run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/glove_files.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using testing::Not;

ProgramResult Gauntlet(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
  return RunProgram(arguments);
}

nlohmann::json Inspect(const fs::path& file, std::vector<std::string> more = {}) {
  std::vector<std::string> arguments = {"inspect", file.string(), "--json"};
  std::ranges::copy(more, std::back_inserter(arguments));
  const ProgramResult result = Gauntlet(arguments);
  auto found = nlohmann::json::parse(result.standard_output, nullptr, false);
  EXPECT_EQ(result.exit_code, found["question"] == "" ? 0 : 2) << result.standard_error;
  return found;
}

class EveryGloveFile : public testing::TestWithParam<GloveFile> {
 protected:
  EveryGloveFile() : file_(folder_.path() / GetParam().name) { GetParam().write(file_); }

  TemporaryDirectory folder_;
  fs::path file_;
};

TEST_P(EveryGloveFile, IsRecognised) {
  const nlohmann::json found = Inspect(file_);
  EXPECT_EQ(found["rate_is_known"], GetParam().rate_hz > 0.0);
  if (GetParam().rate_hz > 0.0) {
    EXPECT_NEAR(found["rate_hz"].get<double>(), GetParam().rate_hz, 0.02 * GetParam().rate_hz);
  }
  EXPECT_EQ(found["unit"], GetParam().unit);
  const auto& columns = found["columns"];
  const auto sensors = std::ranges::count_if(
      columns, [](const nlohmann::json& column) { return column.contains("channel"); });
  EXPECT_EQ(sensors, GetParam().sensors) << columns;
  EXPECT_THAT(found["question"].get<std::string>(), HasSubstr(GetParam().question));
}

TEST_P(EveryGloveFile, RunsWithTheScenarioThatIsWritten) {
  const std::string scenario = (folder_.path() / "scenario.yaml").string();
  const ProgramResult written = Gauntlet({"inspect", file_.string(), "--write-scenario", scenario});
  if (!GetParam().question.empty()) {
    EXPECT_EQ(written.exit_code, 2);
    EXPECT_FALSE(fs::exists(scenario));
    EXPECT_TRUE(fs::exists(folder_.path() / "scenario.map.csv"));
    return;
  }
  ASSERT_EQ(written.exit_code, 0) << written.standard_error;
  const ProgramResult run = Gauntlet({"run", scenario, "--controllers", "raw", "--out",
                                      (folder_.path() / "out").string(), "--json"});
  EXPECT_EQ(run.exit_code, 0) << run.standard_error;
  const auto scores = nlohmann::json::parse(run.standard_output, nullptr, false);
  ASSERT_FALSE(scores.is_discarded());
  // The hand follows what the file has: a joint that stands still would be off by its amplitude.
  const double error_deg = scores["controllers"][0]["summary"]["tracking_rmse_deg"];
  EXPECT_LT(error_deg, 25.0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryGloveFile, testing::ValuesIn(GloveFiles()),
                         [](const auto& file) {
                           std::string name = file.param.name;
                           std::ranges::replace(name, '.', '_');
                           return name;
                         });

class InspectCommand : public testing::Test {
 protected:
  fs::path Write(const std::string& name, const std::string& bytes) const {
    const fs::path file = folder_.path() / name;
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }
  /// The only line that a person gets.
  std::string ErrorOf(const fs::path& file) const {
    const ProgramResult result = Gauntlet({"inspect", file.string()});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(std::ranges::count(result.standard_error, '\n'), 1) << result.standard_error;
    return result.standard_error;
  }

  TemporaryDirectory folder_;
};

TEST_F(InspectCommand, CountsOfRaggedRowsThoseOfTheShapeOfItsReader) {
  // No row is as long as the first one that most are as long as.
  EXPECT_THAT(ErrorOf(Write("none.csv",
                            "6 8 7\n\n6 7.2 31 68. 89 047 22.3\n,,\n\n"
                            ".047386  33.37978 3  79.33942   78.13732\n7\n"
                            "7 0.79323  81.00902  51.885517 20.753948\n,,,,\n3 9\n5 8 5 3 2\n"
                            "9 . 2 4 5 2\n2 . 7 4 2\n,,,,\n1\n")),
              HasSubstr("holds no table of numbers"));
  const nlohmann::json two = Inspect(Write("two.csv", "1e308 +4\n1e3 700000 -inf\n 3 +4\n1e308"));
  EXPECT_EQ(two["columns"].size(), 2);
  EXPECT_EQ(two["rows"], 2);
  EXPECT_EQ(two["skipped_lines"], 2);
  EXPECT_EQ(two["columns"][1]["low"], 4.0);
  EXPECT_EQ(two["columns"][1]["high"], 4.0);
  const nlohmann::json behind =
      Inspect(Write("behind.csv", "time_s,index_mcp\n0,10,\n0.01,40,\n0.02,20,\n"));
  ASSERT_EQ(behind["columns"].size(), 2);
  EXPECT_EQ(behind["columns"][1]["channel"], "index_mcp");
  EXPECT_EQ(behind["columns"][1]["high"], 40.0);
  EXPECT_TRUE(behind["repairs"].empty());
}

TEST_F(InspectCommand, FindsNamesThatGoOverTheEndOfALine) {
  std::string text = "\"time\n(s)\",\"index\nmcp\",\"index\npip\"\n";
  for (int row = 0; row < 300; ++row) {
    const double angle = 45.0 + 30.0 * std::sin(0.05 * row);
    text += std::to_string(0.01 * row) + "," + std::to_string(angle) + "," +
            std::to_string(90.0 - angle) + "\n";
  }
  const fs::path file = Write("names.csv", text);
  const nlohmann::json found = Inspect(file);
  EXPECT_EQ(found["columns"][0]["time_unit"], "s");
  EXPECT_EQ(found["columns"][1]["name"], "index mcp");
  EXPECT_EQ(found["columns"][1]["channel"], "index_mcp");
  EXPECT_EQ(found["columns"][2]["channel"], "index_pip");
  EXPECT_EQ(found["rows"], 300);
  const std::string map =
      Write("map.csv", "column,channel,unit\ntime (s),time,s\nindex pip,index_pip,deg\n").string();
  const std::string scenario =
      Write("names.yaml",
            "question: q\nglove:\n  channels: [index_pip]\n  motion: {kind: recording, file: "
            "names.csv, map: map.csv}\ncontrollers: {raw: {}}\n")
          .string();
  const ProgramResult run = Gauntlet({"run", scenario, "--out", (folder_.path() / "o").string()});
  EXPECT_EQ(run.exit_code, 0) << run.standard_error;
}

TEST_F(InspectCommand, FindsDamagedFilesOfArrays) {
  for (const GloveFile& file : GloveFiles()) {
    if (!file.name.ends_with(".npz") && !file.name.ends_with(".mat") &&
        !file.name.ends_with(".hdf5"))
      continue;
    const fs::path path = folder_.path() / file.name;
    file.write(path);
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_THAT(ErrorOf(path), Not(HasSubstr("std::"))) << file.name;
  }
}

TEST_F(InspectCommand, FindsGapsRestartsClippingAndStuckSensors) {
  std::string text = "time_s,index_mcp,index_pip,thumb_ip\n";
  for (int row = 0; row < 2000; ++row) {
    double t = 0.01 * row;
    if (row >= 500) t += 2.0;    // a gap
    if (row >= 1000) t -= 12.0;  // the clock starts anew
    const double angle = 60.0 * std::sin(0.03 * row);
    text += std::to_string(t) + "," + std::to_string(std::clamp(angle, -30.0, 30.0)) + "," +
            std::to_string(std::abs(angle)) + ",12\n";
  }
  const nlohmann::json found = Inspect(Write("faults.csv", text));
  EXPECT_NEAR(found["rate_hz"].get<double>(), 100.0, 0.5);
  EXPECT_EQ(found["gaps"], 1);
  EXPECT_EQ(found["restarts"], 1);
  EXPECT_GT(found["columns"][1]["clipped_share"], 0.5);
  EXPECT_LT(found["columns"][2]["clipped_share"], 0.01);
  EXPECT_GT(found["columns"][3]["still_share"], 0.99);
}

TEST_F(InspectCommand, MeasuresNoiseAndStep) {
  std::string text = "time_s,index_mcp\n";
  std::uint64_t state = 1;
  for (int row = 0; row < 5000; ++row) {
    double sum = -6.0;  // of twelve even numbers: normal, deviation 1
    for (int i = 0; i < 12; ++i) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      sum += static_cast<double>(state >> 11) * 0x1p-53;
    }
    const double angle = 40.0 + 30.0 * std::sin(0.01 * row) + 0.8 * sum;
    text +=
        std::to_string(0.01 * row) + "," + std::to_string(0.25 * std::round(4.0 * angle)) + "\n";
  }
  const nlohmann::json found = Inspect(Write("noise.csv", text));
  EXPECT_NEAR(found["columns"][1]["noise"].get<double>(), 0.8, 0.08);
  EXPECT_EQ(found["columns"][1]["step"], 0.25);
}

TEST_F(InspectCommand, TakesARateAndAPreset) {
  std::string text;
  for (int row = 0; row < 200; ++row) {
    for (int i = 0; i < 5; ++i)
      text += std::to_string(400 + 7 * ((row * (i + 3)) % 40)) + (i < 4 ? "," : "\n");
  }
  const fs::path file = Write("five.csv", text);
  const nlohmann::json found = Inspect(file, {"--rate", "123", "--preset", "lucidgloves"});
  EXPECT_EQ(found["rate_hz"], 123.0);
  EXPECT_THAT(found["columns"][0]["why"].get<std::string>(), HasSubstr("lucidgloves"));
  EXPECT_EQ(found["columns"][4]["channel"], "little_pip");
  const ProgramResult unknown = Gauntlet({"inspect", file.string(), "--preset", "mitten"});
  EXPECT_EQ(unknown.exit_code, 2);
}

TEST_F(InspectCommand, TakesAnArrayOfSeveral) {
  nlohmann::json json;
  for (int row = 0; row < 300; ++row) {
    const double angle = 45.0 + 30.0 * std::sin(0.05 * row);
    json["mocap"]["t"].push_back(0.01 * row);
    json["mocap"]["markers"].push_back({angle, 2.0 * angle, 7.0, 8.0, angle * angle});
    if (row >= 200) continue;
    json["glove"]["t"].push_back(0.015 * row);
    json["glove"]["index_mcp"].push_back(angle);
    json["glove"]["index_pip"].push_back(angle - 20.0);
  }
  const fs::path file = Write("both.json", json.dump());
  EXPECT_THAT(Gauntlet({"inspect", file.string()}).standard_output,
              HasSubstr("\nnot glove_index_mcp (200 x 1)"));
  const auto found = Inspect(file, {"--array", "glove"});
  EXPECT_EQ(found["rows"], 200);
  EXPECT_NEAR(found["rate_hz"].get<double>(), 1.0 / 0.015, 0.1);
  EXPECT_EQ(found["arrays"].size(), 9);
  EXPECT_EQ(std::ranges::count_if(found["arrays"], [](const auto& a) { return a["is_taken"]; }), 3);

  const std::string scenario = (folder_.path() / "s.yaml").string();
  ASSERT_EQ(Gauntlet({"inspect", file.string(), "--array", "glove", "--write-scenario", scenario})
                .exit_code,
            0);
  const ProgramResult run = Gauntlet({"run", scenario, "--controllers", "raw", "--out",
                                      (folder_.path() / "out").string(), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  const ProgramResult wrong = Gauntlet({"run", scenario, "--set", "glove.motion.array=gloves"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.standard_error, HasSubstr("holds no array gloves, but glove_index_mcp (200"));
}

TEST_F(InspectCommand, ListsTheCellsOfACellArray) {
  const fs::path file = folder_.path() / "cells.mat";
  WriteCellMat(file);
  EXPECT_THAT(ErrorOf(file),
              HasSubstr("has 2 recordings in data: data_1 (100 x 2), data_2 (100 x 2); "
                        "--array NAME takes one"));
  EXPECT_EQ(Inspect(file, {"--array", "data_2"})["rows"], 100);
}

TEST_F(InspectCommand, TakesTheJointsOfAFilledInMap) {
  std::string text = "time_s,s1,s2,s3\n";
  for (int row = 0; row < 300; ++row) {
    text += std::to_string(0.01 * row);
    for (int i = 0; i < 3; ++i) {
      text += "," + std::to_string(500 + std::lround(200.0 * std::sin(0.05 * row + i)));
    }
    text += "\n";
  }
  const auto in = [this](const char* name) { return (folder_.path() / name).string(); };
  const std::string file = Write("three.csv", text).string();
  const ProgramResult asks = Gauntlet({"inspect", file, "--write-scenario", in("s.yaml")});
  EXPECT_EQ(asks.exit_code, 2);
  EXPECT_THAT(asks.standard_error, HasSubstr("3 sensors [counts], whose joints are unknown"));
  std::ifstream written(in("s.map.csv"));
  std::string map((std::istreambuf_iterator<char>(written)), {});
  const std::size_t row = map.find("s2,ignore");
  ASSERT_NE(row, std::string::npos) << map;
  map.replace(row, 9, "s2,index_pip");
  const std::string filled = Write("filled.csv", map).string();
  const ProgramResult inspected =
      Gauntlet({"inspect", file, "--map", filled, "--write-scenario", in("s.yaml")});
  EXPECT_EQ(inspected.exit_code, 0) << inspected.standard_error;
  const ProgramResult run =
      Gauntlet({"run", in("s.yaml"), "--controllers", "raw", "--out", in("o")});
  EXPECT_EQ(run.exit_code, 0) << run.standard_error;
  EXPECT_THAT(run.standard_output, HasSubstr("1 of 18 joints"));
  EXPECT_THAT(run.standard_output, HasSubstr("assumed: sign and range of index_pip"));
}

TEST_F(InspectCommand, AnswersInItsFirstLineWithin80Columns) {
  std::string text = "millis,flex1,flex2,flex3,flex4,flex5\n";
  for (int row = 0; row < 300; ++row) {
    text += std::to_string(20 * row);
    for (int i = 0; i < 5; ++i) {
      text +=
          "," + std::to_string(i == 1 ? 3 : 500 + std::lround(200.0 * std::sin(0.05 * row + i)));
    }
    text += "\n";
  }
  const fs::path file = Write("flex.csv", text);
  const std::string brief = Gauntlet({"inspect", file.string()}).standard_output;
  EXPECT_THAT(brief, testing::StartsWith("5 sensors, 50 Hz, counts: 1 dead (index_pip)\n"));
  std::istringstream lines(brief);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("Next: ")) continue;  // a command is not cut
    EXPECT_LE(line.size(), 80U) << line;
  }
  EXPECT_THAT(brief, Not(HasSubstr("flex5, which has as many sensors")));
  EXPECT_THAT(Gauntlet({"inspect", file.string(), "--verbose"}).standard_output,
              HasSubstr("whole numbers from 300 to 700"));
}

TEST_F(InspectCommand, TakesTheRateOfALineBeforeTheTable) {
  std::string rows = "\nindex_mcp,index_pip\n";
  for (int row = 0; row < 100; ++row) {
    const double angle = 45.0 + 30.0 * std::sin(0.1 * row);
    rows += std::to_string(angle) + "," + std::to_string(90.0 - angle) + "\n";
  }
  const nlohmann::json noted = Inspect(Write("noted.csv", "Sampling rate: 120.5 Hz\n" + rows));
  EXPECT_EQ(noted["rate_hz"], 120.5);
  EXPECT_EQ(noted["rate_is_assumed"], false);
  const std::string motive = "Format Version,1.23,Capture Frame Rate,240.0,Export Frame Rate,";
  EXPECT_EQ(Inspect(Write("motive.csv", motive + "240.0\n" + rows))["rate_hz"], 240.0);
  EXPECT_EQ(Inspect(Write("two.csv", motive + "120.0\n" + rows))["rate_is_assumed"], true);
  EXPECT_EQ(Inspect(Write("hz.csv", "Recorded 100 samples at 90 Hz\n" + rows))["rate_hz"], 90.0);
  const nlohmann::json other = Inspect(Write("other.csv", "Serial number: 120\n" + rows));
  EXPECT_EQ(other["rate_hz"], 50.0);
  EXPECT_EQ(other["rate_is_assumed"], true);
}

TEST_F(InspectCommand, StopsAtARateOfNoGlove) {
  std::string text = "time_s,index_mcp\n";
  for (int row = 0; row < 100; ++row) {
    text +=
        std::to_string(1e-6 * row) + "," + std::to_string(45.5 + 30.0 * std::sin(0.1 * row)) + "\n";
  }
  EXPECT_THAT(ErrorOf(Write("fast.csv", text)),
              HasSubstr("rows per second, must be from 1 to 10000"));
}

TEST_F(InspectCommand, RunsATraceOfOurOwn) {
  const auto in = [this](const char* name) { return (folder_.path() / name).string(); };
  std::ofstream(in("s.yaml")) << "question: q\nseed: 1\nglove:\n  motion: {kind: sine, duration_s: "
                                 "2}\ncontrollers:\n  raw: "
                                 "{filter: none}\n";
  ASSERT_EQ(Gauntlet({"run", in("s.yaml"), "--out", in("first")}).exit_code, 0);
  const nlohmann::json found = Inspect(in("first") + "/trace.h5");
  EXPECT_EQ(found["unit"], "rad");
  EXPECT_NEAR(found["rate_hz"].get<double>(), 1000.0, 1.0);
  EXPECT_EQ(std::ranges::count_if(found["columns"],
                                  [](const auto& column) { return column.contains("channel"); }),
            18);
  ASSERT_EQ(Gauntlet({"inspect", in("first") + "/trace.h5", "--write-scenario", in("again.yaml")})
                .exit_code,
            0);
  const ProgramResult run =
      Gauntlet({"run", in("again.yaml"), "--controllers", "raw", "--out", in("second"), "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  const auto scores = nlohmann::json::parse(run.standard_output);
  EXPECT_LT(scores["controllers"][0]["summary"]["tracking_rmse_deg"], 12.0);
}

TEST_F(InspectCommand, DrawsItsSensorsAndLeavesTheRecordingAlone) {
  const GloveFile file = GloveFiles().front();
  const fs::path path = folder_.path() / file.name;
  file.write(path);
  const fs::path picture = folder_.path() / "picture.png";
  const ProgramResult drawn = Gauntlet({"inspect", path.string(), "--plot", picture.string()});
  EXPECT_EQ(drawn.exit_code, 0) << drawn.standard_error;
  std::string bytes(8, '\0');
  std::ifstream(picture, std::ios::binary).read(bytes.data(), 8);
  EXPECT_EQ(bytes, "\x89PNG\r\n\x1a\n");
  const ProgramResult over = Gauntlet({"inspect", path.string(), "--write-map", path.string()});
  EXPECT_EQ(over.exit_code, 2);
  EXPECT_THAT(over.standard_error, HasSubstr("is an input of this command"));
}

}  // namespace
}  // namespace gauntlet::test
