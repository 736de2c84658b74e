#pragma once

namespace gauntlet::sim {

/// Two-sided tail probability of Student's t: P(|T| >= |t|).
double StudentProbability(double t, double degrees_of_freedom);
/// Its inverse: half width of the confidence interval at this level, in standard errors.
double StudentHalfWidth(double level, double degrees_of_freedom);

}  // namespace gauntlet::sim
