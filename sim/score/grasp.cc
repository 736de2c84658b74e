#include "sim/score/grasp.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "controller/assert.h"
#include "sim/score/grip.h"
#include "sim/score/no_score.h"

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;

constexpr double kLeastHeld_s = 0.1;
constexpr double kLeastFall_s = 0.1;  // 5 cm
constexpr double kLoadMean_s = 0.02;

Vector3d PlaceAt(const Signal& pose, int tick) { return pose.row(tick).head<3>(); }

/// Its z axis, as the frame of the pose has it.
Vector3d AxisAt(const Signal& pose, int tick) {
  const Eigen::Quaterniond attitude(pose(tick, 3), pose(tick, 4), pose(tick, 5), pose(tick, 6));
  return attitude.normalized() * Vector3d::UnitZ();
}

double AngleBetween(const Vector3d& first, const Vector3d& second) {
  return std::atan2(first.cross(second).norm(), first.dot(second));
}

/// Visits the ticks of the ranges that count.
template <class Visit>
void ForEachTick(const std::vector<TickRange>& ranges, const CountedTicks& counted,
                 const Visit& visit) {
  for (const TickRange& range : ranges) {
    for (const TickRange& part : Overlap({range}, counted)) {
      for (int tick = part.begin; tick < part.end; ++tick) visit(range, tick);
    }
  }
}

/// The largest of what `measure` says of a tick while the hand holds and touches the object.
template <class Measure>
double LargestWhileHeld(const GraspSignals& grasp, const CountedTicks& counted,
                        const Measure& measure) {
  double largest = kNoScore;
  ForEachTick(HeldRanges(grasp), counted, [&](const TickRange& held, int tick) {
    if (grasp.grip_force_n[tick] < kTouchN) return;
    largest = std::fmax(largest, measure(held, tick));
  });
  return largest;
}

/// While the support does not carry the object, for long enough, from a touch of the hand on.
std::vector<TickRange> RangesOffSupport(const GraspSignals& grasp) {
  GAUNTLET_ASSERT(grasp.support_force_n.size() == grasp.grip_force_n.size());
  const auto ticks = static_cast<int>(grasp.grip_force_n.size());
  const auto least = static_cast<int>(std::lround(kLeastHeld_s * grasp.rate_hz));
  std::vector<TickRange> ranges;
  for (int tick = 0; tick < ticks; ++tick) {
    const int begin = tick;
    while (tick < ticks && grasp.support_force_n[tick] < kTouchN) ++tick;
    if (tick - begin < std::max(least, 1)) continue;
    if (grasp.grip_force_n[begin] >= kTouchN) ranges.push_back({begin, tick});
  }
  return ranges;
}

}  // namespace

std::vector<TickRange> HeldRanges(const GraspSignals& grasp) {
  std::vector<TickRange> ranges = RangesOffSupport(grasp);
  const int fall = FallTick(grasp);
  std::erase_if(ranges, [fall](const TickRange& range) { return range.begin >= fall; });
  if (!ranges.empty()) ranges.back().end = std::min(ranges.back().end, fall);
  return ranges;
}

int FallTick(const GraspSignals& grasp) {
  const auto ticks = static_cast<int>(grasp.grip_force_n.size());
  const auto least = static_cast<int>(std::lround(kLeastFall_s * grasp.rate_hz));
  const std::vector<TickRange> off_support = RangesOffSupport(grasp);
  if (off_support.empty()) return ticks;
  for (int tick = off_support.front().begin; tick < ticks; ++tick) {
    const int begin = tick;
    while (tick < ticks && grasp.grip_force_n[tick] < kTouchN &&
           grasp.support_force_n[tick] < kTouchN) {
      ++tick;
    }
    if (tick - begin >= std::max(least, 1)) return begin;
  }
  return ticks;
}

double ObjectSlip(const GraspSignals& grasp, const CountedTicks& counted) {
  return LargestWhileHeld(grasp, counted, [&](const TickRange& held, int tick) {
    return (PlaceAt(*grasp.pose_in_palm, tick) - PlaceAt(*grasp.pose_in_palm, held.begin)).norm();
  });
}

double ObjectTilt(const GraspSignals& grasp, const CountedTicks& counted) {
  double largest = LargestWhileHeld(grasp, counted, [&](const TickRange& held, int tick) {
    return AngleBetween(AxisAt(*grasp.pose_in_palm, tick), AxisAt(*grasp.pose_in_palm, held.begin));
  });
  CountedTicks standing = counted;
  for (const TickRange& held : HeldRanges(grasp)) standing = Without(standing, held);
  standing = Overlap(standing, {{0, FallTick(grasp)}});
  for (const TickRange& range : standing) {
    for (int tick = range.begin; tick < range.end; ++tick) {
      largest = std::fmax(largest, AngleBetween(AxisAt(*grasp.pose, tick), Vector3d::UnitZ()));
    }
  }
  return largest;
}

double GripForceRatio(const GraspSignals& grasp, const CountedTicks& counted) {
  GAUNTLET_ASSERT(grasp.carried_force_n.size() == grasp.grip_force_n.size());
  const int window = std::max(1, static_cast<int>(std::lround(kLoadMean_s * grasp.rate_hz)));
  double least = kNoScore;
  for (const TickRange& range : Overlap(HeldRanges(grasp), counted)) {
    for (int tick = range.begin; tick + window <= range.end; tick += window) {
      double grip_n = 0.0;
      double load_n = 0.0;
      for (int n = tick; n < tick + window; ++n) {
        grip_n += grasp.grip_force_n[n];
        load_n += grasp.carried_force_n[n];
      }
      if (load_n > 0.0) least = std::fmin(least, grasp.friction * grip_n / load_n);
    }
  }
  return least;
}

double LostContactShare(const GraspSignals& grasp, const CountedTicks& counted) {
  const auto ticks = static_cast<int>(grasp.grip_force_n.size());
  int held_ticks = 0;
  int lost_ticks = 0;
  ForEachTick(HeldRanges(grasp), counted, [&](const TickRange&, int tick) {
    ++held_ticks;
    lost_ticks += grasp.grip_force_n[tick] < kTouchN ? 1 : 0;
  });
  const int fall = FallTick(grasp);
  const int fallen_ticks = fall < ticks ? CountOf(Overlap({{fall, ticks}}, counted)) : 0;
  if (held_ticks + fallen_ticks == 0) return kNoScore;
  return static_cast<double>(lost_ticks + fallen_ticks) / (held_ticks + fallen_ticks);
}

double ObjectDropped(const GraspSignals& grasp) {
  return FallTick(grasp) < std::ssize(grasp.grip_force_n) ? 1.0 : 0.0;
}

}  // namespace gauntlet::sim
