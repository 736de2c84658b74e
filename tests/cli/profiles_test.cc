// Every profile, through whole commands on its example: it is known, and drives the joints of its
// map.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/csv_line.h"
#include "sim/recordings/profile.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::test {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;

std::vector<std::string> ProfileNames() {
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(SourceDir() + "/scenarios/maps")) {
    names.push_back(file.path().stem().string());
  }
  std::ranges::sort(names);
  return names;
}

sim::Profile ProfileOf(const std::string& name) {
  return sim::ReadProfile(SourceDir() + "/scenarios/maps/" + name + ".yaml");
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

/// True if the example, which is text, is not known without --preset.
bool HasOneFact(const sim::ProfileMatch& match) {
  const bool is_text =
      match.format.empty() || std::ranges::any_of(match.format, [](const std::string& format) {
        return format == "text" || format == "json" || format == "echo";
      });
  return !is_text || (match.names.empty() &&
                      (match.format.empty() || match.values.empty() || match.columns.empty() ||
                       match.columns.front() < match.columns.back()));
}

class EveryProfile : public testing::TestWithParam<std::string> {};

TEST_P(EveryProfile, IsKnownByAFileOfItsShape) {
  const sim::Profile profile = ProfileOf(GetParam());
  ASSERT_GE(LinesOf(profile.example).size(), 2U) << "an example has at least two rows";
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "glove.csv") << profile.example;
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = folder.path()});
  };
  std::vector<std::string> inspect = {"inspect", "glove.csv", "--json", "--write-map",
                                      "map.csv", "--rate",    "100"};
  if (HasOneFact(profile.match)) {
    inspect.insert(inspect.end(), {"--preset", GetParam()});
    // Two times and two quaternions stand beside its sensors.
    if (GetParam() == "vmg30") inspect.insert(inspect.end(), {"--columns", "3-25"});
  }
  const ProgramResult looked = run(inspect);
  const auto found = nlohmann::json::parse(looked.standard_output, nullptr, false);
  ASSERT_TRUE(found.is_object()) << looked.standard_error;
  EXPECT_EQ(found["profile"], GetParam()) << looked.standard_error;

  std::set<std::string> of_map, driven;
  for (const std::string& row : LinesOf(profile.map)) {
    const std::string channel(sim::SplitCells(row)[1]);
    if (std::ranges::find(sim::KnownChannels(), channel, &sim::Channel::name) !=
        sim::KnownChannels().end()) {
      of_map.insert(channel);
    }
  }
  std::ifstream map(folder.path() / "map.csv");
  std::stringstream written;
  written << map.rdbuf();
  for (const std::string& row : LinesOf(written.str())) {
    if (row.starts_with('#')) continue;
    const std::string channel(sim::SplitCells(row)[1]);
    if (of_map.contains(channel)) driven.insert(channel);
  }
  EXPECT_EQ(driven, of_map);
}

INSTANTIATE_TEST_SUITE_P(Of, EveryProfile, testing::ValuesIn(ProfileNames()),
                         [](const auto& profile) {
                           std::string name = profile.param;
                           std::erase_if(name, [](char c) { return std::isalnum(c) == 0; });
                           return name;
                         });

TEST(Profiles, StateTheirSource) {
  for (const std::string& name : ProfileNames()) {
    const sim::Profile profile = ProfileOf(name);
    for (const std::string& source : profile.source) {
      EXPECT_TRUE(source.starts_with("https://")) << name << ": " << source;
    }
  }
}

sim::ProfileFacts FactsOf(const std::vector<std::string>& names, double low, double high,
                          bool is_whole, const std::string& format) {
  sim::ProfileFacts facts = {.names = names, .format = format};
  for (const std::string& name : names) facts.columns.push_back({name, low, high, is_whole});
  return facts;
}

TEST(Profiles, NeedTwoFacts) {
  using enum sim::ProfileEvidence;
  sim::Profile named;
  named.match = {.names = {"Thumb 1", "palm_arch"}, .values = {0, 1000}};
  named.map = "column,channel,unit\nthumb_1,thumb_mcp,deg\n";
  EXPECT_EQ(sim::EvidenceFor(named, FactsOf({".palm_arch", ".thumb_1"}, 0, 900, true, "echo")),
            kKnown);
  // Names alone are one fact, and so is a range alone.
  EXPECT_EQ(sim::EvidenceFor(named, FactsOf({"palm_arch", "thumb_1"}, 0, 9000, true, "text")),
            kOtherValues);
  EXPECT_EQ(sim::EvidenceFor(named, FactsOf({"a", "b"}, 0, 900, true, "text")), kOneFact);

  sim::Profile numbered;
  numbered.match = {.columns = {2}, .values = {0, 255}, .whole = true, .format = {"text"}};
  EXPECT_EQ(sim::EvidenceFor(numbered, FactsOf({"a", "b"}, 0, 255, true, "text")), kKnown);
  EXPECT_EQ(sim::EvidenceFor(numbered, FactsOf({"a", "b"}, 0, 256, true, "text")), kNone);
  EXPECT_EQ(sim::EvidenceFor(numbered, FactsOf({"a", "b"}, 0, 255, false, "text")), kNone);
  EXPECT_EQ(sim::EvidenceFor(numbered, FactsOf({"a", "b", "c"}, 0, 255, true, "text")), kNone);
  numbered.match.format.clear();  // number and range of columns are no proof
  EXPECT_EQ(sim::EvidenceFor(numbered, FactsOf({"a", "b"}, 0, 255, true, "text")), kOneFact);
}

/// Evidence for a profile of one joint with these values, in a table of these values.
sim::ProfileEvidence EvidenceOf(const std::vector<double>& values, double low, double high,
                                bool is_whole, double duration_s) {
  sim::Profile profile;
  profile.match = {.names = {"thumb_1", "palm"}, .values = values};
  profile.map = "column,channel,unit\nthumb_1,thumb_mcp,deg\npalm,ignore,\n";
  sim::ProfileFacts facts = FactsOf({"thumb_1"}, low, high, is_whole, "text");
  facts.columns.push_back({"palm", -1e6, 1e6});  // is no joint
  facts.names.emplace_back("palm");
  facts.duration_s = duration_s;
  return sim::EvidenceFor(profile, facts);
}

TEST(Profiles, DoNotHoldForValuesThatMayBeOfAnotherUnit) {
  using enum sim::ProfileEvidence;
  const std::vector<double> degrees = {-180, 180};
  EXPECT_EQ(EvidenceOf(degrees, 2.0, 80.0, false, 1.5), kKnown);
  EXPECT_EQ(EvidenceOf(degrees, -0.2, 1.6, false, 1.5), kOtherValues);
  EXPECT_EQ(EvidenceOf(degrees, -2.0, 6.9, false, 1.5), kOtherValues);
  EXPECT_EQ(EvidenceOf(degrees, 20.0, 190.0, false, 1.5), kOtherValues);
  EXPECT_EQ(EvidenceOf(degrees, -0.2, 1.6, false, 0.5), kKnown) << "too short to tell";
  EXPECT_EQ(EvidenceOf(degrees, 0.0, 4.0, true, 1.5), kKnown) << "whole degrees";
  EXPECT_EQ(EvidenceOf(degrees, 1.6, 1.6, false, 1.5), kKnown) << "nothing moves";
  EXPECT_EQ(EvidenceOf({-1.8, 1.8}, 0.0, 0.3, false, 1.5), kKnown);
  EXPECT_EQ(EvidenceOf({-1.8, 1.8}, 5.0, 80.0, false, 1.5), kOtherValues);
  const std::vector<double> bytes = {0, 255};
  EXPECT_EQ(EvidenceOf(bytes, 5.0, 80.0, false, 1.5), kOtherValues);
  EXPECT_EQ(EvidenceOf(bytes, 5.0, 80.0, true, 1.5), kOtherValues);
  EXPECT_EQ(EvidenceOf(bytes, 60.0, 78.0, true, 1.5), kKnown) << "a fist that hardly moves";
  EXPECT_EQ(EvidenceOf(bytes, 5.0, 120.0, true, 1.5), kKnown);
  EXPECT_EQ(EvidenceOf(bytes, 0.0, 1.0, false, 1.5), kOtherValues);
  const std::vector<double> thousand = {0, 1000};
  EXPECT_EQ(EvidenceOf(thousand, 5.0, 80.0, true, 1.5), kKnown) << "a small motion";
  EXPECT_EQ(EvidenceOf(thousand, 0.0, 3.0, true, 1.5), kKnown) << "a hand at rest";
  EXPECT_EQ(EvidenceOf(thousand, 5.0, 80.0, false, 1.5), kOtherValues);
}

/// 200 rows of 10 ms of a profile's columns; joints move from low to high.
std::string RowsOf(const std::string& names, double low, double high) {
  std::string text = "time_s," + names + "\n";
  const auto columns = std::ranges::count(names, ',') + 1;
  for (int k = 0; k < 200; ++k) {
    text += fmt::format("{:.2f}", 0.01 * k);
    for (int c = 0; c < columns; ++c) {
      const double share = 0.5 - 0.5 * std::cos(0.1 * k + c);
      text += fmt::format(",{:.4f}", low + (high - low) * share);
    }
    text += "\n";
  }
  return text;
}

TEST(Profiles, AskInAnotherUnitWithAFilledInMap) {
  const TemporaryDirectory folder;
  const auto inspect = [&](const std::string& text, std::vector<std::string> options) {
    std::ofstream(folder.path() / "glove.csv") << text;
    options.insert(options.begin(),
                   {GAUNTLET_PROGRAM, "inspect", "glove.csv", "--write-map", "map.csv", "--force"});
    return RunProgram(options, {.working_directory = folder.path()});
  };
  const auto map = [&] {
    std::stringstream written;
    written << std::ifstream(folder.path() / "map.csv").rdbuf();
    return written.str();
  };
  const std::string orca =
      "thumb_mcp,thumb_abd,thumb_pip,thumb_dip,index_abd,index_mcp,index_pip,middle_abd,"
      "middle_mcp,middle_pip,ring_abd,ring_mcp,ring_pip,pinky_abd,pinky_mcp,pinky_pip,wrist";
  ProgramResult asked = inspect(RowsOf(orca, 0.1, 1.2), {});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.standard_error,
              HasSubstr("like orca_v1, but its joints have values from 0.1 to 1.2, where orca_v1 "
                        "has -70 to 130: rad?; --unit deg if they are deg; fill in map.csv"));
  EXPECT_THAT(map(),
              HasSubstr("thumb_mcp,thumb_rotation,rad,1,,,,,joint unit sign range,0.872665"));
  EXPECT_THAT(map(), HasSubstr("\nindex_pip,index_pip,rad,1,,,,,unit,\n"));
  EXPECT_EQ(inspect(RowsOf(orca, 0.1, 1.2), {"--unit", "deg"}).exit_code, 0);
  EXPECT_EQ(inspect(RowsOf(orca, 2.0, 30.0), {}).exit_code, 0);
  // A unit that a person gives is not overruled by the profile.
  asked = inspect(RowsOf(orca, 2.0, 80.0), {"--unit", "percent"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.standard_error,
              HasSubstr("like orca_v1, which has the unit deg and not percent"));
  // The profile that a person names does not hold either.
  EXPECT_EQ(inspect(RowsOf(orca, 0.1, 1.2), {"--preset", "orca_v1"}).exit_code, 2);

  // The map takes the right hand, whatever the person asks for.
  const std::string both =
      "RightFingerIndexMCPStretch,RightFingerIndexPIPStretch,RightFingerMiddleMCPStretch,"
      "RightFingerMiddlePIPStretch,RightFingerRingMCPStretch,RightFingerRingPIPStretch,"
      "RightFingerPinkyMCPStretch,RightFingerPinkyPIPStretch,LeftFingerIndexMCPStretch";
  EXPECT_EQ(inspect(RowsOf(both, 2.0, 60.0), {"--hand", "right"}).exit_code, 0);
  asked = inspect(RowsOf(both, 2.0, 60.0), {"--hand", "left"});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.standard_error,
              HasSubstr("the map of manus_ros2_jointstate takes the right hand"));

  std::string hand =
      "thumb_cmc_pitch,thumb_cmc_yaw,index_mcp_pitch,middle_mcp_pitch,ring_mcp_pitch,"
      "pinky_mcp_pitch,thumb_cmc_roll";
  for (int k = 0; k < 14; ++k) hand += fmt::format(",velocity_{}", k);
  asked = inspect(RowsOf(hand, 2.0, 90.0), {});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.standard_error,
              HasSubstr("like linkerhand_l7, but its joints have values from 2 to 90, where "
                        "linkerhand_l7 has 0 to 255: deg?; --unit counts if they are counts"));
  EXPECT_THAT(map(), HasSubstr("\nindex_mcp_pitch,index_mcp,deg,1,,,,,unit\n"));
  EXPECT_EQ(inspect(RowsOf(hand, 2.0, 250.0), {}).exit_code, 0);
  asked = inspect(RowsOf(hand, 2.0, 900.0), {});
  EXPECT_EQ(asked.exit_code, 2);
  EXPECT_THAT(asked.standard_error, HasSubstr("from 2 to 900, where linkerhand_l7 has 0 to 255;"));
}

TEST(Profiles, OfTheUserAndBesideTheFileGoBeforeOurs) {
  const TemporaryDirectory folder;
  const std::string text =
      "device: mine\nsource: https://example.org\nmatch: {names: [bend_a, bend_b], columns: "
      "2}\nmap: |\n  column,channel,unit,raw_low,raw_high\n  bend_a,index_pip,,900,100\n  "
      "bend_b,middle_pip,,900,100\n";
  std::ofstream(folder.path() / "mine.profile.yaml") << text;
  std::ofstream glove(folder.path() / "glove.csv");
  glove << "time_s,bend_a,bend_b\n";
  for (int k = 0; k < 300; ++k) {
    glove << fmt::format("{:.2f},{},{}\n", 0.01 * k, 500 + std::lround(300 * std::sin(0.05 * k)),
                         500 + std::lround(300 * std::cos(0.05 * k)));
  }
  glove.close();
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), GAUNTLET_PROGRAM);
    return RunProgram(arguments, {.working_directory = folder.path()});
  };
  const ProgramResult beside = run({"inspect", "glove.csv", "--write-map", "map.csv"});
  EXPECT_EQ(beside.exit_code, 0) << beside.standard_error;
  EXPECT_THAT(beside.standard_output, HasSubstr("joints  2 by profile, mine"));
  std::ifstream map(folder.path() / "map.csv");
  std::stringstream written;
  written << map.rdbuf();
  // The direction is that of the profile: 900 is straight.
  EXPECT_THAT(written.str(), HasSubstr("bend_a,index_pip,deg,,900,100,0,100,\n"));
  std::ofstream(folder.path() / "mine.profile.yaml") << "device: mine\nsource: x\nmpa: 1\n";
  const ProgramResult broken = run({"inspect", "glove.csv"});
  EXPECT_EQ(broken.exit_code, 2);
  EXPECT_THAT(broken.standard_error, HasSubstr("mine.profile.yaml:3:1: mpa: unknown key"));
}

}  // namespace
}  // namespace gauntlet::test
