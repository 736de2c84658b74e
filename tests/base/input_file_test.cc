#include "sim/base/input_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "sim/base/error.h"
#include "tests/support/program.h"
#include "tests/support/source_dir.h"

namespace gauntlet::sim {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;

class InputFileTest : public testing::Test {
 protected:
  InputFileTest() { std::ofstream(In("file")) << "text"; }
  ~InputFileTest() override { ReadOnlyInside("/"); }  // no limit for other tests
  fs::path In(const std::string& name) const { return folder_.path() / name; }
  static std::string Problem(const fs::path& file) {
    try {
      InputFile(file);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryDirectory folder_;
};

TEST_F(InputFileTest, IsARegularFile) {
  EXPECT_EQ(Problem(In("file")), "");
  EXPECT_EQ(Problem(""), "'': no such file");
  EXPECT_THAT(Problem(In("none")), EndsWith("/none: no such file"));
  EXPECT_THAT(Problem(In("file") / "below"), EndsWith("/below: no such file"));
  EXPECT_THAT(Problem(folder_.path()), EndsWith(": is a folder, must be a regular file"));
  EXPECT_EQ(Problem("/dev/zero"), "/dev/zero: is a device, must be a regular file");
  ASSERT_EQ(mkfifo(In("pipe").c_str(), 0600), 0);
  EXPECT_THAT(Problem(In("pipe")), EndsWith("/pipe: is a pipe, must be a regular file"));
  fs::create_symlink("pipe", In("link"));
  EXPECT_THAT(Problem(In("link")), EndsWith("/link: is a pipe, must be a regular file"));
}

TEST_F(InputFileTest, IsRememberedUnderEveryName) {
  fs::create_symlink("file", In("link"));
  fs::create_hard_link(In("file"), In("second_name"));
  std::ofstream(In("copy")) << "text";
  for (const char* name : {"file", "link", "second_name"}) EXPECT_FALSE(IsInput(In(name))) << name;
  InputFile(In("link"));
  for (const char* name : {"file", "link", "second_name"}) EXPECT_TRUE(IsInput(In(name))) << name;
  EXPECT_FALSE(IsInput(In("copy")));
  EXPECT_FALSE(IsInput(In("none")));
}

TEST_F(InputFileTest, StaysInsideTheFolderWhateverItsName) {
  fs::create_directories(In("jail/below"));
  std::ofstream(In("jail/file")) << "text";
  fs::create_symlink("../file", In("jail/out"));
  fs::create_directory_symlink(folder_.path(), In("jail/up"));
  fs::create_directory_symlink(In("jail"), In("jail_too"));
  std::ofstream(In("jailbird")) << "text";
  ReadOnlyInside(In("jail_too"));
  for (const char* name :
       {"jail/file", "jail/below/../file", "jail_too/file", "jail/up/jail/file"}) {
    EXPECT_EQ(Problem(In(name)), "") << name;
  }
  for (const char* name : {"file", "jail/out", "jail/../file", "jail/up/file", "jailbird",
                           "jail/below/../../file", "jail/../none"}) {
    EXPECT_THAT(Problem(In(name)), HasSubstr(": lies outside --inside ")) << name;
  }
  EXPECT_THAT(Problem("/etc/passwd"), HasSubstr("/etc/passwd: lies outside --inside "));
  EXPECT_THAT(Problem(In("jail/none")), EndsWith("no such file"));
  EXPECT_EQ(Problem(SourceDir() + "/scenarios/door_opening.yaml"), "");  // Gauntlet's own
  EXPECT_THROW(ReadOnlyInside(In("none")), UserError);
  EXPECT_THROW(ReadOnlyInside(In("file")), UserError);
}

}  // namespace
}  // namespace gauntlet::sim
