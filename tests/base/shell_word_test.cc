#include "sim/base/shell_word.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/program.h"

namespace gauntlet::sim {
namespace {

TEST(ShellWord, LeavesAWordThatNeedsNoQuotes) {
  for (const char* word : {"a.yaml", "../out/run-2/a_b.csv", "/a/b:c", "50%", "1/2", "a,b"}) {
    EXPECT_EQ(ShellWord(word), word);
  }
}

TEST(ShellWord, QuotesWhatAShellWouldChange) {
  EXPECT_EQ(ShellWord("my glove.yaml"), "'my glove.yaml'");
  EXPECT_EQ(ShellWord("it's $(x)"), R"('it'\''s $(x)')");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_EQ(ShellWord("a=[1, 2]"), "'a=[1, 2]'");
  EXPECT_EQ(ShellWord("größe.csv"), "'größe.csv'");
}

TEST(ShellWord, StaysOnOneLineWithControlCharactersAndBytesThatAreNotUtf8) {
  EXPECT_EQ(ShellWord("a\ntouch b"), R"($'a\ntouch b')");
  EXPECT_EQ(ShellWord("a\x1b[2J'\\"), R"($'a\033[2J\'\\')");
  EXPECT_EQ(ShellWord("\xff"
                      "1"),
            R"($'\3771')");
}

TEST(ShellWord, IsToBashTheSameTextAgain) {
  std::string bytes;
  for (int byte = 1; byte < 256; ++byte) bytes += static_cast<char>(byte);
  for (const std::string& text :
       {bytes, std::string("~"), std::string("~root/a"), std::string("a=~"), std::string("{a,b}"),
        std::string("*"), std::string("a#"), std::string("#a"), std::string("!!"),
        std::string("\\"), std::string("-n"), std::string("$HOME `id` $(id) ;&|<>"),
        std::string("it's 100 % $(x)"), std::string("a\n"), std::string("\u202e")}) {
    const test::ProgramResult printed =
        test::RunProgram({"/bin/bash", "-c", "printf %s " + ShellWord(text)});
    EXPECT_EQ(printed.standard_output, text) << ShellWord(text);
  }
}

TEST(ShellWord, OfAPathIsNoOption) {
  EXPECT_EQ(ShellPath("-rf"), "./-rf");
  EXPECT_EQ(ShellPath("-r f"), "'./-r f'");
  EXPECT_EQ(ShellPath("-\n"), R"($'./-\n')");
  EXPECT_EQ(ShellPath("a/-rf"), "a/-rf");
}

}  // namespace
}  // namespace gauntlet::sim
