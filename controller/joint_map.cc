#include "controller/joint_map.h"

#include <algorithm>

#include "controller/angle.h"
#include "controller/assert.h"
#include "controller/controller_config.h"

namespace gauntlet::controller {
namespace {

/// An end of a joint's range that was written in degrees is still in it.
constexpr double kRounding_deg = 1e-9;

/// Place of a name in a list, or -1.
int IndexOf(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void JointSource::Visit(SettingsVisitor& visitor) {
  visitor.Texts({.key = "channels",
                 .help = "channels of the glove that move the joint; []: it holds offset_deg",
                 .required = true},
                channels);
  visitor.Numbers(
      {"weights", "how far each channel moves it [deg per deg], one for all or one for each", -100,
       100},
      weights);
  visitor.Number({"offset_deg", "added to the joint's angle", -360, 360}, offset_deg);
}

void JointMapConfig::Visit(SettingsVisitor& visitor, const Setting& setting) {
  visitor.Map(setting,
              {.size = [this] { return joints.size(); },
               .name = [this](std::size_t i) { return joints[i].joint; },
               .add = [this](const std::string& added) { joints.emplace_back().joint = added; },
               .visit = [this](std::size_t i, SettingsVisitor& inner) { joints[i].Visit(inner); }});
}

JointMap::JointMap(const JointMapConfig& config, const std::vector<std::string>& channel_names,
                   const TendonTransmission& hand)
    : channel_count_(static_cast<int>(channel_names.size())) {
  for (std::size_t i = 0; i < hand.reference_angle_rad.size(); ++i) {
    Joint& joint = joints_.emplace_back();
    const int channel =
        i < hand.joint_names.size() ? IndexOf(channel_names, hand.joint_names[i]) : -1;
    if (channel >= 0) {
      joint.terms.push_back({.channel = channel, .weight = 1.0});
    } else {
      joint.offset_rad = hand.reference_angle_rad[i];
    }
  }
  std::vector<std::string> named;
  for (const JointSource& source : config.joints) {
    const int index = IndexOf(hand.joint_names, source.joint);
    if (index < 0) {
      throw SettingError(source.joint,
                         "is not a joint of the hand, which has " + Joined(hand.joint_names));
    }
    if (IndexOf(named, source.joint) >= 0) throw SettingError(source.joint, "appears twice");
    named.push_back(source.joint);
    if (source.weights.size() != 1 && source.weights.size() != source.channels.size()) {
      throw SettingError(source.joint + ".weights",
                         "has " + std::to_string(source.weights.size()) +
                             " values, must have 1 for all channels or " +
                             std::to_string(source.channels.size()) + ", one for each");
    }
    if (!source.channels.empty() && std::ranges::count(source.weights, 0.0) > 0) {
      throw SettingError(source.joint + ".weights",
                         "has a 0, must name only channels that move the joint");
    }
    Joint& joint = joints_[Place(index)];
    joint = {.offset_rad = source.offset_deg * kRadPerDeg, .terms = {}};
    if (source.channels.empty()) {
      const double min_deg = hand.joint_min_rad[Place(index)] / kRadPerDeg;
      const double max_deg = hand.joint_max_rad[Place(index)] / kRadPerDeg;
      if (source.offset_deg < min_deg - kRounding_deg ||
          source.offset_deg > max_deg + kRounding_deg) {
        throw SettingError(source.joint + ".offset_deg",
                           "holds the joint at " + NumberText(source.offset_deg) +
                               ", must be in its range of " + NumberText(min_deg) + " to " +
                               NumberText(max_deg));
      }
    }
    for (std::size_t k = 0; k < source.channels.size(); ++k) {
      const int channel = IndexOf(channel_names, source.channels[k]);
      if (channel < 0) {
        throw SettingError(source.joint + ".channels",
                           source.channels[k] + " is not a channel of the glove, which has " +
                               Joined(channel_names));
      }
      if (std::ranges::find(joint.terms, channel, &Term::channel) != joint.terms.end()) {
        throw SettingError(
            source.joint + ".channels",
            "has " + source.channels[k] + " twice, must have it once, with the sum of its weights");
      }
      joint.terms.push_back(
          {.channel = channel, .weight = source.weights[source.weights.size() == 1 ? 0 : k]});
    }
  }
}

void JointMap::ToJoints(std::span<const double> channel_angle_rad,
                        std::span<double> joint_angle_rad) const noexcept {
  GAUNTLET_ASSERT(std::ssize(channel_angle_rad) == channel_count_);
  GAUNTLET_ASSERT(joint_angle_rad.size() == joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    double angle = joints_[i].offset_rad;  // offset + W channel
    for (const Term& term : joints_[i].terms) {
      angle += term.weight * channel_angle_rad[Place(term.channel)];
    }
    joint_angle_rad[i] = angle;
  }
}

void JointMap::ToChannels(std::span<const double> joint_angle_rad,
                          std::span<double> channel_angle_rad) const noexcept {
  GAUNTLET_ASSERT(joint_angle_rad.size() == joints_.size());
  GAUNTLET_ASSERT(std::ssize(channel_angle_rad) == channel_count_);
  for (std::size_t i = joints_.size(); i-- > 0;) {  // the first joint that a channel moves decides
    const Joint& joint = joints_[i];
    if (joint.terms.size() != 1 || joint.terms[0].weight == 0.0) continue;
    channel_angle_rad[Place(joint.terms[0].channel)] =
        (joint_angle_rad[i] - joint.offset_rad) / joint.terms[0].weight;
  }
}

}  // namespace gauntlet::controller
