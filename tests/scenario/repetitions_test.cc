// A comparison repeats what varies in the world: lists of values below `repetitions` become whole
// gloves, and what could not be compared is refused with its place.
#include "sim/study/scenario/repetitions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/glove/motions/motion_config.h"
#include "sim/study/scenario/scenario.h"
#include "sim/study/scenario/scenario_reader.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class RepetitionsTest : public testing::Test {
 protected:
  std::string Write(const std::string& repetitions, const std::string& glove = "") {
    const std::string file = folder_.path() / "s.yaml";
    std::ofstream(file) << "question: Does it repeat?\nseed: 5\nglove:\n" +
                               (glove.empty() ? "  rate_hz: 500\n" : glove) + repetitions +
                               "controllers:\n  raw:\n    filter: none\n";
    return file;
  }
  Scenario Load(const std::string& repetitions, const std::vector<std::string>& overrides = {},
                const std::string& glove = "") {
    return LoadScenario(Write(repetitions, glove), overrides);
  }
  /// What is said, without the folder.
  std::string Refusal(const std::string& repetitions,
                      const std::vector<std::string>& overrides = {}) {
    try {
      Load(repetitions, overrides);
    } catch (const UserError& error) {
      std::string text = error.what();
      const std::string folder = folder_.path().string() + "/";
      if (const std::size_t at = text.find(folder); at != std::string::npos) {
        text.erase(at, folder.size());
      }
      return text;
    }
    return "nothing";
  }
  static std::vector<double> Scales(const Scenario& scenario, int first_seed, int count) {
    std::vector<double> scales;
    for (int i = 0; i < count; ++i) {
      scales.push_back(GloveOf(scenario, first_seed + i).noise.variance_scale);
    }
    return scales;
  }

  test::TemporaryDirectory folder_;
};

constexpr const char* kScales = "repetitions:\n  glove.noise.variance_scale: [1, 4, 9]\n";

TEST_F(RepetitionsTest, SeedsTakeThemInTurn) {
  const Scenario scenario = Load(kScales);
  EXPECT_EQ(scenario.repetitions.gloves.size(), 3u);
  EXPECT_THAT(Scales(scenario, 5, 7), ElementsAre(1, 4, 9, 1, 4, 9, 1));
  EXPECT_EQ(scenario.glove.noise.variance_scale, 1.0);
  EXPECT_EQ(GloveOf(scenario, 6).rate_hz, 500.0);  // all else is the glove's
}

TEST_F(RepetitionsTest, MayBeTheFilesOfARecordingAListAFolderOrAPattern) {
  std::filesystem::create_directory(folder_.path() / "monday");
  for (const char* name : {"b.csv", "a.csv", "c.txt"}) {
    std::ofstream(folder_.path() / "monday" / name) << "time_s,index_mcp\n0,1\n1,2\n";
  }
  const auto names = [&](const std::string& files, const std::vector<std::string>& sets = {}) {
    const Scenario scenario = Load("", sets, "  motion: {kind: recording, files: " + files + "}\n");
    std::vector<std::string> found;
    for (const GloveConfig& glove : scenario.repetitions.gloves) {
      const std::filesystem::path file = std::get<RecordedMotionConfig>(glove.motion.settings).file;
      EXPECT_EQ(file.parent_path(), folder_.path() / "monday");
      found.push_back(file.filename());
    }
    return found;
  };
  EXPECT_THAT(names("[monday/b.csv, monday/a.csv]"), ElementsAre("b.csv", "a.csv"));
  EXPECT_THAT(names("monday"), ElementsAre("a.csv", "b.csv", "c.txt"));
  EXPECT_THAT(names("monday/*.csv"), ElementsAre("a.csv", "b.csv"));
  EXPECT_THAT(names("monday", {"glove.motion.file=monday/a.csv"}), testing::IsEmpty());
  // What is written is read back.
  const Scenario scenario = Load("", {}, "  motion: {kind: recording, files: monday}\n");
  const Scenario again = ParseScenario({.file = "again.yaml", .text = ScenarioToYaml(scenario)});
  EXPECT_EQ(ScenarioToYaml(again), ScenarioToYaml(scenario));
}

TEST_F(RepetitionsTest, RefuseFilesThatAreNotThereOrAreGivenTwice) {
  const auto refusal = [&](const std::string& motion, const std::string& repetitions = "") {
    try {
      Load(repetitions, {}, "  motion: {kind: recording, " + motion + "}\n");
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  EXPECT_THAT(refusal("files: tuesday"),
              HasSubstr("s.yaml:4:36: glove.motion.files: tuesday: there is no such file"));
  EXPECT_THAT(refusal("file: a.csv, files: [a.csv]"),
              HasSubstr("glove.motion.files: and file cannot both be given"));
  EXPECT_THAT(refusal("files: [a.csv, b.csv]", kScales),
              HasSubstr("has 2 values, glove.noise.variance_scale has 3"));
  EXPECT_THAT(refusal("files: []"), HasSubstr("must be a list of values"));
  EXPECT_THAT(refusal("files: ''"),
              HasSubstr("glove.motion.files: is empty, must be a list of files, a folder or a"));
}

TEST_F(RepetitionsTest, WithoutThemEverySeedHasTheGlove) {
  const Scenario scenario = Load("");
  EXPECT_TRUE(scenario.repetitions.gloves.empty());
  EXPECT_EQ(&GloveOf(scenario, 17), &scenario.glove);
}

TEST_F(RepetitionsTest, ASeedIsTheSameTrialHoweverItIsAskedFor) {
  for (const int seed : {5, 6, 7, 8, 3, 0}) {
    const Scenario scenario = Load(kScales, {"seed=" + std::to_string(seed)});
    const double expected =
        std::vector<double>{1, 4, 9}[static_cast<std::size_t>((seed - 5 + 300) % 3)];
    EXPECT_EQ(scenario.glove.noise.variance_scale, expected) << seed;
    EXPECT_EQ(GloveOf(scenario, seed).noise.variance_scale, expected) << seed;
  }
  const ScenarioSource written_otherwise{
      .file = "s.yaml",
      .text = std::string("question: q\nseed: 5e0\n") + kScales + "controllers: {raw: {}}\n",
      .overrides = {"seed=6"}};
  EXPECT_EQ(ParseScenario(written_otherwise).glove.noise.variance_scale, 4);
}

TEST_F(RepetitionsTest, WhatIsWrittenReadsBackTheSame) {
  for (const char* seed : {"seed=5", "seed=7"}) {
    const Scenario scenario = Load(
        "repetitions:\n"
        "  glove.noise.variance_scale: [1, 4, 9]\n"
        "  glove.motion:\n"
        "    - random\n"
        "    - {kind: bursts, label: 'a: b'}\n"
        "    - {kind: hold, duration_s: 2.5}\n"
        "  glove.faults: [[], [spikes, {kind: stuck, channels: [index_mcp]}], dropouts]\n",
        {seed});
    const std::string text = ScenarioToYaml(scenario);
    const std::string copy = folder_.path() / "copy.yaml";
    std::ofstream(copy) << text;
    const Scenario again = LoadScenario(copy, {});
    EXPECT_EQ(ScenarioToYaml(again), text);
    ASSERT_EQ(again.repetitions.gloves.size(), 3u);
    EXPECT_THAT(Scales(again, again.seed, 3), Scales(scenario, scenario.seed, 3));
    EXPECT_FALSE(SettingValues(scenario).empty());
  }
}

TEST_F(RepetitionsTest, PathsAreRelativeToTheFile) {
  const Scenario scenario = Load("repetitions:\n  glove.motion.file: [a.csv, sub/b.csv]\n", {},
                                 "  motion: {kind: recording}\n");
  const auto file = [&](int i) {
    return std::get<RecordedMotionConfig>(scenario.repetitions.gloves[i].motion.settings).file;
  };
  EXPECT_EQ(file(0), folder_.path() / "a.csv");
  EXPECT_EQ(file(1), folder_.path() / "sub/b.csv");
}

TEST_F(RepetitionsTest, PathsOfASetAreRelativeToTheWorkingFolder) {
  const Scenario scenario = Load("", {"repetitions={glove.motion.file: [a.csv, b.csv]}"},
                                 "  motion: {kind: recording}\n");
  EXPECT_EQ(std::get<RecordedMotionConfig>(scenario.repetitions.gloves[1].motion.settings).file,
            std::filesystem::current_path() / "b.csv");
}

TEST_F(RepetitionsTest, FilesMayComeWithAnyPartOfTheGloveThatIsSet) {
  const std::string motion = "{kind: recording, files: [a.csv, b.csv]}";
  for (const std::string& set : {std::string("glove.motion.files=[a.csv, b.csv]"),
                                 "glove.motion=" + motion, "glove={motion: " + motion + "}"}) {
    const Scenario scenario = Load("repetitions:\n  glove.motion.file: [c.csv, d.csv, e.csv]\n",
                                   {set}, "  motion: {kind: recording}\n");
    ASSERT_EQ(scenario.repetitions.gloves.size(), 2u) << set;
    EXPECT_EQ(std::get<RecordedMotionConfig>(scenario.repetitions.gloves[1].motion.settings).file,
              std::filesystem::current_path() / "b.csv")
        << set;
  }
  const auto both = [&](const std::vector<std::string>& sets) {
    Load("", sets, "  motion: {kind: recording, file: c.csv}\n");
  };
  EXPECT_THROW(both({"glove.motion={kind: recording, file: c.csv, files: [a.csv]}"}), UserError);
  EXPECT_THROW(both({"glove.motion.files=[a.csv]", "glove.motion.file=c.csv"}), UserError);
}

TEST_F(RepetitionsTest, ASetOfTheSettingIsForAllOfThem) {
  Scenario scenario = Load(kScales, {"glove.noise.variance_scale=2"});
  EXPECT_TRUE(scenario.repetitions.gloves.empty());
  EXPECT_EQ(scenario.glove.noise.variance_scale, 2.0);

  scenario = Load(kScales, {"glove.noise={kind: galton}"});
  EXPECT_TRUE(scenario.repetitions.gloves.empty());
  EXPECT_EQ(scenario.glove.noise.kind, WhiteNoiseKind::kGalton);

  scenario = Load(kScales, {"repetitions={}"});
  EXPECT_TRUE(scenario.repetitions.gloves.empty());

  // Below a list: in every repetition.
  scenario = Load(
      "repetitions:\n  glove.motion: [{kind: hold, duration_s: 1}, {kind: random, duration_s: "
      "2}]\n",
      {"glove.motion.duration_s=3"});
  ASSERT_EQ(scenario.repetitions.gloves.size(), 2u);
  EXPECT_EQ(std::get<HoldConfig>(scenario.repetitions.gloves[0].motion.settings).duration_s, 3.0);
  EXPECT_EQ(std::get<RandomMotionConfig>(scenario.repetitions.gloves[1].motion.settings).duration_s,
            3.0);
}

TEST_F(RepetitionsTest, AreReadStrictly) {
  EXPECT_THAT(
      Refusal("repetitions: 3\n"),
      StartsWith("s.yaml:5:14: repetitions: must be settings of the glove, each with a list"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.rate_hz: 100\n"),
              StartsWith("s.yaml:6:18: repetitions.glove.rate_hz: must be a list of values"));
  EXPECT_THAT(
      Refusal("repetitions:\n  glove.tremor.rms_deg: []\n"),
      StartsWith("s.yaml:6:25: repetitions.glove.tremor.rms_deg: must be a list of values"));
  EXPECT_THAT(Refusal("repetitions:\n  hand.step_ms: [1, 0.5]\n"),
              StartsWith("s.yaml:6:3: repetitions.hand.step_ms: must be a setting of the glove"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.motion.kind: [random, bursts]\n"),
              AllOf(StartsWith("s.yaml:6:3: repetitions.glove.motion.kind: cannot be repeated"),
                    HasSubstr("repeat glove.motion")));
  EXPECT_THAT(Refusal("repetitions:\n  glove.tremor.rms_deg: [1, 2, 3]\n"
                      "  glove.noise.variance_scale: [1, 2]\n"),
              StartsWith("s.yaml:7:31: repetitions.glove.noise.variance_scale: has 2 values, "
                         "glove.tremor.rms_deg has 3"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.tremor.rms_deg: [1, 2]\n"
                      "  glove.tremor.rms_deg: [1, 2]\n"),
              StartsWith("s.yaml:7:3: repetitions.glove.tremor.rms_deg: is given twice"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.noise: [galton, none]\n"
                      "  glove.noise.variance_scale: [1, 2]\n"),
              StartsWith("s.yaml:7:3: repetitions.glove.noise.variance_scale: and glove.noise are "
                         "parts of each other"));
  EXPECT_THAT(Refusal(std::string(kScales) + kScales),
              StartsWith("s.yaml:7:1: repetitions: is given twice"));
  EXPECT_THAT(Refusal("repetition:\n  glove.noise.variance_scale: [1, 4]\n"),
              HasSubstr("did you mean repetitions?"));
}

TEST_F(RepetitionsTest, ValuesAreCheckedLikeTheSettingItself) {
  EXPECT_THAT(Refusal("repetitions:\n  glove.noise.variance_scale: [1, 4, -1]\n"),
              StartsWith("s.yaml:6:38: glove.noise.variance_scale: is -1, must be"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.noise.variance_scale: [1, much]\n"),
              StartsWith("s.yaml:6:35: glove.noise.variance_scale: is \"much\", must be a number"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.noise.varianc_scale: [1, 4]\n"),
              AllOf(StartsWith("s.yaml:6:31: glove.noise.varianc_scale: unknown key"),
                    HasSubstr("variance_scale")));
  EXPECT_THAT(Refusal("repetitions:\n  glove.motion: [random, {kind: hold, bandwidth_hz: 1}]\n"),
              StartsWith("s.yaml:6:39: glove.motion.bandwidth_hz: unknown key"));
  EXPECT_THAT(Refusal("", {"repetitions={glove.noise.variance_scale: [1, -4]}"}),
              StartsWith("--set repetitions={glove.noise.variance_scale: [1, -4]}: "
                         "glove.noise.variance_scale: is -4"));
}

TEST_F(RepetitionsTest, ASetCannotChangeOneList) {
  EXPECT_THAT(
      Refusal(kScales, {"repetitions.glove.noise.variance_scale=[1, 2]"}),
      AllOf(StartsWith("--set repetitions.glove.noise.variance_scale=[1, 2]: repetitions: "),
            HasSubstr("--set repetitions={}")));
}

TEST_F(RepetitionsTest, OneControllerServesAllOfThem) {
  EXPECT_THAT(Refusal("repetitions:\n  glove.rate_hz: [100, 100, 60]\n"),
              StartsWith("s.yaml:6:29: repetitions: in replicate 3 glove.rate_hz is 60, in the "
                         "first 100"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.channels: [[index_mcp], [index_pip]]\n"),
              HasSubstr("in replicate 2 glove.channels are others"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.channels: [[index_mcp], [nose]]\n"),
              StartsWith("s.yaml:6:33: glove.channels: unknown channel 'nose'"));
  EXPECT_THAT(Refusal("repetitions:\n  glove.converter.bits: [10, 8]\n"),
              HasSubstr("in replicate 2 glove.converter, glove.sensor or the column map need"));
  // How far a glove is off its nominal self is its own affair.
  EXPECT_EQ(Refusal("repetitions:\n  glove.sensor.gain_deviation_percent: [0, 9]\n"), "nothing");
}

TEST_F(RepetitionsTest, TheControllerIsThatOfTheFirstInTheFile) {
  const auto r = [&](const std::vector<std::string>& overrides) {
    const Scenario scenario = Load("repetitions:\n  glove.noise.variance_counts2: [4, 100]\n", [&] {
      std::vector<std::string> all = {"controllers.raw.filter=kalman",
                                      "glove.channels=[index_mcp, ring_pip]"};
      all.insert(all.end(), overrides.begin(), overrides.end());
      return all;
    }());
    auto settings = scenario.controllers[0].config.filters[0].settings;
    return *std::visit([](auto& kind) { return controller::MeasurementVarianceOf(kind); },
                       settings);
  };
  EXPECT_THAT(r({}), ElementsAre(4.0, 4.0));
  EXPECT_THAT(r({"seed=6"}), ElementsAre(4.0, 4.0));
}

}  // namespace
}  // namespace gauntlet::sim
