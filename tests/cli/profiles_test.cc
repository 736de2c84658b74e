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
  EXPECT_EQ(sim::EvidenceFor(named, FactsOf({".palm_arch", ".thumb_1"}, 0, 900, true, "echo")),
            kKnown);
  // Names alone are one fact, and so is a range alone.
  EXPECT_EQ(sim::EvidenceFor(named, FactsOf({"palm_arch", "thumb_1"}, 0, 9000, true, "text")),
            kOneFact);
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
