// Every preset of a glove, as the map of a scenario that runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> Presets() {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(SourceDir() + "/scenarios/maps")) {
    names.push_back(file.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

/// The rows of a preset, by the names in its header.
std::vector<std::map<std::string, std::string>> RowsOf(const std::string& preset) {
  std::ifstream file(SourceDir() + "/scenarios/maps/" + preset + ".csv");
  std::vector<std::string> keys;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    const std::vector<std::string_view> cells = sim::SplitCells(line);
    if (keys.empty()) {
      keys.assign(cells.begin(), cells.end());
      continue;
    }
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i) row[keys[i]] = cells[i];
  }
  return rows;
}

constexpr double kRate_hz = 60.0;
constexpr double kAmplitude = 0.25;  // of the joint's range, around its middle

/// What the column of a row says when its joint is at this share of its range.
double ValueAt(const std::map<std::string, std::string>& row, double share) {
  const auto text = [&row](const char* key) {
    const auto found = row.find(key);
    return found == row.end() ? std::string() : found->second;
  };
  if (text("channel") == "ignore") return 1.0;
  if (!text("raw_low").empty()) {
    const double low = std::stod(text("raw_low"));
    return low + share * (std::stod(text("raw_high")) - low);
  }
  if (text("unit") == "counts") {
    return (0.1 + 0.8 * share) * (std::ldexp(1.0, std::stoi(text("bits"))) - 1.0);
  }
  const sim::Channel& joint =
      sim::KnownChannels()[static_cast<std::size_t>(sim::ChannelIndex(text("channel")))];
  return joint.min_deg + share * (joint.max_deg - joint.min_deg);
}

class EveryPreset : public testing::TestWithParam<std::string> {};

TEST_P(EveryPreset, RunsAsTheMapOfAScenario) {
  const TemporaryDirectory folder;
  const auto rows = RowsOf(GetParam());
  std::set<std::string> joints;
  for (const auto& row : rows) {
    const std::string& joint = row.at("channel");
    // A glove has no end joints unless glove.channels names them.
    if (joint != "ignore" && !joint.ends_with("_dip")) joints.insert(joint);
  }
  std::ofstream glove(folder.path() / "glove.csv");
  for (int k = 0; k < 2.5 * kRate_hz; ++k) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double share = 0.5 + kAmplitude * std::sin(3.0 * k / kRate_hz + 0.3 * i);
      glove << (i > 0 ? "," : "") << ValueAt(rows[i], share);
    }
    glove << "\n";
  }
  glove.close();
  std::ofstream(folder.path() / "s.yaml")
      << "question: Does it run?\nseed: 1\nglove:\n  motion: {kind: recording, file: glove.csv, "
         "map: "
      << GetParam() << ", file_rate_hz: " << kRate_hz
      << ", use: measured}\n  noise: {kind: none}\ncontrollers:\n  raw: {filter: none}\n";
  const ProgramResult run =
      RunProgram({GAUNTLET_PROGRAM, "run", "s.yaml", "--json", "--out", "out"},
                 {.working_directory = folder.path()});
  ASSERT_EQ(run.exit_code, 0) << run.standard_error;
  const auto scores = nlohmann::json::parse(run.standard_output);
  const auto& controller = scores["controllers"][0];
  // Every joint of the preset is scored, and followed: one that stood still would be off by what
  // it moves, 18 % of its range.
  EXPECT_LT(controller["summary"]["tracking_rmse_deg"], 9.0);
  for (const auto& channel : controller["channels"].items()) joints.erase(channel.key());
  EXPECT_TRUE(joints.empty()) << *joints.begin();
}

INSTANTIATE_TEST_SUITE_P(Gloves, EveryPreset, testing::ValuesIn(Presets()),
                         [](const auto& preset) { return "Of" + preset.param; });

TEST(GlovePresets, AreThoseOfTheReadme) {
  EXPECT_THAT(Presets(), testing::ElementsAre("5dt14", "5dt5", "cyberglove18", "cyberglove22",
                                              "flex5", "lucidgloves", "manus20", "vmg30"));
}

}  // namespace
}  // namespace gauntlet::test
