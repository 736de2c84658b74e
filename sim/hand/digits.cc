#include "sim/hand/digits.h"

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;
using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Map<const Vector3d> VectorAt(const double* numbers) {
  return Eigen::Map<const Vector3d>(numbers);
}

/// Point, or direction, of a body in the world.
Vector3d Placed(const mjData& data, int body, const double* point) {
  return VectorAt(data.xpos + 3 * body) +
         Eigen::Map<const Rotation>(data.xmat + 9 * body) * VectorAt(point);
}
Vector3d Turned(const mjData& data, int body, const double* direction) {
  return Eigen::Map<const Rotation>(data.xmat + 9 * body) * VectorAt(direction);
}

double Share(double part, double whole) {
  return whole > 0.0 ? std::clamp(part / whole, -1.0, 1.0) : 0.0;
}

/// Axis of a capsule in the world: its middle, and the way from there to an end.
struct Axis {
  Vector3d center;
  Vector3d half;
};

/// Source: Ericson, Real-Time Collision Detection (2005), 5.1.9.
Digits::Gap GapBetween(const Axis& a, const Axis& b, double radii_m) {
  const Vector3d between = a.center - b.center;
  const double aa = a.half.squaredNorm();
  const double bb = b.half.squaredNorm();
  const double ab = a.half.dot(b.half);
  const double from_a = a.half.dot(between);
  const double from_b = b.half.dot(between);
  double along_a = Share(ab * from_b - from_a * bb, aa * bb - ab * ab);
  const double along_b = Share(ab * along_a + from_b, bb);
  along_a = Share(ab * along_b - from_a, aa);
  Digits::Gap gap;
  Eigen::Map<Vector3d>(gap.point_m[0]) = a.center + along_a * a.half;
  Eigen::Map<Vector3d>(gap.point_m[1]) = b.center + along_b * b.half;
  gap.gap_m = std::sqrt((between + along_a * a.half - along_b * b.half).squaredNorm()) - radii_m;
  return gap;
}

}  // namespace

std::optional<Digits::Phalanx> Digits::PhalanxOf(const mjModel& whole, int palm,
                                                 std::span<const int> body_index, int geom) {
  const bool touches = whole.geom_contype[geom] != 0 || whole.geom_conaffinity[geom] != 0;
  if (whole.geom_type[geom] != mjGEOM_CAPSULE || !touches) return std::nullopt;
  const int body = whole.geom_bodyid[geom];
  int digit = body;
  while (digit > 0 && whole.body_parentid[digit] != palm) digit = whole.body_parentid[digit];
  if (digit == 0 || body_index[body] < 0) return std::nullopt;
  Phalanx phalanx{.digit = digit,
                  .geom = geom,
                  .body = body_index[body],
                  .half_length_m = whole.geom_size[3 * geom + 1],
                  .radius_m = whole.geom_size[3 * geom]};
  const double along_z[3] = {0.0, 0.0, phalanx.half_length_m};
  mju_copy3(phalanx.center_m, whole.geom_pos + 3 * geom);
  mju_rotVecQuat(phalanx.half_axis_m, along_z, whole.geom_quat + 4 * geom);
  return phalanx;
}

Digits::Digits(const mjModel& whole, int palm, std::span<const int> body_index) {
  for (int geom = 0; palm >= 0 && geom < whole.ngeom; ++geom) {
    if (const auto found = PhalanxOf(whole, palm, body_index, geom)) phalanges_.push_back(*found);
  }
  const bool several = std::ranges::any_of(phalanges_, [this](const Phalanx& phalanx) {
    return phalanx.digit != phalanges_.front().digit;
  });
  if (!several) phalanges_.clear();
}

template <class Visit>
void Digits::VisitGaps(const mjData& data, double below_m, const Visit& visit) const {
  for (auto first = phalanges_.begin(); first != phalanges_.end(); ++first) {
    const Vector3d center = Placed(data, first->body, first->center_m);
    const Vector3d axis = Turned(data, first->body, first->half_axis_m);
    for (auto second = phalanges_.begin(); second != first; ++second) {
      if (second->digit == first->digit) continue;
      const double radii = first->radius_m + second->radius_m;
      const double reach = radii + first->half_length_m + second->half_length_m + below_m;
      const Vector3d other_center = Placed(data, second->body, second->center_m);
      if ((center - other_center).squaredNorm() >= reach * reach) continue;
      const Vector3d other_axis = Turned(data, second->body, second->half_axis_m);
      Gap gap = GapBetween({center, axis}, {other_center, other_axis}, radii);
      if (!(gap.gap_m < below_m)) continue;
      gap.body[0] = first->body;
      gap.body[1] = second->body;
      visit(gap, below_m);
    }
  }
}

double Digits::Overlap(const mjData& data) const noexcept {
  double deepest_gap = 0.0;
  VisitGaps(data, 0.0, [&](const Gap& gap, double& below_m) { below_m = deepest_gap = gap.gap_m; });
  return 0.0 - deepest_gap;  // not -0
}

void Digits::FindGaps(const mjData& data, double below_m, std::vector<Gap>& gaps) const {
  gaps.clear();
  VisitGaps(data, below_m, [&](const Gap& gap, double&) { gaps.push_back(gap); });
}

std::optional<Digits::Gap> Digits::GapOf(const mjData& data, int first_geom,
                                         int second_geom) const {
  const auto first = std::ranges::find(phalanges_, first_geom, &Phalanx::geom);
  const auto second = std::ranges::find(phalanges_, second_geom, &Phalanx::geom);
  if (first == phalanges_.end() || second == phalanges_.end()) return std::nullopt;
  const auto axis_of = [&data](const Phalanx& phalanx) {
    return Axis{Placed(data, phalanx.body, phalanx.center_m),
                Turned(data, phalanx.body, phalanx.half_axis_m)};
  };
  Gap gap = GapBetween(axis_of(*first), axis_of(*second), first->radius_m + second->radius_m);
  gap.body[0] = first->body;
  gap.body[1] = second->body;
  return gap;
}

}  // namespace gauntlet::sim
