#include "sim/base/error.h"

#include <gtest/gtest.h>

namespace gauntlet::sim {
namespace {

TEST(UserError, SaysPlaceKeyAndProblemInOneLine) {
  const UserError error(
      {.place = "a.yaml:3:5", .key = "glove.rate_hz", .problem = "is 5, must be 10 or more"});
  EXPECT_STREQ(error.what(), "a.yaml:3:5: glove.rate_hz: is 5, must be 10 or more");
  EXPECT_EQ(error.place(), "a.yaml:3:5");
  EXPECT_EQ(error.key(), "glove.rate_hz");
  EXPECT_EQ(error.problem(), "is 5, must be 10 or more");
}

TEST(UserError, LeavesOutWhatIsNotKnown) {
  EXPECT_STREQ(UserError({.place = "a.csv:2", .problem = "is empty"}).what(), "a.csv:2: is empty");
  EXPECT_STREQ(UserError({.key = "seed", .problem = "is empty"}).what(), "seed: is empty");
  const UserError error("no hand: no trial");
  EXPECT_STREQ(error.what(), "no hand: no trial");
  EXPECT_EQ(error.place(), "");
}

}  // namespace
}  // namespace gauntlet::sim
