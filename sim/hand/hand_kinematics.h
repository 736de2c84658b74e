#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/hand/digits.h"
#include "sim/hand/engine_types.h"
#include "sim/hand/follower.h"
#include "sim/hand/hand_joint.h"

namespace gauntlet::sim {

class HandModel;

/// Places of fingertips as a function of joint angles, for any hand that the engine loads: motors
/// and cables are not needed. One per thread.
///
/// Frame of all places and directions, so that those of two hands can be compared: x along the
/// straight fingers, y from the little finger's side to the thumb's, z out of the back of the hand;
/// fixed to the palm. A left hand has a left-handed frame and so the numbers of its mirror image.
/// The palm is the last body that carries all fingertips. A digit's tip is the outer end of the
/// axis of its last capsule; without capsules a site or geom called "tip", else the geom farthest
/// out. Its base is the knuckle (MCP), of the thumb the first joint.
/// Units: m, rad. Errors: UserError with the file if the thumb or two fingers are missing, or if
/// a joint that moves a fingertip has no name or no range.
class HandKinematics {
 public:
  enum Finger { kThumb, kIndex, kMiddle, kRing, kLittle, kFingers };
  static constexpr std::array<std::string_view, kFingers> kFingerNames = {
      "thumb", "index", "middle", "ring", "little"};
  /// One of kFingerNames, or empty, for a word of a joint's name.
  using FingerOfName = std::function<std::string_view(std::string_view name)>;

  struct Digit {
    bool exists = false;
    Eigen::Vector3d base_m = Eigen::Vector3d::Zero();
    double length_m = 0.0;                                           // base to tip along the joints
    double tip_radius_m = std::numeric_limits<double>::quiet_NaN();  // of the last capsule
    int tip_body = 0;
    int tip_geom = -1;  // the last capsule
    Eigen::Vector3d tip_in_body_m = Eigen::Vector3d::Zero();
    std::vector<int> hinges = {};  // of the model, from the tip to the palm
  };

  /// `key`: the option that names the file, for messages.
  HandKinematics(const std::filesystem::path& model, const std::string& key,
                 const FingerOfName& finger_of);
  HandKinematics(const HandModel& hand, const FingerOfName& finger_of);
  ~HandKinematics();
  HandKinematics(const HandKinematics&) = delete;
  HandKinematics& operator=(const HandKinematics&) = delete;

  const std::string& file() const { return file_; }
  /// Parts of the file that were left out, see ReadModelText().
  const std::vector<std::string>& notes() const { return notes_; }
  const std::array<Digit, kFingers>& digits() const { return digits_; }
  int palm() const { return palm_; }  // body of the model
  /// Those that move a fingertip against the palm, in the model's order; followers are led.
  const std::vector<HandJoint>& joints() const { return joints_; }
  /// Names of all other joints, but those of spools and those that follow.
  const std::vector<std::string>& other_joint_names() const { return other_joint_names_; }
  /// True if the joint moves the tip of the digit.
  bool Moves(std::size_t joint, int finger) const { return moves_[joint][finger]; }
  /// Per joint: 0, or the end of the range next to it.
  std::vector<double> NeutralAngles() const;

  /// Angles [rad, per joint]; what follows applies to this posture.
  void SetAngles(std::span<const double> angle_rad);
  Eigen::Vector3d Tip(int finger) const;
  /// Unit vector from the last joint of a digit to its tip.
  Eigen::Vector3d TipDirection(int finger) const;
  /// d Tip / d angle. Shape: 3 x joints.
  Eigen::Matrix3Xd TipDerivative(int finger) const;
  Eigen::Matrix3Xd TipDirectionDerivative(int finger) const;
  bool has_capsules() const { return capsules_.exist(); }
  /// Gaps between digits below `below_m`.
  void FindGaps(double below_m, std::vector<Digits::Gap>& gaps) const;
  /// Gap between the last phalanges of the thumb and a finger; none without capsules.
  std::optional<Digits::Gap> PinchGap(int finger) const;
  /// d gap / d angle. Shape: joints.
  Eigen::RowVectorXd GapDerivative(const Digits::Gap& gap) const;
  /// Deepest interpenetration of two digits [m].
  double Overlap() const;

 private:
  void FindParts(const FingerOfName& finger_of);
  void FindDigits(const FingerOfName& finger_of);
  void FindTip(Digit& digit) const;
  void FindJoints();
  void FindFrame();
  void Measure(int finger);
  Eigen::Vector3d Anchor(int hinge) const;  // in the world
  Eigen::Vector3d TipInWorld(const Digit& digit) const;
  Eigen::Matrix3Xd PointDerivative(int body, const Eigen::Vector3d& point_m) const;  // in the world
  [[noreturn]] void Fail(const std::string& problem) const;

  std::string file_;
  std::vector<std::string> notes_;
  std::unique_ptr<mjModel_, void (*)(mjModel_*)> model_;
  std::unique_ptr<mjData_, void (*)(mjData_*)> data_;
  std::array<Digit, kFingers> digits_;
  int palm_ = 0;
  Digits capsules_;
  std::vector<Follower> followers_;
  std::vector<HandJoint> joints_;
  std::vector<std::string> other_joint_names_;
  std::vector<std::array<bool, kFingers>> moves_;
  Eigen::Matrix3d to_frame_ = Eigen::Matrix3d::Identity();  // from the world
  Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();      // of the frame, in the world
};

}  // namespace gauntlet::sim
