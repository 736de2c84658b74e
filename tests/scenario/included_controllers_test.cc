// A controller's settings may come from a file of its own: `!include`, there and nowhere else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/study/scenario/scenario_tree.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using controller::ExponentialConfig;
using testing::AllOf;
using testing::HasSubstr;

class IncludeTest : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    std::ofstream(folder_.path() / name) << text;
  }
  Scenario Load(const std::string& controllers, const std::vector<std::string>& overrides = {},
                const std::string& rest = "") {
    Write("s.yaml", "question: Does it include?\n" + rest + "controllers:\n" + controllers);
    return LoadScenario(folder_.path() / "s.yaml", overrides);
  }
  /// What is said, without the folder.
  std::string Refusal(const std::string& controllers,
                      const std::vector<std::string>& overrides = {},
                      const std::string& rest = "") {
    try {
      Load(controllers, overrides, rest);
    } catch (const UserError& error) {
      std::string text = error.what();
      const std::string folder = folder_.path().string() + "/";
      for (std::size_t at = 0; (at = text.find(folder)) != std::string::npos;) {
        text.erase(at, folder.size());
      }
      return text;
    }
    return "nothing";
  }
  static double AlphaOf(const Scenario& scenario, std::size_t controller) {
    const auto& filter = scenario.controllers[controller].config.filters.front();
    return std::get<ExponentialConfig>(filter.settings).alpha;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(IncludeTest, AFileStandsForAllSettingsOfAController) {
  Write("found/smooth.yaml", "filter: {kind: exponential, alpha: 0.25}\nfilter_at: event\n");
  const Scenario scenario = Load(
      "  raw: {filter: none}\n  one: !include found/smooth.yaml\n  two: &t !include "
      "found/smooth.yaml\n  three: *t\n",
      {"controllers.two.filter.alpha=0.5"});
  EXPECT_EQ(scenario.controllers[1].config.filter_at, controller::FilterAt::kEvent);
  EXPECT_EQ(AlphaOf(scenario, 1), 0.25);
  EXPECT_EQ(AlphaOf(scenario, 2), 0.5);  // --set goes over what is included, and only there
  EXPECT_EQ(AlphaOf(scenario, 3), 0.25);
}

TEST_F(IncludeTest, PathsInAFileAreFromThatFile) {
  Write("found/smooth.yaml", "filter: none\ncalibration: glove.yaml\n");
  EXPECT_THAT(Refusal("  one: !include found/smooth.yaml\n"),
              HasSubstr("found/glove.yaml: no such file"));
}

TEST_F(IncludeTest, AMistakeInAFileHasItsPlaceThere) {
  Write("smooth.yaml", "filter: {kind: exponential,\n         alfa: 0.25}\n");
  EXPECT_THAT(Refusal("  one: !include smooth.yaml\n"),
              AllOf(HasSubstr("smooth.yaml:2:10: controllers.one.filter.alfa: unknown key"),
                    HasSubstr("alpha")));
  EXPECT_THAT(Refusal("  one: !include smooth.yaml\n", {"controllers.one.filter.alfa=nan"}),
              HasSubstr("--set controllers.one.filter.alfa=nan"));
  Write("smooth.yaml", "filter: {kind: exponential, alpha: 2}\n");
  EXPECT_THAT(Refusal("  one: !include smooth.yaml\n"),
              HasSubstr("smooth.yaml:1:36: controllers.one.filter.alpha"));
  Write("smooth.yaml", "- 1\n");
  EXPECT_EQ(Refusal("  one: !include smooth.yaml\n"), "smooth.yaml:1:1: must be a map of keys");
}

TEST_F(IncludeTest, AFileThatCannotBeReadIsOneLine) {
  EXPECT_EQ(Refusal("  one: !include none.yaml\n"),
            "s.yaml:3:8: controllers.one: !include none.yaml: no such file");
  EXPECT_EQ(Refusal("  one: !include .\n"),
            "s.yaml:3:8: controllers.one: !include .: is a folder, must be a regular file");
  EXPECT_EQ(Refusal("  one: !include\n"), "s.yaml:3:8: controllers.one: !include names no file");
  Write("huge.yaml", "filter: " + std::string(4'000'000, 'x'));
  EXPECT_THAT(Refusal("  one: !include huge.yaml\n"),
              HasSubstr("!include huge.yaml: has more than 4 MB"));
}

TEST_F(IncludeTest, AFileIncludesNoOtherSoThatNoneIncludesItself) {
  Write("loop.yaml", "filter: !include loop.yaml\n");
  EXPECT_THAT(Refusal("  one: !include loop.yaml\n"),
              HasSubstr("loop.yaml:1:9: !include stands for all settings of a controller"));
}

TEST_F(IncludeTest, ItStandsNowhereElse) {
  Write("x.yaml", "kind: none\n");
  for (const auto& [controllers, rest, place] :
       {std::tuple{"  one: {filter: !include x.yaml}\n", "", "s.yaml:3:17"},
        std::tuple{"  one: {filter: [none, !include x.yaml]}\n", "", "s.yaml:3:24"},
        std::tuple{"  one: {filter: none}\n", "glove: !include x.yaml\n", "s.yaml:2:8"}}) {
    EXPECT_THAT(Refusal(controllers, {}, rest),
                AllOf(testing::StartsWith(place), HasSubstr("and nowhere else")));
  }
  EXPECT_THAT(Refusal("  one: {filter: none}\n", {"controllers.one=!include x.yaml"}),
              HasSubstr("and nowhere else"));
}

}  // namespace
}  // namespace gauntlet::sim
