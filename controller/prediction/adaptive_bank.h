#pragma once

#include <Eigen/Core>
#include <array>
#include <iterator>
#include <vector>

#include "controller/prediction/adaptive_prediction.h"

namespace gauntlet::controller {

/// The numbers of AdaptivePredictionConfig's bank in steps of a clock, for who runs it in `double`
/// or in `float`. Columns are channels. States are those of MotionModel, with angles in rad.
struct AdaptiveBank {
  struct Member {
    Eigen::Matrix3d transition;         // A
    Eigen::RowVector3d angle_of_state;  // H; the third value is 0
    Eigen::Array3Xd gain;               // K
    Eigen::Array3Xd look_ahead;         // what it expects at the horizon = look_ahead * state
  };
  // Of the variance: 0.1 and 100 standard deviations. One that never misses has a finite share.
  static constexpr double kLeastMiss = 1e-2;
  static constexpr double kMostMiss = 1e4;

  std::array<Member, std::size(kPredictionBank)> members;
  std::vector<int> delay_steps;   // per channel, the horizon; at least 1
  std::vector<double> inverse_r;  // per channel [1/rad^2]
  double forget = 0.0;            // share of the newest miss

  int channel_count() const { return static_cast<int>(delay_steps.size()); }
  /// Steps for which expected angles are kept: more than all delays.
  int kept_steps() const;
};

/// Only the first `settled_channels` have gains. Errors: SettingError.
AdaptiveBank BankOf(const AdaptivePredictionConfig& config, int channel_count, double rate_hz,
                    int settled_channels);

}  // namespace gauntlet::controller
