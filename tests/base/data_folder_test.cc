#include "sim/base/data_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "sim/base/error.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder with one scenario, to which GAUNTLET_DATA_DIR points while the test lasts.
class DataFolderOfVariable : public testing::Test {
 protected:
  DataFolderOfVariable() : root_(fs::canonical(folder_.path())) {
    fs::create_directory(root_ / "scenarios");
    std::ofstream(root_ / "scenarios/mine.yaml") << "question: q\n";
    setenv("GAUNTLET_DATA_DIR", root_.c_str(), 1);
  }
  ~DataFolderOfVariable() override { unsetenv("GAUNTLET_DATA_DIR"); }

  test::TemporaryDirectory folder_;
  fs::path root_;
};

TEST(DataFolder, OfAProgramInTheBuildTreeIsTheProjectsOwn) {
  EXPECT_EQ(DataFolder("models"), fs::canonical(SourceDir()) / "models");
  EXPECT_EQ(DataFolder("scenarios"), fs::canonical(SourceDir()) / "scenarios");
}

TEST(DataFolder, SaysWhereItLookedForWhatIsNotThere) {
  try {
    DataFolder("no_such_thing");
    FAIL() << "found";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no no_such_thing in "));
    EXPECT_THAT(error.what(), HasSubstr("share/gauntlet"));
    EXPECT_THAT(error.what(), HasSubstr("GAUNTLET_DATA_DIR"));
  }
}

TEST_F(DataFolderOfVariable, IsTheOneThatCounts) {
  EXPECT_EQ(DataFolder("scenarios"), root_ / "scenarios");
  try {
    DataFolder("models");
    FAIL() << "found";
  } catch (const UserError& error) {
    EXPECT_EQ(error.place(), "GAUNTLET_DATA_DIR");
    EXPECT_EQ(error.problem(), "no folder " + (root_ / "models").string());
  }
}

TEST_F(DataFolderOfVariable, IsLookedIntoForFilesThatAreNotInTheWorkingFolder) {
  EXPECT_EQ(OwnOrDataFile("scenarios/mine.yaml"), root_ / "scenarios/mine.yaml");
  EXPECT_EQ(OwnOrDataFile("scenarios/yours.yaml"), "scenarios/yours.yaml");
  EXPECT_EQ(OwnOrDataFile("/scenarios/mine.yaml"), "/scenarios/mine.yaml");
  const fs::path before = fs::current_path();
  const test::TemporaryDirectory own;
  fs::create_directory(own.path() / "scenarios");
  std::ofstream(own.path() / "scenarios/mine.yaml") << "question: another\n";
  fs::current_path(own.path());
  EXPECT_EQ(OwnOrDataFile("scenarios/mine.yaml"), "scenarios/mine.yaml");
  fs::current_path(before);
}

TEST_F(DataFolderOfVariable, FilesAreNamedWithoutTheFolder) {
  EXPECT_EQ(DataName(root_ / "scenarios/mine.yaml"), "scenarios/mine.yaml");
  EXPECT_EQ(DataFile("scenarios/mine.yaml"), root_ / "scenarios/mine.yaml");
  EXPECT_EQ(DataName(root_ / "mine.yaml"), "");
  EXPECT_EQ(DataName(root_.parent_path() / "mine.yaml"), "");
  EXPECT_EQ(DataFile("scenarios/yours.yaml"), std::nullopt);
  EXPECT_EQ(DataFile("scenarios/../../mine.yaml"), std::nullopt);
  EXPECT_EQ(DataFile(root_ / "scenarios/mine.yaml"), std::nullopt);
}

}  // namespace
}  // namespace gauntlet::sim
