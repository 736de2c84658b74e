#include "sim/hand/hand_joint.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "controller/assert.h"

namespace gauntlet::sim {

std::vector<HandJoint> FindJoints(const mjModel& model, const std::vector<Follower>& followers,
                                  const std::vector<int>& spool_qpos) {
  std::vector<HandJoint> joints;
  for (int index = 0; index < model.njnt; ++index) {
    const int qpos = model.jnt_qposadr[index];
    const bool simple =
        model.jnt_type[index] == mjJNT_HINGE || model.jnt_type[index] == mjJNT_SLIDE;
    const bool spool = std::ranges::find(spool_qpos, qpos) != spool_qpos.end();
    const bool follows = std::ranges::find(followers, qpos, &Follower::qpos) != followers.end();
    if (!simple || spool || follows) continue;
    const char* name = mj_id2name(&model, mjOBJ_JOINT, index);
    joints.push_back({.name = name == nullptr ? "" : name,
                      .joint = index,
                      .qpos = qpos,
                      .dof = model.jnt_dofadr[index],
                      .min_rad = model.jnt_range[2 * index],
                      .max_rad = model.jnt_range[2 * index + 1],
                      .limited = model.jnt_limited[index] != 0});
  }
  return joints;
}

std::vector<double> PostureOf(const mjModel& model, const std::vector<HandJoint>& joints,
                              const std::vector<double>& joint_angle_rad,
                              const std::vector<Follower>& followers) {
  GAUNTLET_ASSERT(joint_angle_rad.size() == joints.size());
  std::vector<double> qpos(model.qpos0, model.qpos0 + model.nq);
  for (std::size_t i = 0; i < joints.size(); ++i) qpos[joints[i].qpos] = joint_angle_rad[i];
  for (const Follower& follower : followers) {
    qpos[follower.qpos] = follower.Angle(qpos[follower.leader_qpos]);
  }
  return qpos;
}

}  // namespace gauntlet::sim
