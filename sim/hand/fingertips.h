#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/hand/hand_kinematics.h"
#include "sim/hand/hand_model.h"

namespace gauntlet::sim {

/// Fingertips of a HandModel as functions of the angles of its joints: the digits and tips of
/// HandKinematics, in the frame of the palm's body. From palm to tip a product of rigid motions, as
/// the engine multiplies them, without its other bodies: a microsecond for a hand. Constant, shared
/// by all threads.
class Fingertips {
 public:
  /// Null for a hand whose digits HandKinematics does not find, and where a joint between palm and
  /// tip is none of the hand's: then its angle is not known.
  static std::shared_ptr<const Fingertips> Of(const HandModel& hand,
                                              const HandKinematics::FingerOfName& finger_of);

  /// Those that exist, thumb first.
  const std::vector<std::string>& names() const { return names_; }
  /// True if a joint of the hand, or one that it leads, moves the tip against the palm.
  bool Moves(int joint, std::size_t tip) const { return moves_[tip][joint]; }
  /// Row n is tick n * ticks_per_row. Shapes: ticks x joints in; x, y, z of each tip out. Units:
  /// rad in, m out.
  Signal Places(const Signal& joint_angle_rad, Eigen::Index ticks_per_row) const;

 private:
  struct Turn {
    int joint = 0;  // its number among those of the hand, or that of its leader
    bool follows = false;
    Follower follower = {};
    bool slides = false;
    double zero_rad = 0.0;  // or m
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();
  };
  /// A body as its parent carries it, with its joints.
  struct Link {
    Eigen::Vector3d place_m;
    Eigen::Quaterniond attitude;
    std::vector<Turn> turns;
  };
  /// From the palm outwards.
  struct Chain {
    std::vector<Link> links;
    Eigen::Vector3d tip_in_body_m;
  };

  Fingertips(const HandModel& hand, const HandKinematics& kinematics);
  static Link LinkOf(const HandModel& hand, int body);
  template <class Row>
  static Eigen::Vector3d TipOf(const Chain& chain, const Row& joint_rad);

  std::vector<std::string> names_;
  std::vector<Chain> chains_;
  std::vector<std::vector<bool>> moves_;  // per tip and joint
};

}  // namespace gauntlet::sim
