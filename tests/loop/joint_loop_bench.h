#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sim/trial/loop/hand_loop.h"
#include "tests/hand/hand_fixture.h"
#include "tests/hand/sine_delay.h"

namespace gauntlet::sim::testing {

/// The two joints that stand for all of a finger: a knuckle, and a middle joint with a long cable.
/// Of two fingers, so that they can be moved at once.
struct FingerPair {
  double mcp = 0.0;
  double pip = 0.0;

  static constexpr const char* kMcp = "middle_mcp";
  static constexpr const char* kPip = "index_pip";
};

/// A hand whose two joints are told angles through controller and link, and what they do.
class JointLoopBench {
 public:
  JointLoopBench(const HandConfig& hand, const controller::JointLoopConfig& joint_loop)
      : loop_(ConfigOf(joint_loop), Glove(), {}, std::make_shared<const HandModel>(hand)),
        counts_(GloveChannels().size(), CountsOf(0.0)) {}

  /// Tells both joints this angle for so long; `then` sees each tick.
  template <class Then>
  void Tell(double angle_deg, int ticks, Then then) {
    counts_[mcp_] = counts_[pip_] = CountsOf(angle_deg * kRadPerDeg);
    for (int tick = 0; tick < ticks; ++tick) {
      loop_.Step({.counts = counts_});
      then();
    }
  }
  void Tell(double angle_deg, int ticks) {
    Tell(angle_deg, ticks, [] {});
  }
  void Reset(double angle_deg) {
    std::vector<double> angle_rad(counts_.size(), 0.0);
    angle_rad[mcp_] = angle_rad[pip_] = angle_deg * kRadPerDeg;
    loop_.Reset(angle_rad);
  }
  FingerPair Angle_deg() const {
    const std::vector<double> angle_rad = JointAngles(loop_.hand());
    return {angle_rad[mcp_] * kDegPerRad, angle_rad[pip_] * kDegPerRad};
  }
  bool ok() const { return loop_.hand().health().ok; }

 private:
  static double CountsOf(double angle_rad) { return 5e5 + 1e5 * angle_rad; }
  static controller::ControllerConfig ConfigOf(const controller::JointLoopConfig& joint_loop) {
    controller::ControllerConfig config;
    config.joint_loop = joint_loop;
    config.untrusted = {.full_scale = false, .stuck_after_ms = 0.0, .jump_share = 0.0};
    return config;
  }
  /// Without noise or rounding.
  static controller::GloveCalibration Glove() {
    const std::size_t channels = GloveChannels().size();
    return {.channel_names = GloveChannelNames(),
            .low_counts = std::vector<double>(channels, CountsOf(-1.0)),
            .high_counts = std::vector<double>(channels, CountsOf(1.0)),
            .low_angle_rad = std::vector<double>(channels, -1.0),
            .high_angle_rad = std::vector<double>(channels, 1.0),
            .full_scale_counts = {1e6}};
  }

  HandLoop loop_;
  std::vector<double> counts_;
  std::size_t mcp_ = ChannelIndex(FingerPair::kMcp);
  std::size_t pip_ = ChannelIndex(FingerPair::kPip);
};

/// The mean of an angle while it rests, and between what it moves then.
struct Resting {
  int ticks = 0;
  double mean_deg = 0.0;
  double least_deg = 1e9;
  double most_deg = -1e9;

  void Add(double angle_deg) {
    mean_deg += (angle_deg - mean_deg) / ++ticks;
    least_deg = std::min(least_deg, angle_deg);
    most_deg = std::max(most_deg, angle_deg);
  }
  double Swing_deg() const { return most_deg - least_deg; }
};

/// At 30, 50 and 70 deg, reached at 25 deg/s from both sides and held for 1.5 s.
struct AtRest {
  FingerPair hysteresis_deg;  // the widest gap between coming from above and from below
  FingerPair error_deg;       // the largest distance from what was told
  FingerPair swing_deg;       // end to end, from 4 to 10 s of holding 50 deg: a limit cycle
};

inline AtRest MeasureAtRest(const HandConfig& hand, const controller::JointLoopConfig& joint_loop) {
  JointLoopBench bench(hand, joint_loop);
  bench.Reset(20.0);
  double told_deg = 20.0;
  const auto go_to = [&](double goal_deg) {
    while (told_deg != goal_deg) {
      told_deg += told_deg < goal_deg ? 0.5 : -0.5;
      bench.Tell(told_deg, 20);
    }
  };
  struct Pair {
    Resting mcp, pip;
  };
  const auto rest = [&](int wait_ticks, int ticks) {
    Pair pair;
    bench.Tell(told_deg, wait_ticks);
    bench.Tell(told_deg, ticks, [&] {
      const FingerPair angle_deg = bench.Angle_deg();
      pair.mcp.Add(angle_deg.mcp - told_deg);
      pair.pip.Add(angle_deg.pip - told_deg);
    });
    return pair;
  };
  AtRest result;
  const auto raise = [](double& most, double value) { most = std::max(most, value); };
  const auto arrive = [&] {
    const Pair pair = rest(1000, 500);
    raise(result.error_deg.mcp, std::abs(pair.mcp.mean_deg));
    raise(result.error_deg.pip, std::abs(pair.pip.mean_deg));
    return FingerPair{pair.mcp.mean_deg, pair.pip.mean_deg};
  };
  constexpr std::array kPlaces_deg = {30.0, 50.0, 70.0};
  std::array<FingerPair, 3> from_below;
  for (std::size_t i = 0; i < 3; ++i) {
    go_to(kPlaces_deg[i]);
    from_below[i] = arrive();
  }
  go_to(80.0);
  for (std::size_t i = 3; i-- > 0;) {
    go_to(kPlaces_deg[i]);
    const FingerPair from_above = arrive();
    raise(result.hysteresis_deg.mcp, from_above.mcp - from_below[i].mcp);
    raise(result.hysteresis_deg.pip, from_above.pip - from_below[i].pip);
  }
  go_to(50.0);
  const Pair held = rest(4000, 6000);
  result.swing_deg = {held.mcp.Swing_deg(), held.pip.Swing_deg()};
  if (!bench.ok()) result.error_deg = {INFINITY, INFINITY};
  return result;
}

/// Told a sine of 1 Hz around 50 deg: the third and fourth period.
struct OnASine {
  FingerPair gain;
  FingerPair delay_ms;
};

inline OnASine MeasureOnASine(const HandConfig& hand, const controller::JointLoopConfig& joint_loop,
                              double amplitude_deg) {
  JointLoopBench bench(hand, joint_loop);
  bench.Reset(50.0);
  const double omega = 2.0 * std::numbers::pi;
  SineDelay mcp, pip;
  for (int tick = 0; tick < 4000; ++tick) {
    bench.Tell(50.0 + amplitude_deg * std::sin(omega * tick * 1e-3), 1);
    if (tick < 2000) continue;
    const FingerPair angle = bench.Angle_deg();
    mcp.Add(angle.mcp - 50.0, omega * (tick + 1) * 1e-3);
    pip.Add(angle.pip - 50.0, omega * (tick + 1) * 1e-3);
  }
  const auto gain = [&](const SineDelay& delay) {
    return std::hypot(delay.in_phase, delay.quadrature) / 1000.0 / amplitude_deg;
  };
  return {.gain = {gain(mcp), gain(pip)}, .delay_ms = {mcp.Milliseconds(), pip.Milliseconds()}};
}

/// A hand with servos of this kind, and with joint sensors.
inline HandConfig SensingHand(const ServoConfig& servo) {
  HandConfig hand;
  hand.servo = servo;
  hand.joint_sensors.kind = JointSensorsKind::kEncoder;
  return hand;
}

/// The loop for a hand, from what the hand does without it: it is as late as its knuckle behind a
/// sine of 30 deg, and friction_deg is half of each joint's hysteresis at rest.
inline controller::JointLoopConfig FittedLoop(const HandConfig& hand, const AtRest& without) {
  controller::JointLoopConfig loop{.kind = controller::JointLoopKind::kPi};
  loop.expected_delay_ms =
      MeasureOnASine(hand, {}, 30.0).delay_ms.mcp + hand.joint_sensors.delay_ms;
  loop.friction_deg.assign(GloveChannels().size(), 0.0);
  loop.friction_deg[ChannelIndex(FingerPair::kMcp)] = 0.5 * without.hysteresis_deg.mcp;
  loop.friction_deg[ChannelIndex(FingerPair::kPip)] = 0.5 * without.hysteresis_deg.pip;
  return loop;
}

}  // namespace gauntlet::sim::testing
