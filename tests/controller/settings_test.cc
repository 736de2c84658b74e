#include "controller/settings.h"

#include <gtest/gtest.h>

namespace gauntlet::controller {
namespace {

TEST(NumberText, HasAllDigitsOfWholeNumbersAndSixOfOthers) {
  EXPECT_EQ(NumberText(2147483648.0), "2147483648");
  EXPECT_EQ(NumberText(-12345678.0), "-12345678");
  EXPECT_EQ(NumberText(1e300), "1e+300");
  EXPECT_EQ(NumberText(1.0 / 3.0), "0.333333");
  EXPECT_EQ(NumberText(0.0), "0");
}

TEST(RangeProblem, ShowsWhichSideOfTheBoundANumberIsOn) {
  Setting setting;
  setting.min = 0.5;
  setting.max = 2147483647.0;
  EXPECT_EQ(RangeProblem(setting, 0.5), "");
  EXPECT_EQ(RangeProblem(setting, 2147483647.0), "");
  EXPECT_EQ(RangeProblem(setting, 0.49999999), "is 0.49999999, must be from 0.5 to 2147483647");
  EXPECT_EQ(RangeProblem(setting, 2147483648.0), "is 2147483648, must be from 0.5 to 2147483647");
}

}  // namespace
}  // namespace gauntlet::controller
