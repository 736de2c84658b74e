#pragma once

#include <optional>
#include <vector>

#include "sim/hand/engine_types.h"
#include "sim/hand/physics_model.h"

namespace gauntlet::sim {

/// The digits of a hand, and the depth of their interpenetration, which exists without contacts.
///
/// A digit is all that a body carried by the body `palm` carries; its phalanges are the capsules
/// that can touch. A model without at least two of them has no digits to speak of.
class Digits {
 public:
  Digits() = default;
  Digits(const mjModel_& whole, const PhysicsModel& physics);

  bool exist() const { return !phalanges_.empty(); }
  /// The deepest that one digit is in another [m], from where bodies of the physics model are; 0 if
  /// all are apart. The depth of two capsules of radii r is r1 + r2 - d, d the distance of their
  /// axes.
  double Overlap(const mjData_& physics_data) const noexcept;

 private:
  struct Phalanx {
    int digit = 0;  // the body that the palm carries
    int body = 0;   // in the physics model
    double center_m[3] = {};
    double half_axis_m[3] = {};
    double half_length_m = 0.0;
    double radius_m = 0.0;
  };
  static std::optional<Phalanx> PhalanxOf(const mjModel_& whole, const PhysicsModel& physics,
                                          int palm, int geom);

  std::vector<Phalanx> phalanges_;
};

}  // namespace gauntlet::sim
