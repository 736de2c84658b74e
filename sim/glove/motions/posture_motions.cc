#include "sim/glove/motions/posture_motions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/base/channels.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/glove/motions/minimum_jerk.h"
#include "sim/glove/motions/postures.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

const std::vector<std::string_view>& ChoiceNames() {
  static const auto kNames = [] {
    std::vector<std::string_view> names = {"as_before"};
    names.insert(names.end(), PostureNames().begin(), PostureNames().end());
    return names;
  }();
  return kNames;
}

/// In a grasp each finger starts this much later than its neighbour to the thumb.
constexpr double kFingerLag_ms = 15.0;

/// How much later than the index finger each channel starts [s].
std::vector<double> FingerLags() {
  std::vector<double> lags;
  for (const Channel& channel : KnownChannels()) {
    double fingers = 0.0;
    if (channel.name.starts_with("middle")) fingers = 1.0;
    if (channel.name.starts_with("ring")) fingers = 2.0;
    if (channel.name.starts_with("little")) fingers = 3.0;
    lags.push_back(1e-3 * kFingerLag_ms * fingers);
  }
  return lags;
}

/// A posture on the way from one to another, kept inside the joints' ranges.
std::vector<double> Between(const std::vector<double>& from, const std::vector<double>& to,
                            double share) {
  std::vector<double> result(from.size());
  for (std::size_t c = 0; c < from.size(); ++c) {
    const Channel& joint = KnownChannels()[c];
    result[c] = std::clamp(from[c] + share * (to[c] - from[c]), joint.min_deg * kRadPerDeg,
                           joint.max_deg * kRadPerDeg);
  }
  return result;
}

void VisitRepeats(controller::SettingsVisitor& visitor, int& repeats) {
  visitor.Integer({"repeats", "how often", 1, 1000}, repeats);
}

void VisitSeconds(controller::SettingsVisitor& visitor, std::string_view key, std::string_view help,
                  double min, double& value) {
  visitor.Number({.key = key, .help = help, .min = min, .max = 60}, value);
}

/// A grasp of the given kind as it turns out this time.
std::vector<double> VariedGrasp(const GraspConfig& config, RandomStream& random) {
  const std::vector<double> open = PostureAngles(PostureIndex("open"));
  const std::vector<double> grasp = PostureAngles(config.grasp);
  const double deviation = 0.01 * config.variation_percent;
  const double together = BoxMuller(random).first;
  std::vector<double> result(grasp.size());
  for (std::size_t c = 0; c < grasp.size(); ++c) {
    // Four fifths of the variance are common to all joints: Santello and others found 80 % in two
    // synergies.
    const double share =
        1.0 + deviation * (std::sqrt(0.8) * together + std::sqrt(0.2) * BoxMuller(random).first);
    result[c] = open[c] + share * (grasp[c] - open[c]);
  }
  BendEndJoints(result);
  return Between(result, result, 0.0);
}

}  // namespace

void HoldConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Choice({"posture", "what is held; as_before is rest at the start"}, ChoiceNames(),
                 posture);
}

Motion MakeMotion(const HoldConfig& config, const MotionContext& context) {
  Motion motion = StillMotion(context.SampleCount(config.duration_s));
  const std::vector<double> angles =
      config.posture == 0 ? context.StartAngles() : PostureAngles(config.posture - 1);
  for (std::size_t channel = 0; channel < angles.size(); ++channel) {
    HoldChannel(channel, angles[channel], motion);
  }
  return motion;
}

void MovesConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Texts({"postures", "one after another; names as in a hold"}, postures);
  VisitSeconds(visitor, "move_s", "duration of each move", 0.01, move_s);
  VisitSeconds(visitor, "hold_s", "how long each posture is held", 0.0, hold_s);
  VisitRepeats(visitor, repeats);
}

Motion MakeMotion(const MovesConfig& config, const MotionContext& context) {
  if (config.postures.empty()) {
    throw controller::SettingError("postures", "is empty, must name at least one posture");
  }
  MovePlan plan(context.StartAngles());
  double now_s = config.hold_s;
  for (int repeat = 0; repeat < config.repeats; ++repeat) {
    for (const std::string& posture : config.postures) {
      plan.MoveTo(now_s, config.move_s, PostureAngles(PostureIndex(posture)));
      now_s += config.move_s + config.hold_s;
    }
  }
  return plan.Fill(context.SampleCount(now_s), context);
}

void GraspConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Choice({"grasp", "which one"}, PostureNames(), grasp);
  VisitRepeats(visitor, repeats);
  VisitSeconds(visitor, "rest_s", "rest before each grasp and at the end", 0.0, rest_s);
  VisitSeconds(visitor, "reach_s", "from rest to the closed grasp", 0.1, reach_s);
  VisitSeconds(visitor, "hold_s", "how long it is held", 0.0, hold_s);
  VisitSeconds(visitor, "release_s", "from the grasp back to rest", 0.1, release_s);
  visitor.Number({"variation_percent",
                  "standard deviation of how far the fingers close, from grasp to grasp", 0, 30},
                 variation_percent);
}

Motion MakeMotion(const GraspConfig& config, const MotionContext& context) {
  const std::vector<double> rest = context.StartAngles();
  const std::vector<double> open = PostureAngles(PostureIndex("open"));
  const std::vector<double> lags = FingerLags();
  MovePlan plan(rest);
  double now_s = config.rest_s;
  for (int repeat = 0; repeat < config.repeats; ++repeat) {
    RandomStream random(context.seed, "motion/grasp",
                        context.StreamIndex(static_cast<std::size_t>(repeat)));
    const std::vector<double> grasp = VariedGrasp(config, random);
    // Opening and closing overlap, so that the hand never stands still at its widest.
    plan.MoveTo(now_s, 0.7 * config.reach_s, Between(rest, open, 0.8));
    plan.MoveTo(now_s + 0.5 * config.reach_s, 0.5 * config.reach_s, grasp, lags);
    now_s += config.reach_s + config.hold_s;
    plan.MoveTo(now_s, config.release_s, rest, lags);
    now_s += config.release_s + config.rest_s;
  }
  return plan.Fill(context.SampleCount(now_s + 3e-3 * kFingerLag_ms), context);
}

void BurstsConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Integer({"bursts", "how many", 1, 1000}, bursts);
  visitor.Integer({"cycles", "closings per burst", 1, 1000}, cycles);
  visitor.Number({"frequency_hz", "closings per second", 0.1, 12}, frequency_hz);
  VisitSeconds(visitor, "pause_s", "rest before each burst and at the end", 0.0, pause_s);
  visitor.Number(
      {"depth_percent", "how far the hand closes, of the way from open to a power grasp", 1, 100},
      depth_percent);
}

Motion MakeMotion(const BurstsConfig& config, const MotionContext& context) {
  const std::vector<double> open = PostureAngles(PostureIndex("open"));
  const std::vector<double> closed =
      Between(open, PostureAngles(PostureIndex("power")), 0.01 * config.depth_percent);
  MovePlan plan(context.StartAngles(PostureIndex("open")));
  const double half_s = 0.5 / config.frequency_hz;
  double now_s = config.pause_s;
  for (int burst = 0; burst < config.bursts; ++burst) {
    for (int cycle = 0; cycle < config.cycles; ++cycle) {
      plan.MoveTo(now_s, half_s, closed);
      plan.MoveTo(now_s + half_s, half_s, open);
      now_s += 2.0 * half_s;
    }
    now_s += config.pause_s;
  }
  return plan.Fill(context.SampleCount(now_s), context);
}

void StepsConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  VisitSeconds(visitor, "period_s", "from one step up to the next", 0.01, period_s);
  VisitRange(visitor, range_percent);
  VisitChannels(visitor, channels);
}

Motion MakeMotion(const StepsConfig& config, const MotionContext& context) {
  const std::vector<bool> selected = SelectChannels(config.channels);
  std::vector<double> low = context.StartAngles();
  std::vector<double> high = low;
  for (std::size_t c = 0; c < low.size(); ++c) {
    if (!selected[c]) continue;
    const Excursion range = ChannelExcursion(c, config.range_percent);
    low[c] = range.middle_rad - range.half_rad;
    high[c] = range.middle_rad + range.half_rad;
  }
  MovePlan plan(low);
  const double half_s = 0.5 * config.period_s;
  for (int step = 0; (step + 0.5) * config.period_s < config.duration_s; ++step) {
    const double now_s = (step + 0.5) * config.period_s;
    plan.MoveTo(now_s, 0.0, high);
    plan.MoveTo(now_s + half_s, 0.0, low);
  }
  return plan.Fill(context.SampleCount(config.duration_s), context);
}

}  // namespace gauntlet::sim
