#pragma once

#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Follows the input with limits on velocity, acceleration and jerk: online trajectory generation.
/// In steps of one sample, with V, A and J the limits per step, step^2 and step^3:
///
///     |j(k)| <= J,  a(k) = a(k-1) + j(k),  |a(k)| <= A,  v(k) = v(k-1) + a(k),  |v(k)| <= V,
///     y(k)   = y(k-1) + v(k),              y(0) = z(0),  v(0) = a(0) = 0
///
/// So the first, second and third differences of the output are v, a and j: they keep the limits
/// exactly, whatever the input. a(k) is the highest acceleration (towards the input) after which
/// the fastest stop does not end beyond z(k), and after which v can still be kept within V:
///
///     S(b)  = b + (b - J) + (b - 2 J) + .. , positive terms only; S(-b) = -S(b)
///     stop: a <- S^-1(-v), within J of the a before and within A, until v = a = 0
///     -S^-1(V + v) <= a <= S^-1(V - v)
///
/// A constant input is reached from rest in the least number of samples, up to one, and without
/// overshoot. A moving input is followed at the distance of a stop, v^2 / (2 A) + v A / (2 J) on a
/// ramp. White noise keeps most of its size, in slower swings: a low pass before it reduces them.
///
/// Source: Zanasi, Lo Bianco, Tonielli, Automatica 36 (2000), the velocity's law in discrete time;
/// Biagiotti, Melchiorri, Trajectory Planning for Automatic Machines (2008), section 4.6.
/// Units: of the input per s, s^2 and s^3, so useful limits depend on whether counts or angles are
/// filtered.
struct GAUNTLET_API JerkLimitConfig {
  static constexpr std::string_view kKind = "jerk_limit";
  static constexpr std::string_view kSummary =
      "follows the input with limited velocity, acceleration and jerk";

  // For counts, about 10 of which are a degree. An assumption of what a hand needs.
  double max_velocity_per_s = 1e4;
  double max_acceleration_per_s2 = 2e5;
  double max_jerk_per_s3 = 1e7;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
