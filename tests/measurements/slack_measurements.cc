#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "controller/slack_detector.h"
#include "sim/base/normal_pair.h"
#include "tests/hand/hand_fixture.h"
#include "tests/measurements/hand_measurements.h"

namespace gauntlet::sim::testing {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kReadingTicks = 10;      // a bus tells angle and torque 100 times per second
constexpr double kTorqueNoise = 0.02;  // of the stall torque: an assumption, current is measured
constexpr double kAngleStep_deg = 360.0 / 4096;

/// A wearer who does something else every 4 s: all joints to new places within 0.5 to 2 s, then
/// rest, or sway.
class Motion {
 public:
  Motion(const controller::TendonTransmission& map, std::uint64_t seed)
      : map_(map), random_(seed, "slack motion"), from_(HomePosture(map)), to_(from_) {}

  std::vector<double> At(int tick) {
    const int within = tick % 4000;
    if (within == 0) {
      from_ = to_;
      to_ = RandomPosture(map_, random_);
      move_s_ = random_.Uniform(0.5, 2.0);
      sway_ = random_.Uniform() < 0.5 ? 0.0 : 0.1;
    }
    const double share = std::min(1.0, within * 1e-3 / move_s_);
    const double smooth = share * share * share * (10.0 + share * (6.0 * share - 15.0));
    std::vector<double> angle_rad(from_);
    for (std::size_t i = 0; i < angle_rad.size(); ++i) {
      const double sway = sway_ * std::sin(kTwoPi * 0.5 * within * 1e-3);
      angle_rad[i] += smooth * (to_[i] - from_[i]) + sway;
    }
    return angle_rad;
  }

 private:
  const controller::TendonTransmission& map_;
  RandomStream random_;
  std::vector<double> from_;
  std::vector<double> to_;
  double move_s_ = 1.0;
  double sway_ = 0.0;
};

/// What a detector sees of a hand that moves so long.
template <class See>
void Watch(const HandConfig& config, std::uint64_t seed, int seconds,
           controller::SlackDetector& detector, See see) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  Motion motion(map, seed);
  RandomStream noise(seed, "torque noise");
  hand.Reset(HomePosture(map));
  std::vector<double> angle_rad(map.motor_names.size()), torque_nm(angle_rad.size()),
      now_nm(torque_nm), sum_nm(torque_nm);
  for (int tick = 0; tick < 1000 * seconds; ++tick) {
    const std::vector<double> told = motion.At(tick);
    if (tick % 20 == 0) hand.SetCommand(CountsFor(map, told));
    hand.Step();
    hand.ReadServoTorques(now_nm);
    for (std::size_t i = 0; i < now_nm.size(); ++i) sum_nm[i] += now_nm[i] / kReadingTicks;
    if ((tick + 1) % kReadingTicks != 0) continue;
    hand.ReadSpoolAngles(angle_rad);
    torque_nm.swap(sum_nm);
    std::ranges::fill(sum_nm, 0.0);
    for (std::size_t i = 0; i < angle_rad.size(); ++i) {
      const double step_rad = kAngleStep_deg * kRadPerDeg;
      angle_rad[i] = step_rad * std::round(angle_rad[i] / step_rad);
      torque_nm[i] += kTorqueNoise * hand.hand_model().drives()[i].servo.stall_torque_nm *
                      BoxMuller(noise).first;
    }
    detector.Step(angle_rad, torque_nm);
    see(tick);
  }
  if (!hand.health().ok) fmt::print("stopped: {}\n", hand.health().problem);
}

struct Found {
  int slack_motors = 0;      // of 18, with slack in all their cables
  double slowest_s = 0.0;    // of those, from the first motion on
  int false_alarms = 0;      // with healthy cables
  double least_share = 1e9;  // of the healthy friction, at any time with healthy cables
  std::vector<std::string> missed;
};

Found Detect(const ServoConfig& servo, int healthy_s) {
  HandConfig healthy;
  healthy.servo = servo;
  const int motors = static_cast<int>(GloveChannels().size());
  controller::SlackDetectorConfig config;
  controller::SlackDetector first(config, motors);
  Watch(healthy, 1, 240, first, [](int) {});
  config.healthy_friction_nm.assign(first.friction_nm().begin(), first.friction_nm().end());
  for (double& friction_nm : config.healthy_friction_nm) {
    if (std::isnan(friction_nm)) friction_nm = 0.0;  // it has turned too little: never an alarm
  }

  Found found;
  controller::SlackDetector second(config, motors);
  std::vector<std::uint8_t> before(GloveChannels().size());
  Watch(healthy, 2, healthy_s, second, [&](int) {
    for (std::size_t i = 0; i < before.size(); ++i) {
      found.false_alarms += second.slack()[i] == 1 && before[i] == 0;
      before[i] = second.slack()[i];
      const double share = second.friction_nm()[i] / config.healthy_friction_nm[i];
      if (share < found.least_share) found.least_share = share;  // not while it is NaN
    }
  });

  HandConfig slack = healthy;
  slack.cable.slack_mm = {0.5};
  controller::SlackDetector third(config, motors);
  std::vector<double> found_s(before.size(), -1.0);
  Watch(slack, 3, 240, third, [&](int tick) {
    for (std::size_t i = 0; i < found_s.size(); ++i) {
      if (third.slack()[i] == 1 && found_s[i] < 0.0) found_s[i] = tick * 1e-3;
    }
  });
  for (std::size_t i = 0; i < found_s.size(); ++i) {
    const double share = third.friction_nm()[i] / config.healthy_friction_nm[i];
    found.slack_motors += third.slack()[i];
    if (third.slack()[i] == 1) {
      found.slowest_s = std::max(found.slowest_s, found_s[i]);
    } else {
      found.missed.push_back(std::isfinite(share)
                                 ? fmt::format("{} ({:.2f})", GloveChannelNames()[i], share)
                                 : fmt::format("{} (turns too little)", GloveChannelNames()[i]));
    }
  }
  return found;
}

}  // namespace

void PrintSlack() {
  constexpr int kHealthy_s = 600;  // of each of the six kinds: an hour in all
  fmt::print(
      "| servo | motors found of {} | slowest [s] | false alarms | least share of healthy "
      "friction without slack | missed, with their share |\n|---|---|---|---|---|---|\n",
      GloveChannels().size());
  int false_alarms = 0;
  for (const ServoKind& kind : ServoKinds()) {
    const Found found = Detect(kind.defaults, kHealthy_s);
    false_alarms += found.false_alarms;
    fmt::print("| `{}` | {} | {:.0f} | {} | {:.2f} | {} |\n", kind.name, found.slack_motors,
               found.slowest_s, found.false_alarms, found.least_share,
               fmt::join(found.missed, ", "));
    std::fflush(stdout);
  }
  fmt::print("{:.1f} false alarms per hour\n",
             false_alarms * 3600.0 / (kHealthy_s * static_cast<double>(ServoKinds().size())));
}

}  // namespace gauntlet::sim::testing
