#include "sim/base/student.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gauntlet::sim {
namespace {

TEST(Student, IsThatOfTheTables) {
  // Abramowitz and Stegun 1964, table 26.10.
  EXPECT_NEAR(StudentHalfWidth(0.95, 1), 12.706, 5e-4);
  EXPECT_NEAR(StudentHalfWidth(0.95, 7), 2.365, 5e-4);
  EXPECT_NEAR(StudentHalfWidth(0.99, 2), 9.925, 5e-4);
  EXPECT_NEAR(StudentHalfWidth(0.999, 24), 3.745, 5e-4);
  EXPECT_NEAR(StudentHalfWidth(0.9999, 3), 28.000, 5e-4);
}

TEST(Student, OfOneDegreeOfFreedomIsCauchys) {
  for (const double t : {0.3, 2.0, 50.0, 1e4}) {
    EXPECT_NEAR(StudentProbability(t, 1), 2.0 * std::atan(1.0 / t) / M_PI, 1e-12) << t;
    EXPECT_EQ(StudentProbability(t, 1), StudentProbability(-t, 1));
  }
}

TEST(Student, HalfWidthTurnsProbabilityRound) {
  for (const double degrees : {1.0, 2.0, 3.7, 31.0, 99999.0}) {
    for (const double error : {0.5, 0.05, 3e-4, 1e-7}) {
      const double t = StudentHalfWidth(1.0 - error, degrees);
      EXPECT_NEAR(StudentProbability(t, degrees) / error, 1.0, 1e-6) << degrees << " " << error;
    }
  }
}

}  // namespace
}  // namespace gauntlet::sim
