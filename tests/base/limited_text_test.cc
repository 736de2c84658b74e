#include "sim/base/limited_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "sim/base/error.h"
#include "sim/base/output_file.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;

class LimitedTextTest : public testing::Test {
 protected:
  LimitedTextTest() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~LimitedTextTest() override { fs::remove_all(folder_); }

  fs::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  static std::string ProblemOf(const fs::path& file, std::size_t most_bytes) {
    try {
      LimitedText(file, most_bytes);
    } catch (const UserError& error) {
      EXPECT_FALSE(LimitedTextIfAny(file, most_bytes));
      return error.what();
    }
    return "none";
  }

  fs::path folder_ =
      fs::path(testing::TempDir()) /
      ("limited_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(LimitedTextTest, HasAllBytesUpToItsLimit) {
  std::string text(100'000, '\0');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * i);
  const fs::path file = Write("text", text);
  EXPECT_EQ(LimitedText(file, text.size()), text);
  EXPECT_EQ(LimitedTextIfAny(file, text.size() + 1), text);
  EXPECT_FALSE(LimitedTextIfAny(file, text.size() - 1));
  EXPECT_EQ(LimitedText(Write("empty", ""), 0), "");
  // A file of the system says that it has no bytes.
  EXPECT_THAT(LimitedText("/proc/self/status", 100'000), testing::HasSubstr("VmRSS"));
  EXPECT_FALSE(LimitedTextIfAny("/proc/self/status", 10));
}

TEST_F(LimitedTextTest, SaysWhyThereIsNone) {
  const fs::path large = Write("large", "x");
  fs::resize_file(large, 3'000'000'000);  // without blocks on the disk
  EXPECT_THAT(ProblemOf(large, 4'000'000),
              EndsWith("large: has more than 4 MB, the limit of such a file"));
  EXPECT_THAT(ProblemOf(folder_ / "none", 9),
              EndsWith("cannot be read: No such file or directory"));
  EXPECT_THAT(ProblemOf(folder_, 9), EndsWith("must be a regular file"));
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(ProblemOf(folder_ / "pipe", 9), EndsWith("must be a regular file"));
}

// Whoever writes beside it would read it into memory.
TEST_F(LimitedTextTest, AHugeManifestBesideIsNone) {
  const std::string mark = R"("p.png": {})";
  const fs::path target = Write("p.png", "old");
  const fs::path manifest = Write("x.manifest.json", mark);
  EXPECT_THROW(WriteOutputFile(target, "new"), UserError);
  fs::resize_file(manifest, kMostManifestBytes + 1);
  EXPECT_NO_THROW(WriteOutputFile(target, "new"));
  fs::resize_file(manifest, kMostManifestBytes);
  EXPECT_THROW(WriteOutputFile(target, "new"), UserError);
}

TEST_F(LimitedTextTest, AHugeFileIsNoneThatPeopleMayEdit) {
  const fs::path target = Write("x.map.csv", WithChecksum("a,b\n"));
  EXPECT_NO_THROW(RefuseEdited(target));
  Write("x.map.csv", WithChecksum(std::string(kMostEditableBytes, '\n')));
  EXPECT_THROW(RefuseEdited(target), UserError);
}

}  // namespace
}  // namespace gauntlet::sim
