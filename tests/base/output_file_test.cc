#include "sim/base/output_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "sim/base/error.h"
#include "sim/base/input_file.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class OutputFileTest : public ::testing::Test {
 protected:
  OutputFileTest() { fs::create_directories(folder_); }
  ~OutputFileTest() override { fs::remove_all(folder_); }
  std::string Content(const fs::path& path) {
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  int FileCount() {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) count += entry.is_regular_file();
    return count;
  }
  fs::path folder_ =
      fs::path(::testing::TempDir()) /
      ("atomic_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(OutputFileTest, AppearsOnlyWhenItIsWhole) {
  const fs::path target = folder_ / "scores.json";
  OutputFile file(target);
  std::ofstream(file.temporary_path()) << "whole";
  EXPECT_FALSE(fs::exists(target));
  file.Commit();
  EXPECT_EQ(Content(target), "whole");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(OutputFileTest, LeavesTheOldFileAloneUntilCommitted) {
  const fs::path target = folder_ / "scores.json";
  WriteOutputFile(target, "old");
  {
    OutputFile file(target);
    std::ofstream(file.temporary_path()) << "half of the n";
  }
  EXPECT_EQ(Content(target), "old");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(OutputFileTest, RemovesWhatIsNotCommittedWhenAsked) {
  OutputFile file(folder_ / "a");
  std::ofstream(file.temporary_path()) << "x";
  WriteOutputFile(folder_ / "b", "kept");
  RemoveUncommittedFiles();
  EXPECT_EQ(FileCount(), 1);
  EXPECT_EQ(Content(folder_ / "b"), "kept");
}

TEST_F(OutputFileTest, KeepsEveryByte) {
  std::string content(1 << 20, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(i * 31 >> 3);
  WriteOutputFile(folder_ / "bytes", content);
  EXPECT_EQ(Content(folder_ / "bytes"), content);
}

TEST_F(OutputFileTest, SaysWhatTheSystemDidNotAllow) {
  try {
    WriteOutputFile(folder_ / "missing" / "file", "x");
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing/file: cannot write: No such file or directory"));
  }
  WriteOutputFile(folder_ / "file", "x");
  EXPECT_THROW(MakeDirectory(folder_ / "file" / "below"), RunError);
  // A folder stands where the file should be.
  MakeDirectory(folder_ / "folder" / "below");
  EXPECT_THROW(WriteOutputFile(folder_ / "folder", "x"), RunError);
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(OutputFileTest, TakesTheLongestNameThereIs) {
  const std::string name(255, 'x');
  WriteOutputFile(folder_ / name, "whole");
  EXPECT_EQ(Content(folder_ / name), "whole");
}

// Names as earlier versions made them, and links that wait under them.
TEST_F(OutputFileTest, FollowsNoLinkOfTheFolder) {
  const fs::path victim = folder_ / "victim";
  std::ofstream(victim) << "mine";
  const fs::path theirs = folder_ / "theirs";
  fs::create_directories(theirs);
  fs::create_symlink(victim, theirs / "page.html");
  fs::create_symlink(victim, theirs / fmt::format(".page.html.{}.part", getpid()));
  fs::create_directory_symlink(folder_, theirs / fmt::format(".results.{}.part", getpid()));
  WriteOutputFile(theirs / "page.html", "theirs");
  EXPECT_FALSE(fs::is_symlink(theirs / "page.html"));
  EXPECT_EQ(Content(theirs / "page.html"), "theirs");
  StagingFolder staging(theirs);
  std::ofstream(staging.path() / "victim") << "theirs";
  staging.MoveUp();
  EXPECT_EQ(Content(theirs / "victim"), "theirs");
  EXPECT_EQ(Content(victim), "mine");
}

TEST_F(OutputFileTest, TemporaryNamesAreNeverTheSame) {
  std::set<std::string> names;
  for (int i = 0; i < 20; ++i) {
    const OutputFile file(folder_ / "a");
    for (const auto& entry : fs::directory_iterator(folder_)) names.insert(entry.path().filename());
  }
  EXPECT_EQ(names.size(), 20u);
}

TEST_F(OutputFileTest, WhatAKilledProgramLeftGoesAwayAndALivingOneKeepsItsOwn) {
  const std::string random = ".0123456789abcdef.part";
  std::ofstream(folder_ / (".a.2147480000" + random)) << "no process has this number";
  std::ofstream(folder_ / fmt::format(".a.{}{}", getppid(), random)) << "half";
  WriteOutputFile(folder_ / "a", "whole");
  EXPECT_EQ(FileCount(), 2);
  EXPECT_TRUE(fs::exists(folder_ / fmt::format(".a.{}{}", getppid(), random)));
}

TEST_F(OutputFileTest, NoInputIsReplacedUnderAnyName) {
  const fs::path recording = folder_ / "recording.csv";
  std::ofstream(recording) << "a,b";
  fs::create_symlink("recording.csv", folder_ / "link");
  fs::create_hard_link(recording, folder_ / "second_name");
  WriteOutputFile(recording, "a,b");  // nothing has read it yet
  fs::remove(folder_ / "second_name");
  fs::create_hard_link(recording, folder_ / "second_name");
  InputFile(recording);
  for (const char* name : {"recording.csv", "link", "second_name", "./recording.csv"}) {
    EXPECT_THROW(WriteOutputFile(folder_ / name, "x"), UserError) << name;
  }
  EXPECT_EQ(Content(recording), "a,b");
  EXPECT_EQ(FileCount(), 3);
}

TEST_F(OutputFileTest, AFileThatIsReadWhileAnotherIsWrittenStays) {
  std::ofstream(folder_ / "a") << "mine";
  OutputFile file(folder_ / "a");
  InputFile(folder_ / "a");
  EXPECT_THROW(file.Commit(), UserError);
  EXPECT_EQ(Content(folder_ / "a"), "mine");
}

TEST_F(OutputFileTest, NoResultIsReplaced) {
  for (const char* name : {"trace.h5", "study.db", "other.yaml"}) std::ofstream(folder_ / name);
  std::ofstream(folder_ / "my.manifest.json") << R"({"files": {"trace.h5": {"bytes": 0}}})";
  for (const char* name : {"trace.h5", "study.db", "my.manifest.json"}) {
    EXPECT_THROW(WriteOutputFile(folder_ / name, "x"), UserError) << name;
  }
  EXPECT_NO_THROW(WriteOutputFile(folder_ / "other.yaml", "x"));
}

TEST_F(OutputFileTest, AnEditedFileIsReplacedOnlyByForce) {
  const fs::path map = folder_ / "map.csv";
  WriteEditableFile(map, "column,channel\n1,index_mcp\n", false);
  const std::string whole = Content(map);
  EXPECT_THAT(whole, testing::MatchesRegex("# checksum [0-9a-f]{16}: [^\n]*\ncolumn,channel\n"
                                           "1,index_mcp\n"));
  EXPECT_NO_THROW(WriteEditableFile(map, "column,channel\n2,index_mcp\n", false));
  EXPECT_NO_THROW(WriteEditableFile(map, "column,channel\n1,index_mcp\n", false));
  EXPECT_EQ(Content(map), whole);

  std::string with_carriage_returns = whole;
  with_carriage_returns.insert(whole.size() - 1, "\r");
  for (const std::string& edited :
       {whole + "# mine\n", whole.substr(whole.find('\n') + 1), with_carriage_returns,
        std::string(), "# a comment\n" + whole}) {
    std::ofstream(map, std::ios::trunc) << edited;
    try {
      WriteEditableFile(map, "new", false);
      ADD_FAILURE() << edited;
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr("map.csv: was edited"));
      EXPECT_THAT(error.what(), HasSubstr("--force replaces it"));
    }
    EXPECT_EQ(Content(map), edited);
  }
  WriteEditableFile(map, "new", true);
  EXPECT_THAT(Content(map), HasSubstr("\nnew"));
}

}  // namespace
}  // namespace gauntlet::sim
