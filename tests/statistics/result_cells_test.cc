#include "sim/score/statistics/result_cells.h"

#include <gtest/gtest.h>

namespace gauntlet::sim {
namespace {

MeanInterval Interval(double mean, double half, double degrees_of_freedom) {
  return {.mean = mean,
          .low = mean - half,
          .high = mean + half,
          .degrees_of_freedom = degrees_of_freedom};
}

TEST(IntervalText, HasDigitsThatAPersonReads) {
  EXPECT_EQ(IntervalText(Interval(4.96, 0.12, 7)), "4.96±0.12");
  EXPECT_EQ(IntervalText(Interval(0.0773, 8.5e-05, 7)), "0.0773±0.0001");
  EXPECT_EQ(IntervalText(Interval(0.109, 9.1e-4, 7)), "0.109±0.001");
  EXPECT_EQ(IntervalText(Interval(-0.0105, 0.0046, 7)), "-0.0105±0.0046");
  EXPECT_EQ(IntervalText(Interval(125.4, 127.3, 7)), "125±127");
  EXPECT_EQ(IntervalText(Interval(-0.0003, 7.7, 7)), "0.0±7.7");
  EXPECT_EQ(IntervalText(Interval(8.03, 0.0, 7)), "8.03±0");
  EXPECT_EQ(IntervalText({}), "-");
}

TEST(IntervalText, OfTooFewSeedsIsTheMeanAlone) {
  EXPECT_EQ(IntervalText(Interval(125.0, 1895.0, 1)), "125");
  EXPECT_EQ(IntervalText(Interval(125.0, 60.0, 1)), "125±60");
  EXPECT_EQ(IntervalText(Interval(125.0, 130.0, 3)), "125±130");  // undecided, but told
  EXPECT_TRUE(IsOfTooFew(Interval(8.0, 261.0, 1), 149.0));        // a difference of that score
  EXPECT_FALSE(IsOfTooFew(Interval(0.0, 1.2, 1), 5.2));
}

TEST(TooFewText, NamesWhatThereIsTooLittleOf) {
  EXPECT_EQ(TooFewTextIfAny({Interval(4.0, 0.1, 1), Interval(1.0, 9.0, 1)}, 2),
            "2 seeds: too few for some intervals, use --seeds 8.");
  EXPECT_EQ(TooFewTextIfAny({Interval(1.0, 9.0, 1)}, 8),
            "2 motions: too few for some intervals, use more.");
  EXPECT_EQ(TooFewTextIfAny({Interval(1.0, 9.0, 7)}, 8), "");
}

}  // namespace
}  // namespace gauntlet::sim
