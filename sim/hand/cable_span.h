#pragma once

namespace gauntlet::sim {

/// Length of a stretch of cable and how it grows with the angle of the hinge that it crosses.
struct SpanLength {
  double length_m = 0.0;
  double arm_m = 0.0;  // d length / d angle
};

/// A stretch of cable between two guides, one on each side of a hinge: around a pulley on the
/// hinge's axis, or straight where there is none or the cable has left it. With x = angle -
/// reference:
///
///     on the pulley   length^2 = (tangents + arc)^2 + rise^2,   arc = arc_m + radius_m x > 0
///     straight        length^2 = square - 2 (along cos x + across sin x)
///
/// Both and their slopes are the same where the arc is 0.
/// Source: the geodesic on a cylinder is straight when the cylinder is unrolled; the law of
/// cosines.
struct CableSpan {
  int qpos = 0;
  int dof = 0;
  int crossing = -1;           // among the cable's crossings; -1: the hinge hardly moves the cable
  double reference_rad = 0.0;  // joint angle at which x is 0
  double square_m2 = 0.0;
  double along_m2 = 0.0;
  double across_m2 = 0.0;
  double tangents_m = 0.0;  // from the guides to the pulley, seen along the axis
  double rise_m = 0.0;      // along the axis
  double arc_m = -1.0;      // on the pulley at the reference; below 0: the cable is off it
  double radius_m = 0.0;    // of the pulley, below 0 where the arc shrinks with the angle

  SpanLength At(double angle_rad) const noexcept;
};

}  // namespace gauntlet::sim
