#include "sim/base/manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ManifestTest : public ::testing::Test {
 protected:
  void Put(const fs::path& file, const std::string& text) const { std::ofstream(file) << text; }
  std::string Content(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder() / name).rdbuf();
    return text.str();
  }
  /// A run that leaves the scenario `text`, its scores and a trace.
  void Run(const std::string& text) const {
    OutputFiles files({.folder = folder(), .command = "run"});
    files.Write([&](const fs::path& place) {
      Put(place / "scenario.resolved.yaml", text);
      Put(place / "scores.csv", "scores of " + text);
      Put(place / "trace.h5", "signals of " + text);
    });
    files.Commit();
  }
  std::string ProblemWith(const std::string& name) const {
    try {
      Manifest(folder()).Checked(name);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder())) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }
  fs::path folder() const { return folder_.path(); }

  test::TemporaryDirectory folder_;
};

TEST_F(ManifestTest, FilesOfARunAppearTogetherWithIt) {
  {
    OutputFiles files({.folder = folder(), .command = "run"});
    files.Write([&](const fs::path& place) { Put(place / "scores.csv", "x"); });
    EXPECT_FALSE(fs::exists(folder() / "scores.csv"));
  }
  EXPECT_TRUE(Names().empty());  // not committed: as if it had not been
  Run("one");
  EXPECT_EQ(Names(), (std::vector<std::string>{"manifest.json", "scenario.resolved.yaml",
                                               "scores.csv", "trace.h5"}));
  EXPECT_EQ(Manifest(folder()).Checked("trace.h5"), folder() / "trace.h5");
  EXPECT_EQ(ProblemWith("scores.csv"), "");
}

TEST_F(ManifestTest, TheSameFilesHaveTheSameManifest) {
  Run("one");
  const std::string first = Content("manifest.json");
  Run("two");
  EXPECT_NE(Content("manifest.json"), first);
  Run("one");
  EXPECT_EQ(Content("manifest.json"), first);
}

TEST_F(ManifestTest, AnyOtherByteIsSeen) {
  Run("one");
  const std::string whole = Content("trace.h5");
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    Put(folder() / "trace.h5", damaged);
    EXPECT_THAT(ProblemWith("trace.h5"), HasSubstr("is not as its run wrote it")) << i;
  }
  Put(folder() / "trace.h5", whole.substr(0, whole.size() - 1));
  EXPECT_THAT(ProblemWith("trace.h5"), HasSubstr("is not as its run wrote it"));
  fs::remove(folder() / "trace.h5");
  EXPECT_THAT(ProblemWith("trace.h5"), HasSubstr("no trace.h5 there"));
  EXPECT_EQ(ProblemWith("scores.csv"), "");
}

// FNV-1a of "a" and "foobar" as draft-eastlake-fnv gives them.
TEST_F(ManifestTest, ThatOfAnEarlierVersionIsReadByItsOwnChecksum) {
  const auto manifest = [](const std::string& checksum) {
    return R"({"format": 1, "finished": true, "checksum": ")" + checksum +
           R"(", "files": {"trace.h5": {"bytes": 1, "checksum": "af63dc4c8601ec8c"},)" +
           R"("scores.csv": {"bytes": 6, "checksum": "85944171f73967e8"}}})";
  };
  Put(folder() / "manifest.json", manifest("FNV-1a, 64 bits"));
  Put(folder() / "trace.h5", "a");
  Put(folder() / "scores.csv", "foobar");
  EXPECT_EQ(ProblemWith("trace.h5"), "");
  EXPECT_EQ(ProblemWith("scores.csv"), "");
  Put(folder() / "scores.csv", "foobaz");
  EXPECT_THAT(ProblemWith("scores.csv"), HasSubstr("is not as its run wrote it"));
  Put(folder() / "manifest.json", manifest("of tomorrow"));
  EXPECT_THAT(ProblemWith("trace.h5"), HasSubstr("manifest.json: is of another version"));
  Run("one");
  EXPECT_THAT(Content("manifest.json"), HasSubstr(R"("checksum": "XXH64")"));
}

TEST_F(ManifestTest, AFolderThatWasLeftBetweenTwoRenamesIsRefusedUntilTheNextRun) {
  Run("one");
  fs::remove(folder() / "scores.csv");
  fs::create_directories(folder() / "scores.csv" / "in_the_way");  // the second rename fails
  EXPECT_THROW(Run("two"), RunError);
  EXPECT_EQ(Content("scenario.resolved.yaml"), "two");
  EXPECT_EQ(Content("trace.h5"), "signals of one");
  EXPECT_THAT(
      ProblemWith("trace.h5"),
      HasSubstr("holds parts of two runs: one was stopped while it wrote its files; run the "
                "same command again"));
  fs::remove_all(folder() / "scores.csv");
  Run("two");
  EXPECT_EQ(ProblemWith("trace.h5"), "");
  EXPECT_EQ(Content("trace.h5"), "signals of two");
}

TEST_F(ManifestTest, WhatIsNotSurelyOfTheSameScenarioGoesAway) {
  const auto leave = [this] {
    for (const char* name : {"comparison.mp4", "trace.raw.csv", "raw.robot.yaml", "notes.txt"}) {
      Put(folder() / name, "left");
    }
  };
  Run("one");
  leave();
  Run("one");
  EXPECT_EQ(Names().size(), 8u);
  Put(folder() / "scenario.resolved.yaml", "two");  // changed by hand: the video is not of that
  Run("two");
  EXPECT_EQ(Names(),
            (std::vector<std::string>{"manifest.json", "notes.txt", "scenario.resolved.yaml",
                                      "scores.csv", "trace.h5"}));
  leave();
  Put(folder() / "manifest.json", R"({"format": 1, "finished": false})");
  Run("two");
  EXPECT_FALSE(fs::exists(folder() / "trace.raw.csv"));
}

TEST_F(ManifestTest, WithoutOneNothingIsCheckedAndADamagedOneIsRefused) {
  Run("one");
  Put(folder() / "scores.csv", "by hand");
  for (const char* text : {"", "{", "{}", "[]", "null", R"({"format": 2, "finished": true})",
                           R"({"format": 1, "finished": true, "files": {"trace.h5": 3}})"}) {
    Put(folder() / "manifest.json", text);
    EXPECT_THAT(ProblemWith("scores.csv"), HasSubstr("manifest.json: is ")) << text;
  }
  fs::remove(folder() / "manifest.json");
  EXPECT_FALSE(Manifest(folder()).exists());
  EXPECT_EQ(ProblemWith("scores.csv"), "");
  EXPECT_THAT(ProblemWith("scores.json"), HasSubstr("no scores.json there"));
}

TEST_F(ManifestTest, ASignalHandlerCanRemoveWhatIsNotCommitted) {
  OutputFiles files({.folder = folder()});
  files.Write([](const fs::path& place) {
    for (int i = 0; i < 200; ++i) std::ofstream(place / std::to_string(i)) << "x";
  });
  RemoveUncommittedFiles();
  EXPECT_TRUE(Names().empty());
}

TEST_F(ManifestTest, FilesOfAnEarlierRunThatTheNextHasNotGoAwayUnlessTheyWereChanged) {
  const auto tune = [this](const std::vector<std::string>& names) {
    OutputFiles files({.folder = folder(), .command = "tune"});
    files.Write([&](const fs::path& place) {
      for (const std::string& name : names) Put(place / name, "of " + name);
    });
    files.Commit();
  };
  tune({"kalman.yaml", "median.yaml", "tune.csv"});
  Put(folder() / "median.yaml", "edited");
  tune({"tune.csv"});
  EXPECT_EQ(Names(), (std::vector<std::string>{"manifest.json", "median.yaml", "tune.csv"}));
}

TEST_F(ManifestTest, AnotherCommandsResultsStay) {
  Run("one");
  const auto tune = [this] { OutputFiles files({.folder = folder(), .command = "tune"}); };
  EXPECT_THROW(tune(), UserError);
  try {
    tune();
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("holds results of gauntlet run, which stay"));
  }
}

TEST_F(ManifestTest, AnotherProgramsManifestStays) {
  const std::string foreign = R"({"name": "a page", "icons": []})";
  Put(folder() / "manifest.json", foreign);
  EXPECT_THROW(Run("one"), UserError);
  EXPECT_EQ(Content("manifest.json"), foreign);
  EXPECT_EQ(Names().size(), 1u);
}

TEST_F(ManifestTest, AnInputIsReplacedOnlyWhereTheManifestNamesIt) {
  Put(folder() / "scenario.resolved.yaml", "mine");
  InputFile(folder() / "scenario.resolved.yaml");
  EXPECT_THROW(Run("one"), UserError);
  EXPECT_EQ(Content("scenario.resolved.yaml"), "mine");
  EXPECT_EQ(Names().size(), 1u);
  fs::remove(folder() / "scenario.resolved.yaml");
  Run("one");
  InputFile(folder() / "scenario.resolved.yaml");
  Run("two");  // a repeated run
  EXPECT_EQ(Content("scenario.resolved.yaml"), "two");
}

TEST_F(ManifestTest, AnInputIsNoLeftover) {
  Run("one");
  Put(folder() / "trace.mine.csv", "a recording");
  InputFile(folder() / "trace.mine.csv");
  Run("two");
  EXPECT_EQ(Content("trace.mine.csv"), "a recording");
}

TEST_F(ManifestTest, APlannedResultIsCheckedBeforeTheWork) {
  Put(folder() / "kalman.yaml", "mine");
  const auto plan = [this](bool force) {
    OutputFiles files({.folder = folder(),
                       .results = {"kalman.yaml"},
                       .editable = {"kalman.yaml"},
                       .force = force});
  };
  EXPECT_THROW(plan(false), UserError);
  EXPECT_NO_THROW(plan(true));
  Put(folder() / "kalman.yaml", WithChecksum("filter: kalman\n"));
  EXPECT_NO_THROW(plan(false));
}

}  // namespace
}  // namespace gauntlet::sim
