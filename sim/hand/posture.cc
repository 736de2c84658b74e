#include "sim/hand/posture.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "controller/assert.h"

namespace gauntlet::sim {

void SetPosture(const HandModel& model, std::span<const double> joint_angle_rad,
                std::span<const double> spool_angle_rad, mjData& data) {
  GAUNTLET_ASSERT(joint_angle_rad.size() == model.joints().size());
  GAUNTLET_ASSERT(spool_angle_rad.size() == model.drives().size());
  for (std::size_t i = 0; i < model.joints().size(); ++i) {
    data.qpos[model.joints()[i].qpos] = joint_angle_rad[i];
  }
  for (std::size_t motor = 0; motor < model.drives().size(); ++motor) {
    const int spool = model.drives()[motor].spool_qpos;
    if (spool >= 0) data.qpos[spool] = spool_angle_rad[motor];
  }
  for (const Follower& follower : model.followers()) {
    data.qpos[follower.qpos] = follower.Angle(data.qpos[follower.leader_qpos]);
  }
  // All that drawing needs: bodies, lights and cameras, cables.
  mj_kinematics(&model.model(), &data);
  mj_comPos(&model.model(), &data);
  mj_camlight(&model.model(), &data);
  mj_tendon(&model.model(), &data);
}

void SetObjectPose(const HandModel& model, std::span<const double> pose, mjData& data) {
  GAUNTLET_ASSERT(!model.grasp().exists() || pose.size() == 7);
  if (model.grasp().exists()) std::copy_n(pose.begin(), 7, data.qpos + model.grasp().qpos);
}

}  // namespace gauntlet::sim
