#include "sim/study/counted_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {
namespace {

using Follows = std::vector<bool>;  // per channel

void Join(const Follows& other, Follows& follows) {
  for (std::size_t c = 0; c < follows.size(); ++c) follows[c] = follows[c] || other[c];
}

/// The channels that move a joint of the hand.
Follows ChannelsOf(int joint, const controller::JointMap& joint_map) {
  Follows follows(static_cast<std::size_t>(joint_map.channel_count()));
  for (const controller::JointMap::Term& term : joint_map.terms(joint)) {
    follows[term.channel] = true;
  }
  return follows;
}

}  // namespace

int RecoveryTicks(const Scenario& scenario, double tick_rate_hz) {
  return static_cast<int>(std::lround(scenario.score.recovery_s * tick_rate_hz));
}

std::vector<CountedTicks> CountedTicksOfJoints(std::span<const int> joints,
                                               const controller::JointMap& joint_map,
                                               std::span<const MaskedStretch> masked,
                                               int recovery_ticks, int ticks) {
  std::vector<CountedTicks> counted;
  for (const int joint : joints) {
    counted.push_back(CountTicks(masked, ChannelsOf(joint, joint_map), recovery_ticks, ticks));
  }
  return counted;
}

std::optional<CountedParts> CountedPartsOf(const Study& study,
                                           std::span<const MaskedStretch> masked, int ticks) {
  if (masked.empty()) return std::nullopt;
  const int recovery = RecoveryTicks(study.scenario, study.hand->timing().tick_rate_hz());
  const auto count = [&](const Follows& follows) {
    return CountTicks(masked, follows, recovery, ticks);
  };
  const controller::JointMap joint_map = study.joint_map();
  const controller::TendonTransmission& hand = study.hand->transmission();
  CountedParts counted;
  counted.joints = CountedTicksOfJoints(study.measured_joints, joint_map, masked, recovery, ticks);
  Follows all(study.channel_names().size());
  for (const int joint : study.measured_joints) Join(ChannelsOf(joint, joint_map), all);
  for (const int motor : study.measured_motors) {
    Follows follows(all.size());
    for (int joint = 0; joint < study.joint_count; ++joint) {
      if (hand.coupling[motor * study.joint_count + joint] != 0.0) {
        Join(ChannelsOf(joint, joint_map), follows);
      }
    }
    counted.motors.push_back(count(follows));
    const std::size_t cables = study.hand->drives()[static_cast<std::size_t>(motor)].cables.size();
    counted.cables.insert(counted.cables.end(), cables, counted.motors.back());
  }
  counted.hand = count(all);
  return counted;
}

std::vector<double> CountedShares(const Study& study) {
  std::vector<double> shares(study.measured_joints.size());
  double all = 0.0;
  for (const GloveFacts& facts : study.repetitions) {
    const int ticks = static_cast<int>(facts.ticks);
    const auto counted = CountedPartsOf(study, facts.masked, ticks);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      shares[i] += counted ? CountOf(counted->joints[i]) : ticks;
    }
    all += ticks;
  }
  for (double& share : shares) share /= all;
  return shares;
}

namespace {

/// A verdict on less than that would be one on the rest of a recording.
void CheckShares(const std::vector<double>& shares) {
  constexpr double kLeastShare = 0.2;
  const double mean =
      std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
  if (shares.empty() || mean >= kLeastShare) return;
  throw controller::SettingError(
      "glove.motion",
      fmt::format(
          "{:.0f} % of the recording counts, must be at least {:.0f} %: missing values, "
          "gaps, restarts and sensors at the end of their range are left out; give the part "
          "in which the hand was measured, or correct times and joints of the map",
          100.0 * mean, 100.0 * kLeastShare));
}

}  // namespace

std::string CountedRemark(const Study& study) {
  const auto is_whole = [](const GloveFacts& facts) { return facts.masked.empty(); };
  if (std::ranges::all_of(study.repetitions, is_whole)) return "";
  const std::vector<double> shares = CountedShares(study);
  CheckShares(shares);
  std::map<int, std::vector<std::string>> joints_of_share;  // those that share a gap are one
  for (std::size_t i = 0; i < shares.size(); ++i) {
    joints_of_share[static_cast<int>(100.0 * shares[i])].push_back(study.measured_joint_names[i]);
  }
  std::string text;
  for (const auto& [percent, names] : joints_of_share) {
    const bool all = names.size() == shares.size();
    text += fmt::format("{}{} % of {}", text.empty() ? "" : ", ", percent,
                        all ? "every joint" : fmt::format("{}", fmt::join(names, " ")));
  }
  return fmt::format(
      "scored: {} (gaps and restarts of the recording, {:g} s after each, and clipped samples are "
      "excluded)",
      text, study.scenario.score.recovery_s);
}

}  // namespace gauntlet::sim
