// What a text may hold, and how it is shown on one line.
#include "sim/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gauntlet::sim {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(FirstBadByte, IsNoneInUtf8AndTheFirstOneElse) {
  EXPECT_EQ(FirstBadByte(""), std::nullopt);
  EXPECT_EQ(FirstBadByte("caf\u00e9 \u20ac \U0001f590"), std::nullopt);
  EXPECT_EQ(FirstBadByte("caf\xe9"), 3u);
  EXPECT_EQ(FirstBadByte("\xc3"), 0u);              // the rest of the character is missing
  EXPECT_EQ(FirstBadByte("a\x80"), 1u);             // the rest of a character without its beginning
  EXPECT_EQ(FirstBadByte("\xc0\xaf"), 0u);          // a slash in two bytes
  EXPECT_EQ(FirstBadByte("\xe0\x80\xaf"), 0u);      // and in three
  EXPECT_EQ(FirstBadByte("\xed\xa0\x80"), 0u);      // half of a pair
  EXPECT_EQ(FirstBadByte("\xf4\x90\x80\x80"), 0u);  // beyond the last character
}

TEST(OneLine, LeavesPrintableTextAlone) {
  EXPECT_EQ(OneLine("scenarios/t\u00fcr.yaml:3:5: is \"5\", 90 \u00b0 at most"),
            "scenarios/t\u00fcr.yaml:3:5: is \"5\", 90 \u00b0 at most");
}

TEST(OneLine, EscapesWhatIsNotPrintable) {
  EXPECT_EQ(OneLine("a\nb\tc\rd"), "a\\nb\\tc\\x0dd");
  EXPECT_EQ(OneLine("t\xfcr"), "t\\xfcr");
  EXPECT_EQ(OneLine(std::string("\x1b[31m\0\x7f", 7)), "\\x1b[31m\\x00\\x7f");
  EXPECT_EQ(OneLine("\u0085\u009b2J"), "\\xc2\\x85\\xc2\\x9b2J");  // a control character of 8 bits
  EXPECT_EQ(OneLine("a\u202eb\u2028c"), "a\\xe2\\x80\\xaeb\\xe2\\x80\\xa8c");
}

TEST(OneLine, KeepsBothEndsOfALongText) {
  const std::string text = "file.yaml:1:2: " + std::string(1000, 'x') + ", must be from 1 to 8";
  const std::string line = OneLine(text);
  EXPECT_EQ(line.size(), 300u);
  EXPECT_THAT(line, StartsWith("file.yaml:1:2: x"));
  EXPECT_THAT(line, HasSubstr("x...x"));
  EXPECT_THAT(line, EndsWith("x, must be from 1 to 8"));
  EXPECT_EQ(OneLine(std::string(300, 'y')), std::string(300, 'y'));
}

TEST(OneLine, NeverCutsACharacterNorAnEscape) {
  for (std::size_t offset = 0; offset < 4; ++offset) {
    std::string characters(offset, 'x');
    for (int i = 0; i < 5000; ++i) characters += "\U0001f590";
    EXPECT_EQ(FirstBadByte(OneLine(characters)), std::nullopt);
    EXPECT_LE(OneLine(characters).size(), 300u);
    std::string escapes = OneLine(std::string(offset, 'x') + std::string(1'000'000, '\xff'));
    EXPECT_LE(escapes.size(), 300u);
    escapes.erase(0, offset);
    for (std::size_t at; (at = escapes.find("\\xff")) != std::string::npos;) escapes.erase(at, 4);
    EXPECT_EQ(escapes, "...");
  }
}

TEST(TextProblem, IsOfBytesAndControlCharacters) {
  EXPECT_EQ(TextProblem("two lines\nand a \t caf\u00e9"), "");
  EXPECT_EQ(TextProblem("caf\xe9"), "has the byte \\xe9, which is not UTF-8");
  EXPECT_EQ(TextProblem("\x1b[2J"), "has the control character \\x1b");
  EXPECT_EQ(TextProblem(std::string("a\0b", 3)), "has the control character \\x00");
}

TEST(NameProblem, IsThatOfAFilesName) {
  for (const char* good : {"door_opening", "T\u00fcr \u00f6ffnen", "a.b", "x,y", "-", "1"}) {
    EXPECT_EQ(NameProblem(good), "") << good;
  }
  EXPECT_THAT(NameProblem(""), HasSubstr("is empty"));
  for (const char* bad : {"a/b", "/", "../../x", "a\\b", "a\nb", "a\tb"}) {
    EXPECT_THAT(NameProblem(bad), HasSubstr("has a slash")) << bad;
  }
  for (const char* bad : {".", "..", ".hidden"}) {
    EXPECT_THAT(NameProblem(bad), HasSubstr("begins with a dot")) << bad;
  }
  for (const char* bad : {" ", " a", "a "}) {
    EXPECT_THAT(NameProblem(bad), HasSubstr("has a blank at an end")) << bad;
  }
  std::string longest;
  for (int i = 0; i < 60; ++i) longest += "\U0001f590";
  EXPECT_EQ(NameProblem(longest), "");  // 240 bytes, as many as a file's name can have and more
  EXPECT_EQ(NameProblem(longest + "x"), "has 61 characters, a name has at most 60");
  EXPECT_THAT(NameProblem("\xff"), HasSubstr("not UTF-8"));
  EXPECT_THAT(NameProblem("a\x1b"), HasSubstr("control character"));
}

}  // namespace
}  // namespace gauntlet::sim
