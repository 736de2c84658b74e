#pragma once

#include <functional>
#include <vector>

namespace gauntlet::sim {

/// The result at a point of the unit cube.
struct Measured {
  double objective = 0.0;  // to be small; not finite: there is none here
  double violation = 0.0;  // of all bounds, each relative to its size; 0: they are kept
};

struct MeasuredPoint {
  std::vector<double> place;  // in [0, 1], per dimension
  Measured measured;
};

/// Looks for the smallest objective without a violation, with at most so many measurements: half of
/// them all over the cube (DIRECT, locally biased), the rest around the best (Subplex), both from
/// NLopt and both without random numbers. They see
///
///     objective / |first objective| + 10 violation
///
/// so a bound is exact wherever 10 % of violation cost more than the objective gains by them.
/// Returns all points in the order in which they were measured. What `measure` throws, it throws.
/// Source: Gablonsky, Kelley 2001; Rowan 1990; NLopt 2.7.
std::vector<MeasuredPoint> Minimise(
    int dimensions, int measurements,
    const std::function<Measured(const std::vector<double>&)>& measure);

/// The two halves of Minimise(), each by itself: all over the cube, and around a point of it.
std::vector<MeasuredPoint> LookEverywhere(
    int dimensions, int measurements,
    const std::function<Measured(const std::vector<double>&)>& measure);
std::vector<MeasuredPoint> LookAround(
    const std::vector<double>& start, int measurements,
    const std::function<Measured(const std::vector<double>&)>& measure);

/// The best of them: of those without a violation, else of all. `points` is not empty.
const MeasuredPoint& BestOf(const std::vector<MeasuredPoint>& points);

}  // namespace gauntlet::sim
