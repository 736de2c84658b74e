#pragma once

namespace gauntlet::sim {

/// Student's t: the chance of a value at least so far from 0, to either side.
double StudentProbability(double t, double degrees_of_freedom);
/// Its inverse: within how many standard errors to both sides the truth lies with this confidence.
double StudentHalfWidth(double level, double degrees_of_freedom);

}  // namespace gauntlet::sim
