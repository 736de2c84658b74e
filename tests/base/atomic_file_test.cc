#include "sim/base/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class AtomicFileTest : public ::testing::Test {
 protected:
  AtomicFileTest() { fs::create_directories(folder_); }
  ~AtomicFileTest() override { fs::remove_all(folder_); }
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

TEST_F(AtomicFileTest, AppearsOnlyWhenItIsWhole) {
  const fs::path target = folder_ / "scores.json";
  AtomicFile file(target);
  std::ofstream(file.temporary_path()) << "whole";
  EXPECT_FALSE(fs::exists(target));
  EXPECT_EQ(file.temporary_path().parent_path(), folder_);  // a rename must not cross disks
  file.Commit();
  EXPECT_EQ(Content(target), "whole");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(AtomicFileTest, LeavesTheOldFileAloneUntilCommitted) {
  const fs::path target = folder_ / "scores.json";
  WriteFileAtomically(target, "old");
  {
    AtomicFile file(target);
    std::ofstream(file.temporary_path()) << "half of the n";
  }
  EXPECT_EQ(Content(target), "old");
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(AtomicFileTest, RemovesWhatIsNotCommittedWhenAsked) {
  AtomicFile file(folder_ / "a");
  std::ofstream(file.temporary_path()) << "x";
  WriteFileAtomically(folder_ / "b", "kept");
  RemoveUncommittedFiles();
  EXPECT_EQ(FileCount(), 1);
  EXPECT_EQ(Content(folder_ / "b"), "kept");
}

TEST_F(AtomicFileTest, KeepsEveryByte) {
  std::string content(1 << 20, '\0');
  for (std::size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(i * 31 >> 3);
  WriteFileAtomically(folder_ / "bytes", content);
  EXPECT_EQ(Content(folder_ / "bytes"), content);
}

TEST_F(AtomicFileTest, SaysWhatTheSystemDidNotAllow) {
  try {
    WriteFileAtomically(folder_ / "missing" / "file", "x");
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("missing/file: cannot write: No such file or directory"));
  }
  WriteFileAtomically(folder_ / "file", "x");
  EXPECT_THROW(MakeDirectory(folder_ / "file" / "below"), RunError);
  // A folder stands where the file should be.
  MakeDirectory(folder_ / "folder" / "below");
  EXPECT_THROW(WriteFileAtomically(folder_ / "folder", "x"), RunError);
  EXPECT_EQ(FileCount(), 1);
}

TEST_F(AtomicFileTest, CannotCommitWhatWasNotWritten) {
  AtomicFile file(folder_ / "never written");
  EXPECT_THROW(file.Commit(), RunError);
}

}  // namespace
}  // namespace gauntlet::sim
