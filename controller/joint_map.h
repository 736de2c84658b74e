#pragma once

#include <span>
#include <string>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

struct TendonTransmission;

/// Source of the angle of one joint of the hand.
///
///     joint_angle = offset + sum_i weight_i channel_angle_i
///
/// One channel of weight 1 is the plain copy; several make a synergy; none holds the joint at
/// `offset_deg`.
struct GAUNTLET_API JointSource {
  std::string joint;
  std::vector<std::string> channels;
  std::vector<double> weights = {1.0};  // one for all channels, or one for each
  double offset_deg = 0.0;

  void Visit(SettingsVisitor& visitor);
};

/// Map from the glove's channels to the hand's joints, as a person sets it. A joint that is not
/// named here follows the channel of its own name; where the glove has none it keeps its reference
/// angle.
struct GAUNTLET_API JointMapConfig {
  std::vector<JointSource> joints;

  /// The joints are the keys, without a group around them.
  void Visit(SettingsVisitor& visitor, const Setting& setting);
};

/// From the bending angles of the glove's channels to the angles wanted of the hand's joints.
///
///     joint = W channel + offset        (W: joints x channels, most of it 0)
///
/// Shapes: one value per channel in, one per joint out. Units: rad.
/// Errors: SettingError for a joint or a channel that there is not or that is named twice, weights
/// that do not fit, and a joint that is held outside its range.
class GAUNTLET_API JointMap {
 public:
  JointMap(const JointMapConfig& config, const std::vector<std::string>& channel_names,
           const TendonTransmission& hand);

  int channel_count() const noexcept { return channel_count_; }
  int joint_count() const noexcept { return static_cast<int>(joints_.size()); }

  void ToJoints(std::span<const double> channel_angle_rad,
                std::span<double> joint_angle_rad) const noexcept;
  /// Share of a channel in a joint's angle.
  struct Term {
    int channel = 0;
    double weight = 1.0;
  };
  /// The two parts of a joint's angle.
  double offset_rad(int joint) const noexcept { return joints_[Place(joint)].offset_rad; }
  std::span<const Term> terms(int joint) const noexcept { return joints_[Place(joint)].terms; }
  /// True if any channel moves this joint; else it holds one posture.
  bool measured(int joint) const noexcept { return !joints_[Place(joint)].terms.empty(); }
  /// The posture of the glove that lets each joint rest at `joint_angle_rad` as far as one channel
  /// decides it; a channel that decides none keeps its value.
  void ToChannels(std::span<const double> joint_angle_rad,
                  std::span<double> channel_angle_rad) const noexcept;

 private:
  struct Joint {
    double offset_rad = 0.0;
    std::vector<Term> terms;
  };
  static std::size_t Place(int index) noexcept { return static_cast<std::size_t>(index); }

  int channel_count_;
  std::vector<Joint> joints_;
};

}  // namespace gauntlet::controller
