#include "sim/hand/fingertips.h"

#include <mujoco/mujoco.h>

#include <algorithm>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

using Eigen::AngleAxisd;
using Eigen::Index;
using Eigen::Quaterniond;
using Eigen::Vector3d;

}  // namespace

std::shared_ptr<const Fingertips> Fingertips::Of(const HandModel& hand,
                                                 const HandKinematics::FingerOfName& finger_of) {
  try {
    const HandKinematics kinematics(hand, finger_of);
    return std::shared_ptr<const Fingertips>(new Fingertips(hand, kinematics));
  } catch (const UserError&) {
    return nullptr;
  }
}

Fingertips::Link Fingertips::LinkOf(const HandModel& hand, int body) {
  const mjModel& model = hand.model();
  const mjtNum* attitude = model.body_quat + 4 * body;
  Link link{.place_m = Eigen::Map<const Vector3d>(model.body_pos + 3 * body),
            .attitude = {attitude[0], attitude[1], attitude[2], attitude[3]},
            .turns = {}};
  for (int i = 0; i < model.body_jntnum[body]; ++i) {
    const int index = model.body_jntadr[body] + i;
    const int qpos = model.jnt_qposadr[index];
    const auto follower = std::ranges::find(hand.followers(), qpos, &Follower::qpos);
    const bool follows = follower != hand.followers().end();
    const int recorded_qpos = follows ? follower->leader_qpos : qpos;
    const auto joint = std::ranges::find(hand.joints(), recorded_qpos, &HandJoint::qpos);
    if (joint == hand.joints().end()) throw UserError("a joint of a finger is not the hand's");
    link.turns.push_back({.joint = static_cast<int>(joint - hand.joints().begin()),
                          .follows = follows,
                          .follower = follows ? *follower : Follower{},
                          .slides = model.jnt_type[index] == mjJNT_SLIDE,
                          .zero_rad = model.qpos0[qpos],
                          .axis = Eigen::Map<const Vector3d>(model.jnt_axis + 3 * index),
                          .anchor_m = Eigen::Map<const Vector3d>(model.jnt_pos + 3 * index)});
  }
  return link;
}

Fingertips::Fingertips(const HandModel& hand, const HandKinematics& kinematics) {
  for (std::size_t finger = 0; finger < kinematics.digits().size(); ++finger) {
    const HandKinematics::Digit& digit = kinematics.digits()[finger];
    if (!digit.exists) continue;
    Chain chain{.links = {}, .tip_in_body_m = digit.tip_in_body_m};
    std::vector<bool> moves(hand.joints().size(), false);
    for (int body = digit.tip_body; body != kinematics.palm();
         body = hand.model().body_parentid[body]) {
      chain.links.push_back(LinkOf(hand, body));
      for (const Turn& turn : chain.links.back().turns) moves[turn.joint] = true;
    }
    std::ranges::reverse(chain.links);
    names_.emplace_back(HandKinematics::kFingerNames[finger]);
    chains_.push_back(std::move(chain));
    moves_.push_back(std::move(moves));
  }
}

template <class Row>
Vector3d Fingertips::TipOf(const Chain& chain, const Row& joint_rad) {
  Vector3d place = Vector3d::Zero();
  Quaterniond attitude = Quaterniond::Identity();
  for (const Link& link : chain.links) {
    place += attitude * link.place_m;
    attitude = attitude * link.attitude;
    for (const Turn& turn : link.turns) {
      double moved = joint_rad(turn.joint);
      if (turn.follows) moved = turn.follower.Angle(moved);
      moved -= turn.zero_rad;
      if (turn.slides) {
        place += attitude * (moved * turn.axis);
        continue;
      }
      const Vector3d anchor = place + attitude * turn.anchor_m;
      attitude = attitude * Quaterniond(AngleAxisd(moved, turn.axis));
      place = anchor - attitude * turn.anchor_m;
    }
  }
  return place + attitude * chain.tip_in_body_m;
}

Signal Fingertips::Places(const Signal& joint_angle_rad, Index ticks_per_row) const {
  const Index rows = (joint_angle_rad.rows() + ticks_per_row - 1) / ticks_per_row;
  Signal places(rows, 3 * std::ssize(chains_));
  Eigen::RowVectorXd joint_rad(joint_angle_rad.cols());
  for (Index row = 0; row < rows; ++row) {
    if (row % kTrimRows == 0) TrimSignals();
    joint_rad = joint_angle_rad.row(row * ticks_per_row);
    for (Index tip = 0; tip < std::ssize(chains_); ++tip) {
      places.row(row).segment<3>(3 * tip) =
          TipOf(chains_[static_cast<std::size_t>(tip)], joint_rad).transpose();
    }
  }
  return places;
}

}  // namespace gauntlet::sim
