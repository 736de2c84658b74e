#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sim/hand/engine_types.h"

namespace gauntlet::sim {

/// The digits of a hand, and the depth of their interpenetration, which exists without contacts.
///
/// A digit is all that a body carried by the palm carries; its phalanges are the capsules that can
/// touch. A model without at least two of them has no digits to speak of.
class Digits {
 public:
  /// Gap between the surfaces of two phalanges of different digits: d - r1 - r2, d the distance of
  /// the capsules' axes, r their radii. Below 0 they interpenetrate.
  struct Gap {
    double gap_m = 0.0;
    int body[2] = {};           // as the caller numbers bodies
    double point_m[2][3] = {};  // nearest points of the axes, in the world
  };

  Digits() = default;
  /// `palm`: body of `whole`; below 0: no digits. `body_index`: per body of `whole` its number in
  /// the data that the other functions get; -1 for a body that the data does not have.
  Digits(const mjModel_& whole, int palm, std::span<const int> body_index);

  bool exist() const { return !phalanges_.empty(); }
  /// The deepest that one digit is in another [m], from where the bodies are; 0 if all are apart.
  double Overlap(const mjData_& data) const noexcept;
  /// Replaces `gaps` by those below `below_m`, in the model's order.
  void FindGaps(const mjData_& data, double below_m, std::vector<Gap>& gaps) const;
  /// Gap of two geoms of the whole model; none unless both are phalanges.
  std::optional<Gap> GapOf(const mjData_& data, int first_geom, int second_geom) const;

 private:
  struct Phalanx {
    int digit = 0;  // the body that the palm carries
    int geom = 0;   // in the whole model
    int body = 0;
    double center_m[3] = {};
    double half_axis_m[3] = {};
    double half_length_m = 0.0;
    double radius_m = 0.0;
  };
  static std::optional<Phalanx> PhalanxOf(const mjModel_& whole, int palm,
                                          std::span<const int> body_index, int geom);
  /// Visits pairs of different digits with a gap below `below_m`, which the visitor may change.
  template <class Visit>
  void VisitGaps(const mjData_& data, double below_m, const Visit& visit) const;

  std::vector<Phalanx> phalanges_;
};

}  // namespace gauntlet::sim
