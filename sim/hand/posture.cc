#include <algorithm>

#include "sim/hand/hand.h"

namespace gauntlet::sim {

void SetPosture(const HandModel& model, std::span<const double> joint_angle_rad,
                std::span<const double> spool_angle_rad, mjData& data) {
  for (std::size_t channel = 0; channel < model.channel_qpos_.size(); ++channel) {
    data.qpos[model.channel_qpos_[channel]] = joint_angle_rad[channel];
  }
  for (std::size_t motor = 0; motor < model.drives_.size(); ++motor) {
    data.qpos[model.drives_[motor].spool_qpos] = spool_angle_rad[motor];
  }
  for (const Follower& follower : model.followers_) {
    data.qpos[follower.qpos] = follower.Angle(data.qpos[follower.leader_qpos]);
  }
  // All that drawing needs: bodies, lights and cameras, cables.
  mj_kinematics(&model.model(), &data);
  mj_comPos(&model.model(), &data);
  mj_camlight(&model.model(), &data);
  mj_tendon(&model.model(), &data);
}

void SetObjectPose(const HandModel& model, std::span<const double> pose, mjData& data) {
  if (model.grasp().exists()) std::copy_n(pose.begin(), 7, data.qpos + model.grasp().qpos);
}

}  // namespace gauntlet::sim
