#pragma once

#include <vector>

#include "sim/glove/motions/motion.h"

namespace gauntlet::sim {

/// The course of a movement from 0 to 1 in unit time that has the least jerk, at u in [0, 1].
///
///     s(u) = 10 u^3 - 15 u^4 + 6 u^5
///
/// Source: Flash and Hogan 1985.
inline double MinimumJerkAt(double u) { return u * u * u * (10.0 + u * (-15.0 + 6.0 * u)); }

/// One movement of one channel. Movements may overlap: they add.
struct Move {
  double start_s = 0.0;
  double duration_s = 0.0;  // 0: a jump
  double delta_rad = 0.0;
};

/// `channel` starts at an angle and makes these moves.
void MoveChannel(std::size_t channel, double start_rad, const std::vector<Move>& moves,
                 double rate_hz, Motion& motion);

/// Moves of all channels to one target after another, each on the way from the last.
class MovePlan {
 public:
  explicit MovePlan(std::vector<double> start_rad);

  /// Every channel to its angle; channel c starts lag_s[c] later (none if empty).
  void MoveTo(double start_s, double duration_s, const std::vector<double>& target_rad,
              const std::vector<double>& lag_s = {});
  Motion Fill(int samples, const MotionContext& context) const;

 private:
  std::vector<double> start_rad_;
  std::vector<double> now_rad_;
  std::vector<std::vector<Move>> moves_;  // per channel
};

}  // namespace gauntlet::sim
