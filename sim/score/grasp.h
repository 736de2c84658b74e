#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// Signals of a hand and an object, one row per tick. Views.
///
/// The hand touches the object where the grip force is kTouchN or more, and the support carries it
/// where the force of the support is. The hand holds the object from the tick at which it touches
/// the object and the support carries it no more, for 0.1 s at least, until the support carries it
/// again or the object falls. An object falls that was held, from the tick from which neither hand
/// nor support touches it for 0.1 s, to the end.
struct GraspSignals {
  double rate_hz = 1000.0;
  std::span<const double> grip_force_n = {};     // sum of the normal forces of the hand
  std::span<const double> carried_force_n = {};  // size of the sum of all forces of the hand
  std::span<const double> support_force_n = {};  // sum of the normal forces of the support
  const Signal* pose = nullptr;                  // place [m] and quaternion in the world: 7 columns
  const Signal* pose_in_palm = nullptr;          // the same in the frame of the palm
  double friction = 0.0;                         // coefficient between hand and object

  bool exist() const { return pose != nullptr; }
};

/// While the hand holds the object.
std::vector<TickRange> HeldRanges(const GraspSignals& grasp);
/// First tick of the fall; the number of ticks if the object does not fall.
int FallTick(const GraspSignals& grasp);

// All of the ticks that count; kNoScore where there are none.

/// Largest distance [m] of the object's centre in the palm from where it was when the hand began to
/// hold it, while the hand touches it.
double ObjectSlip(const GraspSignals& grasp, const CountedTicks& counted);

/// Largest angle [rad] of the object's axis, its z: against the vertical until it is held; while
/// the hand holds and touches it, in the palm against where it was when the hand began to hold it.
double ObjectTilt(const GraspSignals& grasp, const CountedTicks& counted);

/// Least grip force while the hand holds the object, over the least that holds it:
///
///     min of mu sum(N) / |sum(f)|, both means over 20 ms
///
/// f are the forces of the hand on the object, N their normal parts, mu the coefficient of
/// friction. sum(f) is the load: the weight of the object and what moves it. Contacts that oppose
/// each other carry a load along their surfaces while it is within their friction cones, so with
/// normal forces of |sum(f)| / mu in all. At 1 it slips. Assumption: the load is along the
/// surfaces; what their normals carry makes the true ratio larger.
/// Source: ratio of grip force to slip force, Westling and Johansson 1984, doi 10.1007/BF00238156.
double GripForceRatio(const GraspSignals& grasp, const CountedTicks& counted);

/// Share of the time in which the hand does not touch the object, of that in which it holds it or
/// the object falls.
double LostContactShare(const GraspSignals& grasp, const CountedTicks& counted);

/// 1 if the object falls, else 0.
double ObjectDropped(const GraspSignals& grasp);

}  // namespace gauntlet::sim
