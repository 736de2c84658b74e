#include "sim/hand/cable_path.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "controller/assert.h"
#include "sim/base/error.h"
#include "sim/hand/mujoco_versions.h"

namespace gauntlet::sim {
namespace {

/// A joint that moves a cable by less than this per radian is not on its way.
constexpr double kSmallestArmM = 1e-6;

void Forward(const mjModel& model, mjData& data, const std::vector<double>& qpos) {
  std::copy(qpos.begin(), qpos.end(), data.qpos);
  mj_fwdPosition(&model, &data);
}

/// Angle between the directions from a to b and from c to d.
double AngleBetween(const mjtNum* a, const mjtNum* b, const mjtNum* c, const mjtNum* d) {
  mjtNum first[3], second[3], normal[3];
  mju_sub3(first, b, a);
  mju_sub3(second, d, c);
  mju_cross(normal, first, second);
  return std::atan2(mju_norm3(normal), mju_dot3(first, second));
}

}  // namespace

bool Turns(const mjModel& model, int joint, int body) {
  while (body > 0 && body != model.jnt_bodyid[joint]) body = model.body_parentid[body];
  return body > 0;
}

double MomentArm(const mjModel& model, const mjData& data, int tendon, int dof) noexcept {
  GAUNTLET_ASSERT(0 <= tendon && tendon < model.ntendon);
  GAUNTLET_ASSERT(0 <= dof && dof < model.nv);
  const TendonRow row = RowOf(model, data, tendon);
  if (row.dof == nullptr) return row.arm_m[dof];
  for (int index = 0; index < row.count; ++index) {
    if (row.dof[index] == dof) return row.arm_m[index];
  }
  return 0.0;
}

CablePaths::CablePaths(const mjModel& model, const std::vector<HandJoint>& joints,
                       const std::vector<Follower>& followers)
    : model_(model),
      data_(mj_makeData(&model), &mj_deleteData),
      largest_arm_m_(static_cast<std::size_t>(model.ntendon) * model.nv) {
  if (data_ == nullptr) throw RunError("not enough memory for the hand's model");
  std::vector<double> reference_rad;
  for (const HandJoint& joint : joints) reference_rad.push_back(joint.reference_rad());
  const auto look = [&](const std::vector<double>& joint_angle_rad) {
    Forward(model, *data_, PostureOf(model, joints, joint_angle_rad, followers));
    for (int tendon = 0; tendon < model.ntendon; ++tendon) {
      for (int dof = 0; dof < model.nv; ++dof) {
        double& largest = largest_arm_m_[static_cast<std::size_t>(tendon) * model.nv + dof];
        largest = std::max(largest, std::abs(MomentArm(model, *data_, tendon, dof)));
      }
    }
  };
  // Arms that vanish at the reference may show at the ends of a joint's range.
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!joints[i].limited) continue;
    for (const double end_rad : {joints[i].min_rad, joints[i].max_rad}) {
      std::vector<double> angle = reference_rad;
      angle[i] = end_rad;
      look(angle);
    }
  }
  look(reference_rad);
}

bool CablePaths::Passes(int tendon, int dof) const {
  return largest_arm_m_[static_cast<std::size_t>(tendon) * model_.nv + dof] > kSmallestArmM;
}

/// The points where the cable touches something, from `begin` to before `end`.
std::vector<CablePaths::Bend> CablePaths::BendsOf(int begin, int end) const {
  const auto point = [&](int index) { return data_->wrap_xpos + 3 * index; };
  std::vector<Bend> bends;
  for (int index = begin + 1; index + 1 < end; ++index) {
    // On a pulley two points, where the cable touches it first and last, share the pulley's id.
    const bool pulley = data_->wrap_obj[index] >= 0 && index + 2 < end &&
                        data_->wrap_obj[index] == data_->wrap_obj[index + 1];
    const int last = pulley ? index + 1 : index;
    Bend bend{
        .position = {},
        .angle_rad = AngleBetween(point(index - 1), point(index), point(last), point(last + 1))};
    for (int k = 0; k < 3; ++k) bend.position[k] = 0.5 * (point(index)[k] + point(last)[k]);
    bends.push_back(bend);
    index = last;
  }
  return bends;
}

/// True if the joint turns some of the model's guides from `begin` to before `end`, and not others.
bool CablePaths::Passes(int begin, int end, int joint) const {
  bool turned = false;
  bool rests = false;
  for (int index = begin; index < end; ++index) {
    const int object = model_.wrap_objid[index];
    if (model_.wrap_type[index] == mjWRAP_JOINT) {
      if (object == joint) return true;
      continue;
    }
    const bool site = model_.wrap_type[index] == mjWRAP_SITE;
    const bool turns =
        Turns(model_, joint, site ? model_.site_bodyid[object] : model_.geom_bodyid[object]);
    (turns ? turned : rests) = true;
  }
  return turned && rests;
}

/// Fills crossings and bends of the last branch: guides of the model from `begin` to before `end`.
void CablePaths::TraceBranch(int begin, int end, const std::vector<Bend>& bends,
                             Cable& cable) const {
  CableBranch& branch = cable.branches.back();
  std::vector<std::pair<std::size_t, Crossing>> found;  // with the bend at which the joint is
  for (int joint = 0; joint < model_.njnt; ++joint) {
    const int dof = model_.jnt_dofadr[joint];
    const bool hinge = model_.jnt_type[joint] == mjJNT_HINGE;
    if (!(hinge || model_.jnt_type[joint] == mjJNT_SLIDE) || !Passes(cable.tendon, dof)) continue;
    if (!Passes(begin, end, joint)) continue;
    if (std::ranges::find(cable.crossings, dof, &Crossing::dof) != cable.crossings.end()) {
      if (cable.cord.friction_coefficient == 0.0) continue;
      throw UserError(
          {.key = "hand.cable.capstan_friction",
           .problem = fmt::format("must be 0: two branches of cable '{}' of the model "
                                  "pass joint '{}'",
                                  cable.name, JointNameAt(model_, model_.jnt_qposadr[joint]))});
    }
    const double arm = MomentArm(model_, *data_, cable.tendon, dof);
    Crossing crossing{.dof = dof,
                      .qpos = model_.jnt_qposadr[joint],
                      .moment_arm_m = arm,
                      .bend_per_rad = hinge ? std::copysign(1.0, arm) : 0.0,
                      .branch = static_cast<int>(cable.branches.size()) - 1};
    crossing.reference_rad = data_->qpos[crossing.qpos];
    const mjtNum* anchor = data_->xanchor + 3 * joint;
    const auto nearest = std::min_element(bends.begin(), bends.end(), [&](auto& a, auto& b) {
      return mju_dist3(a.position, anchor) < mju_dist3(b.position, anchor);
    });
    found.emplace_back(nearest - bends.begin(), crossing);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });

  double bent = branch.parent < 0 ? 0.0 : cable.branches[branch.parent].bend_rad;
  std::size_t next = 0;
  for (std::size_t index = 0; index < bends.size() || next < found.size(); ++index) {
    if (index < bends.size()) bent += bends[index].angle_rad;
    for (; next < found.size() && found[next].first == index; ++next) {
      found[next].second.bend_rad = bent;
      cable.crossings.push_back(found[next].second);
    }
  }
  branch.bend_rad = bent;
}

void CablePaths::Trace(Cable& cable) const {
  cable.natural_length_m = data_->ten_length[cable.tendon];
  const int last = model_.tendon_adr[cable.tendon] + model_.tendon_num[cable.tendon];
  const int last_point = data_->ten_wrapadr[cable.tendon] + data_->ten_wrapnum[cable.tendon];
  std::vector<double> divisors;
  double divisor = 1.0;
  int point = data_->ten_wrapadr[cable.tendon];
  for (int begin = model_.tendon_adr[cable.tendon]; begin < last;) {
    if (model_.wrap_type[begin] == mjWRAP_PULLEY) {
      divisor = model_.wrap_prm[begin++];
      ++point;
    }
    const auto end_of = [](const int* values, int from, int to, int pulley) {
      return static_cast<int>(std::find(values + from, values + to, pulley) - values);
    };
    const int end = end_of(model_.wrap_type, begin, last, mjWRAP_PULLEY);
    constexpr int kPulleyPoint = -2;
    const int end_point = end_of(data_->wrap_obj, point, last_point, kPulleyPoint);
    // An undivided cable goes on; a divided one hangs on the last branch that is divided less.
    int parent = static_cast<int>(divisors.size()) - 1;
    while (parent >= 0 && divisor > 1.0 && divisors[parent] >= divisor) --parent;
    divisors.push_back(divisor);
    cable.branches.push_back({.parent = parent});
    TraceBranch(begin, end, BendsOf(point, end_point), cable);
    begin = end;
    point = end_point;
  }
}

}  // namespace gauntlet::sim
