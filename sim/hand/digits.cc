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

/// Where the body puts a point, or turns a direction, of its own.
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

/// Square of the distance of two segments whose middles are `between` apart (from the second to the
/// first); `a` and `b` lead from a middle to an end.
/// Source: Ericson, Real-Time Collision Detection (2005), 5.1.9.
double SquaredDistance(const Vector3d& between, const Vector3d& a, const Vector3d& b) {
  const double aa = a.squaredNorm();
  const double bb = b.squaredNorm();
  const double ab = a.dot(b);
  const double from_a = a.dot(between);
  const double from_b = b.dot(between);
  const double along_a = Share(ab * from_b - from_a * bb, aa * bb - ab * ab);
  const double along_b = Share(ab * along_a + from_b, bb);
  return (between + Share(ab * along_b - from_a, aa) * a - along_b * b).squaredNorm();
}

}  // namespace

std::optional<Digits::Phalanx> Digits::PhalanxOf(const mjModel& whole, const PhysicsModel& physics,
                                                 int palm, int geom) {
  const bool touches = whole.geom_contype[geom] != 0 || whole.geom_conaffinity[geom] != 0;
  if (whole.geom_type[geom] != mjGEOM_CAPSULE || !touches) return std::nullopt;
  const int body = whole.geom_bodyid[geom];
  int digit = body;
  while (digit > 0 && whole.body_parentid[digit] != palm) digit = whole.body_parentid[digit];
  if (digit == 0 || physics.BodyOf(body) < 0) return std::nullopt;
  Phalanx phalanx{.digit = digit,
                  .body = physics.BodyOf(body),
                  .half_length_m = whole.geom_size[3 * geom + 1],
                  .radius_m = whole.geom_size[3 * geom]};
  const double along_z[3] = {0.0, 0.0, phalanx.half_length_m};
  mju_copy3(phalanx.center_m, whole.geom_pos + 3 * geom);
  mju_rotVecQuat(phalanx.half_axis_m, along_z, whole.geom_quat + 4 * geom);
  return phalanx;
}

Digits::Digits(const mjModel& whole, const PhysicsModel& physics) {
  const int palm = mj_name2id(&whole, mjOBJ_BODY, "palm");
  for (int geom = 0; palm >= 0 && geom < whole.ngeom; ++geom) {
    if (const auto phalanx = PhalanxOf(whole, physics, palm, geom)) phalanges_.push_back(*phalanx);
  }
  const bool several = std::ranges::any_of(phalanges_, [this](const Phalanx& phalanx) {
    return phalanx.digit != phalanges_.front().digit;
  });
  if (!several) phalanges_.clear();
}

double Digits::Overlap(const mjData& data) const noexcept {
  double deepest = 0.0;
  for (auto first = phalanges_.begin(); first != phalanges_.end(); ++first) {
    const Vector3d center = Placed(data, first->body, first->center_m);
    const Vector3d axis = Turned(data, first->body, first->half_axis_m);
    for (auto second = phalanges_.begin(); second != first; ++second) {
      if (second->digit == first->digit) continue;
      const double radii = first->radius_m + second->radius_m;
      const double reach = radii + first->half_length_m + second->half_length_m - deepest;
      const Vector3d between = center - Placed(data, second->body, second->center_m);
      if (between.squaredNorm() >= reach * reach) continue;
      const Vector3d other_axis = Turned(data, second->body, second->half_axis_m);
      deepest = std::max(deepest, radii - std::sqrt(SquaredDistance(between, axis, other_axis)));
    }
  }
  return deepest;
}

}  // namespace gauntlet::sim
