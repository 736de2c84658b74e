#include "controller/number.h"

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <limits>
#include <string>

namespace gauntlet::controller {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

struct Accepted {
  const char* text;
  double value;
};

constexpr Accepted kNumbers[] = {
    {"0", 0.0},
    {"-0", -0.0},
    {"7", 7.0},
    {"+7", 7.0},
    {"-7", -7.0},
    {"007", 7.0},
    {"010", 10.0},
    {"2.5", 2.5},
    {"+2.5", 2.5},
    {"2.", 2.0},
    {".5", 0.5},
    {"-.5", -0.5},
    {"+.5", 0.5},
    {"1e3", 1000.0},
    {"1E3", 1000.0},
    {"1e+3", 1000.0},
    {"-2.5e-3", -2.5e-3},
    {"0.1", 0.1},
    {"4.9e-324", 5e-324},
    {"2.2250738585072014e-308", DBL_MIN},
    {"1.7976931348623157e308", DBL_MAX},
    {"9007199254740993", 9007199254740992.0},
};

constexpr const char* kTexts[] = {
    "",
    " ",
    "+",
    "-",
    ".",
    "e",
    "e3",
    "1e",
    "1e+",
    "1.e",
    " 1",
    "1 ",
    "\t1",
    "1\n",
    "1x",
    "1.2.3",
    "1,5",
    "1_000",
    "1'000",
    "1 000",
    "--1",
    "++1",
    "+-1",
    "-+1",
    "0x1",
    "0x1p-4",
    "0X1",
    "1f",
    "1d",
    "0b1",
    "inf",
    "-inf",
    "+inf",
    "INF",
    "nan",
    "-nan",
    "NaN",
    ".inf",
    ".nan",
    "infinity",
    "1e999",
    "-1e999",
    "1e-999",
    "1/2",
    "1e3.5",
    "ten",
    "\xD9\xA1",
    ("\xE2\x88\x92"
     "1"),
    "true",
};

TEST(Number, IsDecimalWithSignPointAndExponent) {
  for (const auto& [text, value] : kNumbers) {
    const auto number = ParseNumber(text);
    ASSERT_TRUE(number) << text;
    EXPECT_EQ(*number, value) << text;
    EXPECT_EQ(std::signbit(*number), std::signbit(value)) << text;
  }
}

TEST(Number, IsNoOtherText) {
  for (const char* const text : kTexts) EXPECT_FALSE(ParseNumber(text)) << '"' << text << '"';
  EXPECT_FALSE(ParseNumber({}));
  EXPECT_FALSE(ParseNumber(std::string_view("1\0", 2)));
}

TEST(Number, EndsWithItsText) { EXPECT_EQ(ParseNumber(std::string_view("1.25", 3)), 1.2); }

TEST(Number, IsWholeByItsValueAndWithinItsRange) {
  EXPECT_EQ(ParseWholeNumber("12", 0, 100), 12);
  EXPECT_EQ(ParseWholeNumber("012", 0, 100), 12);
  EXPECT_EQ(ParseWholeNumber("12.0", 0, 100), 12);
  EXPECT_EQ(ParseWholeNumber("1e2", 0, 100), 100);
  EXPECT_EQ(ParseWholeNumber("-0", 0, 100), 0);
  EXPECT_EQ(ParseWholeNumber("-3", -3, -3), -3);
  EXPECT_EQ(ParseWholeNumber("9007199254740992", 0, std::int64_t{1} << 53), std::int64_t{1} << 53);
  for (const char* const text : {"12.5", "101", "-1", "1e9", "1e300", "-1e300", "1e-9"}) {
    EXPECT_FALSE(ParseWholeNumber(text, 0, 100)) << text;
  }
  EXPECT_FALSE(ParseWholeNumber("0", 1, 0)) << "an empty range";
  for (const char* const text : kTexts) EXPECT_FALSE(ParseWholeNumber(text, -1000, 1000)) << text;
}

TEST(Number, OfAProgramMayBeNoneOrBeyondADouble) {
  for (const auto& [text, value] : kNumbers) EXPECT_EQ(ParseNumberOfProgram(text), value) << text;
  for (const char* const text : {"inf", "INF", "infinity", "+inf", "1e999"}) {
    EXPECT_EQ(ParseNumberOfProgram(text), kInfinite) << text;
  }
  for (const char* const text : {"-inf", "-1e999"}) {
    EXPECT_EQ(ParseNumberOfProgram(text), -kInfinite) << text;
  }
  EXPECT_EQ(ParseNumberOfProgram("1e-999"), 0.0);
  for (const char* const text : {"nan", "NaN", "-nan", "nan(ind)"}) {
    EXPECT_TRUE(std::isnan(ParseNumberOfProgram(text).value_or(0.0))) << text;
  }
  for (const char* const text :
       {"", "+", " 1", "1 ", "0x1", "1e", "1,5", ".nan", "na", "infinite"}) {
    EXPECT_FALSE(ParseNumberOfProgram(text)) << text;
  }
}

TEST(Number, EndsBeforeWhatFollows) {
  const std::string row = "1.5;inf;x";
  const char* const end = row.data() + row.size();
  double value = 0.0;
  EXPECT_EQ(ReadNumber(row.data(), end, value), row.data() + 3);
  EXPECT_EQ(value, 1.5);
  EXPECT_EQ(ReadNumber(row.data() + 4, end, value), nullptr) << "not finite";
  EXPECT_EQ(ReadNumber(row.data() + 8, end, value), nullptr);
  EXPECT_EQ(ReadNumber(end, end, value), nullptr);
}

}  // namespace
}  // namespace gauntlet::controller
