// Profiles of devices: which facts of a table are evidence for one, and which are against it.
#include "sim/recordings/profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(IsSameName, ComparesLettersAndDigits) {
  EXPECT_TRUE(IsSameName("Index MCP", "index-mcp"));
  EXPECT_TRUE(IsSameName("index_mcp_rad", "IndexMCP"));
  EXPECT_TRUE(IsSameName("IndexMCP", "index_mcp_rad"));
  EXPECT_FALSE(IsSameName("index_mcp", "index_mcp_deg"));
  EXPECT_FALSE(IsSameName("index_mcp1", "index_mcp2"));
}

/// Two joints in degrees; a time and a counter are no joints.
Profile Degrees(std::vector<double> values = {0, 180}) {
  return {.match = {.names = {"a", "b"}, .values = std::move(values)},
          .map = "column,channel\nt,time\na,index_mcp\nb,index_pip\nn,ignore\n",
          .example = "t,a,b,n\n0.5,1.5,2.5,7\n"};
}

ProfileFacts Facts(double low, double high, bool is_whole = false, double duration_s = 10.0) {
  return {.columns = {{"A", low, high, is_whole},
                      {"b", low, low, true},
                      {"t", -1e9, 1e9, false},
                      {"n", -1e9, 1e9, false},
                      {"other", -1e9, 1e9, false}},
          .names = {"t", "a", "B", "n", "other"},
          .format = "text",
          .duration_s = duration_s};
}

TEST(ValuesAgainst, AreBeyondTheRange) {
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(0, 180)));
  const auto high = ValuesAgainst(Degrees(), Facts(0, 180.5));
  ASSERT_TRUE(high);
  EXPECT_EQ(high->low, 0.0);
  EXPECT_EQ(high->high, 180.5);
  EXPECT_FALSE(high->are_bytes);
  EXPECT_TRUE(ValuesAgainst(Degrees(), Facts(-0.5, 180)));
  EXPECT_TRUE(ValuesAgainst(Degrees(), Facts(-0.5, 180, false, 0.1)));  // however short
  ProfileFacts none = Facts(-900, 900);
  none.columns.erase(none.columns.begin(), none.columns.begin() + 2);
  EXPECT_FALSE(ValuesAgainst(Degrees(), none));  // no joint
}

TEST(ValuesAgainst, AreSmallAsInAnotherUnit) {
  EXPECT_TRUE(ValuesAgainst(Degrees(), Facts(0, 6.9)));
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(0, 7.0)));
  EXPECT_TRUE(ValuesAgainst(Degrees({-180, 180}), Facts(-6.9, 0)));
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(0, 6, true)));           // counts at rest
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(3, 3)));                 // without motion
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(0, 6.9, false, 0.99)));  // too short
  EXPECT_TRUE(ValuesAgainst(Degrees(), Facts(0, 6.9, false, 1.0)));
  EXPECT_FALSE(ValuesAgainst(Degrees({0, 7}), Facts(0, 1.5)));  // a profile of radians
  // Bytes and counts in the range of joints.
  for (const double largest : {255.0, 1023.0}) {
    const Profile counts = Degrees({0, largest});
    EXPECT_TRUE(ValuesAgainst(counts, Facts(0, 110)));
    EXPECT_FALSE(ValuesAgainst(counts, Facts(0, 111)));
    EXPECT_TRUE(ValuesAgainst(counts, Facts(50, 70)));
    EXPECT_FALSE(ValuesAgainst(counts, Facts(50, 69.5)));
    EXPECT_EQ(ValuesAgainst(counts, Facts(0, 110, true)).has_value(), largest == 255.0);
  }
  EXPECT_FALSE(ValuesAgainst(Degrees({0, 254}), Facts(0, 110)));
}

TEST(ValuesAgainst, AreBytesUnderTheNamesOfAngles) {
  const auto found = ValuesAgainst(Degrees(), Facts(0, 100, true));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->are_bytes);
  EXPECT_EQ(found->high, 100.0);
  EXPECT_TRUE(ValuesAgainst(Degrees(), Facts(10, 30, true)));
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(10, 29, true)));  // at rest
  EXPECT_FALSE(ValuesAgainst(Degrees(), Facts(0, 100, true, 0.5)));
  EXPECT_FALSE(ValuesAgainst(Degrees({-180, 180}), Facts(-1, 100, true)));
  EXPECT_TRUE(ValuesAgainst(Degrees({0, 200}), Facts(0, 111, true)));
  EXPECT_FALSE(ValuesAgainst(Degrees({0, 201}), Facts(0, 111, true)));
  Profile whole = Degrees();
  whole.example = "t,a,b,n\n0,1,2.5,7.5\n";  // half of the cells have no fraction
  EXPECT_FALSE(ValuesAgainst(whole, Facts(0, 100, true)));
  whole.example = "";
  EXPECT_FALSE(ValuesAgainst(whole, Facts(0, 100, true)));
}

TEST(ValuesAgainst, AreFractionsOfAProfileOfWholeNumbers) {
  Profile whole = Degrees({});
  EXPECT_FALSE(ValuesAgainst(whole, Facts(0, 1e6)));
  whole.match.whole = true;
  EXPECT_TRUE(ValuesAgainst(whole, Facts(0, 1e6)));
  EXPECT_FALSE(ValuesAgainst(whole, Facts(0, 1e6, true)));
}

TEST(EvidenceFor, OfNamesNeedsAnotherFact) {
  using enum ProfileEvidence;
  EXPECT_EQ(EvidenceFor(Degrees(), Facts(0, 90)), kKnown);
  EXPECT_EQ(EvidenceFor(Degrees(), Facts(0, 190)), kOtherValues);
  ProfileFacts other = Facts(0, 90);
  other.names = {"t", "a", "n"};
  EXPECT_EQ(EvidenceFor(Degrees(), other), kOneFact);  // its values fit
  other = Facts(0, 190);
  other.names = {"t", "a", "n"};
  EXPECT_EQ(EvidenceFor(Degrees(), other), kNone);
  EXPECT_EQ(EvidenceFor(Degrees({}), Facts(0, 90)), kOneFact);  // names alone
  Profile more = Degrees();
  more.match.format = {"json", "mat"};
  EXPECT_EQ(EvidenceFor(more, Facts(0, 90)), kOneFact);
  EXPECT_EQ(EvidenceFor(more, Facts(0, 190)), kOneFact);
  more.match.format = {"json", "text"};
  EXPECT_EQ(EvidenceFor(more, Facts(0, 90)), kKnown);
  EXPECT_EQ(EvidenceFor(more, Facts(0, 190)), kOtherValues);
  more.match.columns = {5};
  EXPECT_EQ(EvidenceFor(more, Facts(0, 90)), kKnown);
  more.match.columns = {6};
  EXPECT_EQ(EvidenceFor(more, Facts(0, 90)), kOneFact);
}

TEST(EvidenceFor, WithoutNamesNeedsAllFactsAndOneNumberOfColumns) {
  using enum ProfileEvidence;
  const Profile profile = {.match = {.columns = {2}, .values = {0, 4095}, .format = {"text"}},
                           .map = "column,channel\n1,index_mcp\n2,index_pip\n"};
  const ProfileFacts facts = {.columns = {{"x", 500, 3000, true}, {"y", 500, 3000, true}},
                              .names = {"x", "y"},
                              .format = "text",
                              .duration_s = 10.0};
  EXPECT_EQ(EvidenceFor(profile, facts), kKnown);
  for (const std::vector<double>& columns : {std::vector<double>{1, 2}, {2, 3}}) {
    Profile several = profile;
    several.match.columns = columns;
    EXPECT_EQ(EvidenceFor(several, facts), kOneFact);
  }
  Profile two = profile;
  two.match.format.clear();
  EXPECT_EQ(EvidenceFor(two, facts), kOneFact);
  for (const std::vector<double>& columns : {std::vector<double>{1}, {3}, {3, 4}}) {
    Profile other = profile;
    other.match.columns = columns;
    EXPECT_EQ(EvidenceFor(other, facts), kNone);
  }
  ProfileFacts mat = facts;
  mat.format = "mat";
  EXPECT_EQ(EvidenceFor(profile, mat), kNone);
  ProfileFacts wide = facts;
  wide.columns[1].high = 5000;  // all columns are joints
  EXPECT_EQ(EvidenceFor(profile, wide), kNone);
}

class ProfileFiles : public testing::Test {
 protected:
  ProfileFiles() { setenv("XDG_CONFIG_HOME", folder_.path().c_str(), 1); }
  ~ProfileFiles() override { unsetenv("XDG_CONFIG_HOME"); }
  fs::path Write(const fs::path& file, const std::string& match = "{values: [0, 1]}") const {
    fs::create_directories((folder_.path() / file).parent_path());
    std::ofstream(folder_.path() / file)
        << "device: of mine\nsource: [none]\nmatch: " << match << "\nmap: |\n  column,channel\n";
    return folder_.path() / file;
  }
  static std::string DeviceOf(const std::vector<Profile>& profiles, const std::string& name) {
    for (const Profile& profile : profiles) {
      if (profile.name == name) return profile.device;
    }
    return "";
  }
  test::TemporaryDirectory folder_;
};

TEST_F(ProfileFiles, BesideTheRecordingAndOfTheUserComeFirst) {
  Write("here/mine.profile.yaml");
  Write("here/other.yaml");  // of something else
  const fs::path flex = Write("gauntlet/profiles/flex5.yaml");
  const std::vector<Profile> all = AllProfiles(folder_.path() / "here/log.csv");
  EXPECT_EQ(DeviceOf(all, "mine"), "of mine");
  EXPECT_EQ(DeviceOf(all, "flex5"), "of mine");
  EXPECT_EQ(DeviceOf(all, "other"), "");
  EXPECT_NE(DeviceOf(all, "5dt14"), "");
  EXPECT_TRUE(std::ranges::is_sorted(all, {}, &Profile::name));
  EXPECT_EQ(DeviceOf(AllProfiles(""), "mine"), "");
  EXPECT_EQ(FileOfProfile("flex5"), flex);
  EXPECT_EQ(FileOfProfile("5dt14").filename(), "5dt14.yaml");
  for (const char* name : {"nobody", "", "../profiles/flex5", "maps/5dt14"}) {
    EXPECT_EQ(FileOfProfile(name), "") << name;
  }
}

TEST_F(ProfileFiles, HaveRangesThatRise) {
  for (const char* match : {"{values: [1, 0]}", "{columns: [1, 2, 3]}", "{values: [0, 1, 2]}"}) {
    const fs::path file = Write("a.yaml", match);
    try {
      ReadProfile(file);
      ADD_FAILURE() << match;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr("columns and values are a number, or two that rise"));
    }
  }
  EXPECT_EQ(ReadProfile(Write("a.yaml", "{columns: [3, 3]}")).name, "a");
}

}  // namespace
}  // namespace gauntlet::sim
