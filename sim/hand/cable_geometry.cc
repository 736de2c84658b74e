#include "sim/hand/cable_geometry.h"

#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "controller/assert.h"
#include "sim/base/error.h"
#include "sim/hand/cable_path.h"

namespace gauntlet::sim {
namespace {

using Eigen::Vector3d;

/// How far spans may be from what the engine says: rounding, no more.
constexpr double kLengthToleranceM = 1e-9;
constexpr double kArmToleranceM = 1e-8;
/// Distances from an axis that count as none [m]; also for the sine between two axes.
constexpr double kOnAxisM = 1e-9;
/// Joints pass their stops by some degrees.
constexpr double kBeyondRangeRad = 0.1;

Vector3d Vector(const mjtNum* numbers) { return Eigen::Map<const Vector3d>(numbers); }

/// Two guides of a cable that follow each other, and what it may run around between them.
struct Stretch {
  int first_site = 0;
  int second_site = 0;
  int geom = -1;
  int side_site = -1;
};

/// A point seen from a hinge's axis.
struct FromAxis {
  Vector3d radial;
  double height_m;
};

struct Hinge {
  Vector3d anchor;
  Vector3d axis;

  FromAxis operator()(const mjtNum* point) const {
    const Vector3d from_anchor = Vector(point) - anchor;
    const double height = axis.dot(from_anchor);
    return {from_anchor - height * axis, height};
  }
};

class SpanFinder {
 public:
  /// `data` holds the reference posture.
  SpanFinder(const mjModel& model, const mjData& data) : model_(model), data_(data) {}

  /// False if this cable is not a sum of functions of one angle each.
  bool Find(Cable& cable) const {
    const std::optional<std::vector<Stretch>> way = WayOf(cable.tendon);
    if (!way) return false;
    cable.fixed_length_m = data_.ten_length[cable.tendon];
    for (const Stretch& stretch : *way) {
      const std::vector<int> joints = JointsWithin(stretch);
      if (joints.empty()) continue;
      if (joints.size() > 1 || model_.jnt_type[joints[0]] != mjJNT_HINGE) return false;
      const std::optional<CableSpan> span = SpanOf(stretch, joints[0]);
      if (!span) return false;
      if (std::hypot(span->along_m2, span->across_m2) < kOnAxisM * kOnAxisM) continue;
      cable.spans.push_back(*span);
      const auto crossing = std::ranges::find(cable.crossings, span->dof, &Crossing::dof);
      if (crossing != cable.crossings.end()) {
        cable.spans.back().crossing = static_cast<int>(crossing - cable.crossings.begin());
      }
      cable.fixed_length_m -= span->At(span->reference_rad).length_m;
    }
    return true;
  }

 private:
  std::optional<std::vector<Stretch>> WayOf(int tendon) const {
    std::vector<Stretch> way;
    const int last = model_.tendon_adr[tendon] + model_.tendon_num[tendon] - 1;
    for (int index = model_.tendon_adr[tendon]; index < last;) {
      if (model_.wrap_type[index] != mjWRAP_SITE) return std::nullopt;
      Stretch stretch{.first_site = model_.wrap_objid[index]};
      ++index;
      if (model_.wrap_type[index] == mjWRAP_SPHERE || model_.wrap_type[index] == mjWRAP_CYLINDER) {
        stretch.geom = model_.wrap_objid[index];
        stretch.side_site = static_cast<int>(std::lround(model_.wrap_prm[index]));
        ++index;
      }
      if (model_.wrap_type[index] != mjWRAP_SITE) return std::nullopt;
      stretch.second_site = model_.wrap_objid[index];
      way.push_back(stretch);
    }
    return way;
  }

  /// Joints that turn a part of the stretch against the rest of it.
  std::vector<int> JointsWithin(const Stretch& stretch) const {
    const int first = model_.site_bodyid[stretch.first_site];
    const int second = model_.site_bodyid[stretch.second_site];
    const int around = stretch.geom < 0 ? first : model_.geom_bodyid[stretch.geom];
    std::vector<int> joints;
    for (int joint = 0; joint < model_.njnt; ++joint) {
      const bool turns = Turns(model_, joint, first);
      if (turns != Turns(model_, joint, second) || turns != Turns(model_, joint, around)) {
        joints.push_back(joint);
      }
    }
    return joints;
  }

  std::optional<CableSpan> SpanOf(const Stretch& stretch, int joint) const {
    const Hinge hinge{Vector(data_.xanchor + 3 * joint), Vector(data_.xaxis + 3 * joint)};
    const bool second_turns = Turns(model_, joint, model_.site_bodyid[stretch.second_site]);
    const int turned_site = second_turns ? stretch.second_site : stretch.first_site;
    const int fixed_site = second_turns ? stretch.first_site : stretch.second_site;
    const FromAxis turned = hinge(data_.site_xpos + 3 * turned_site);
    const FromAxis fixed = hinge(data_.site_xpos + 3 * fixed_site);
    CableSpan span{.qpos = model_.jnt_qposadr[joint],
                   .dof = model_.jnt_dofadr[joint],
                   .reference_rad = data_.qpos[model_.jnt_qposadr[joint]]};
    span.rise_m = turned.height_m - fixed.height_m;
    span.square_m2 =
        turned.radial.squaredNorm() + fixed.radial.squaredNorm() + span.rise_m * span.rise_m;
    span.along_m2 = turned.radial.dot(fixed.radial);
    span.across_m2 = hinge.axis.cross(turned.radial).dot(fixed.radial);
    if (stretch.geom >= 0 && !PutPulley(stretch, hinge, fixed.radial, turned.radial, span)) {
      return std::nullopt;
    }
    return span;
  }

  /// False if what the cable runs around is no pulley on the hinge's axis.
  bool PutPulley(const Stretch& stretch, const Hinge& hinge, const Vector3d& fixed,
                 const Vector3d& turned, CableSpan& span) const {
    const mjtNum* attitude = data_.geom_xmat + 9 * stretch.geom;
    const Vector3d axis(attitude[2], attitude[5], attitude[8]);
    const double radius = model_.geom_size[3 * stretch.geom];
    const double fixed_m = fixed.norm();
    const double turned_m = turned.norm();
    if (model_.geom_type[stretch.geom] != mjGEOM_CYLINDER ||
        hinge.axis.cross(axis).norm() > kOnAxisM ||
        hinge(data_.geom_xpos + 3 * stretch.geom).radial.norm() > kOnAxisM ||
        std::min(fixed_m, turned_m) <= radius) {
      return false;
    }
    // Angles between a guide and the point where the cable from there touches the pulley.
    const double from_fixed = std::acos(radius / fixed_m);
    const double to_turned = std::acos(radius / turned_m);
    const double between = std::atan2(hinge.axis.dot(fixed.cross(turned)), fixed.dot(turned));
    std::optional<Vector3d> side;
    if (stretch.side_site >= 0) {
      side = hinge(data_.site_xpos + 3 * stretch.side_site).radial;
      if (side->norm() < radius) return false;  // a cable inside a ring
    }
    // Both ways around; the side site, or the shorter way, tells which one it is.
    double best = -std::numeric_limits<double>::infinity();
    for (const double sense : {1.0, -1.0}) {
      double turn = sense * between;
      if (turn < 0.0) turn += 2.0 * std::numbers::pi;
      const double arc = turn - from_fixed - to_turned;
      const Eigen::AngleAxisd to_middle(sense * (from_fixed + 0.5 * arc), hinge.axis);
      const double fit = side ? side->dot(to_middle * fixed) : -turn;
      if (fit <= best) continue;
      best = fit;
      span.arc_m = radius * arc;
      span.radius_m = sense * radius;
    }
    span.tangents_m = std::sqrt(fixed_m * fixed_m - radius * radius) +
                      std::sqrt(turned_m * turned_m - radius * radius);
    return true;
  }

  const mjModel& model_;
  const mjData& data_;
};

/// True if the spans of all cables agree with the engine in the posture of `data`.
bool Agree(const mjModel& model, const mjData& data, const std::vector<Drive>& drives) {
  std::vector<double> arm_m;
  for (const Drive& drive : drives) {
    for (const Cable& cable : drive.cables) {
      arm_m.resize(cable.crossings.size());
      double rate = 0.0;
      const double length = MeasureCable(cable, data.qpos, data.qvel, arm_m, rate);
      if (!(std::abs(length - data.ten_length[cable.tendon]) <= kLengthToleranceM)) return false;
      for (std::size_t i = 0; i < arm_m.size(); ++i) {
        const double arm = MomentArm(model, data, cable.tendon, cable.crossings[i].dof);
        if (!(std::abs(arm_m[i] - arm) <= kArmToleranceM)) return false;
      }
    }
  }
  return true;
}

}  // namespace

double MeasureCable(const Cable& cable, const double* qpos, const double* qvel,
                    std::span<double> arm_m, double& rate_m_s) noexcept {
  GAUNTLET_ASSERT(arm_m.size() == cable.crossings.size());
  std::ranges::fill(arm_m, 0.0);
  double length = cable.fixed_length_m;
  rate_m_s = 0.0;
  for (const CableSpan& span : cable.spans) {
    const SpanLength now = span.At(qpos[span.qpos]);
    length += now.length_m;
    rate_m_s += now.arm_m * qvel[span.dof];
    if (span.crossing >= 0) arm_m[span.crossing] += now.arm_m;
  }
  return length;
}

bool FindCableSpans(const mjModel& model, const std::vector<HandJoint>& joints,
                    const std::vector<Follower>& followers, std::vector<Drive>& drives) {
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&model), &mj_deleteData);
  if (data == nullptr) throw RunError("not enough memory for the hand's model");
  // All joints at this share of their ranges; 0.5 is the reference.
  const auto look = [&](double share) {
    std::vector<double> angle_rad;
    for (const HandJoint& joint : joints) {
      const double min = joint.limited ? joint.min_rad - kBeyondRangeRad : -std::numbers::pi;
      const double max = joint.limited ? joint.max_rad + kBeyondRangeRad : std::numbers::pi;
      angle_rad.push_back(min + share * (max - min));
    }
    std::ranges::copy(PostureOf(model, joints, angle_rad, followers), data->qpos);
    mj_fwdPosition(&model, data.get());
  };
  look(0.5);
  const SpanFinder finder(model, *data);
  const auto find_all = [&] {
    for (Drive& drive : drives) {
      for (Cable& cable : drive.cables) {
        if (!finder.Find(cable)) return false;
      }
    }
    // Every span is of one joint, so that one posture can test all of them.
    constexpr int kPostures = 65;
    for (int posture = 0; posture < kPostures; ++posture) {
      look(posture / (kPostures - 1.0));
      if (!Agree(model, *data, drives)) return false;
    }
    return true;
  };
  if (find_all()) return true;
  for (Drive& drive : drives) {
    for (Cable& cable : drive.cables) cable.spans.clear();
  }
  return false;
}

}  // namespace gauntlet::sim
