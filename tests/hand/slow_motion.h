#pragma once

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "tests/hand/hand_fixture.h"

namespace gauntlet::sim::testing {

/// What of a slow sine of one joint arrives.
struct SlowMotion {
  double share = 0.0;     // of the way between the ends
  double loop_deg = 0.0;  // the widest gap between the ways up and down, in the middle 80 %
};

/// The middle joint of the index finger follows a sine of 0.02 Hz about 50 deg, in frames of 20 ms.
/// `neighbours_move`: the finger's own knuckle, which its cable passes, and all other fingers
/// follow one of 0.5 Hz and 10 deg.
inline SlowMotion MoveSlowly(const HandConfig& config, double amplitude_deg, bool neighbours_move) {
  Hand hand(MakeModel(config));
  const controller::TendonTransmission& map = hand.hand_model().transmission();
  const auto joint = static_cast<std::size_t>(ChannelIndex("index_pip"));
  std::vector<std::size_t> neighbours = {static_cast<std::size_t>(ChannelIndex("index_mcp"))};
  for (const char* finger : {"middle", "ring", "little"}) {
    for (const char* part : {"_mcp", "_pip"}) {
      neighbours.push_back(static_cast<std::size_t>(ChannelIndex(std::string(finger) + part)));
    }
  }
  std::vector<double> angle = map.reference_angle_rad;
  hand.Reset(angle);
  constexpr int kFrames = 2500;  // of 20 ms: a period
  constexpr int kNeighboursPeriod = 100;
  constexpr std::size_t kPlaces = 81;
  std::vector<double> now_deg;
  std::vector<double> up(kPlaces, NAN);
  std::vector<double> down(kPlaces, NAN);
  double low_deg = 1e9;
  double high_deg = -1e9;
  for (int frame = 0; frame < 2 * kFrames; ++frame) {
    const double phase = 2.0 * std::numbers::pi * frame / kFrames;
    angle[joint] = map.reference_angle_rad[joint] + amplitude_deg * kRadPerDeg * std::sin(phase);
    if (neighbours_move) {
      for (const std::size_t other : neighbours) {
        angle[other] =
            map.reference_angle_rad[other] +
            10.0 * kRadPerDeg * std::sin(2.0 * std::numbers::pi * frame / kNeighboursPeriod);
      }
    }
    hand.SetCommand(CountsFor(map, angle));
    StepTimes(hand, 20);
    now_deg.push_back(JointAngles(hand)[joint] * kDegPerRad);
    if (frame < kFrames) continue;
    // Mean over a period of the neighbours, whose motion is not what is asked for.
    const double reached_deg =
        std::accumulate(now_deg.end() - kNeighboursPeriod, now_deg.end(), 0.0) / kNeighboursPeriod;
    low_deg = std::min(low_deg, reached_deg);
    high_deg = std::max(high_deg, reached_deg);
    const double then = phase - std::numbers::pi * kNeighboursPeriod / kFrames;
    const double place = 0.5 * (std::sin(then) / 0.8 + 1.0);
    if (place < 0.0 || place > 1.0) continue;
    (std::cos(then) > 0.0 ? up : down)[static_cast<std::size_t>(place * (kPlaces - 1))] =
        reached_deg;
  }
  SlowMotion motion{.share = (high_deg - low_deg) / (2.0 * amplitude_deg)};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    if (std::isfinite(up[i]) && std::isfinite(down[i])) {
      motion.loop_deg = std::max(motion.loop_deg, down[i] - up[i]);
    }
  }
  return motion;
}

}  // namespace gauntlet::sim::testing
