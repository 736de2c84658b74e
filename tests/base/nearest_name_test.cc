// What a person probably meant.
#include "sim/base/nearest_name.h"

#include <gtest/gtest.h>

namespace gauntlet::sim {
namespace {

TEST(NearestName, IsTheOneWithTheFewestMistakes) {
  EXPECT_EQ(NearestName("comapre", {"run", "compare"}), "compare");
  EXPECT_EQ(NearestName("--seds", {"--set", "--seeds"}), "--seeds");
  EXPECT_EQ(NearestName("xyz", {"run", "compare"}), "");
}

TEST(NearestName, OfEquallyNearOnesLacksLettersOnly) {
  EXPECT_EQ(NearestName("--sed", {"--set", "--seed"}), "--seed");
  EXPECT_EQ(NearestName("--sed", {"--seed", "--set"}), "--seed");
  EXPECT_EQ(NearestName("lst", {"list", "last"}), "list");  // both do: the first
}

TEST(Suggestion, OfNothingIsNone) { EXPECT_EQ(Suggestion("my.yaml", {}), ""); }

}  // namespace
}  // namespace gauntlet::sim
