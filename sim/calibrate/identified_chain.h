#pragma once

#include <string>
#include <vector>

#include "controller/settings.h"
#include "sim/calibrate/chain_log.h"

namespace gauntlet::sim {

/// What `gauntlet identify` writes of one joint or motor. Lists are the value and the ends of its
/// 95 % interval; empty: not to be had from the log.
struct IdentifiedPart {
  std::string part;
  std::vector<double> delay_ms;
  std::vector<double> dead_time_ms;
  std::vector<double> lag_ms;
  std::vector<double> natural_frequency_hz;
  std::vector<double> damping_ratio;
  std::vector<double> gain;
  std::vector<double> hysteresis_deg;
  double residual_rms_deg = 0.0;  // 0 if the model was not fitted

  void Visit(controller::SettingsVisitor& visitor);
};

/// The chain from a command to the angles of a hand. The first lists are settings of a controller,
/// in the order of `parts`: one without a value of its own has the mean of the others.
struct IdentifiedChain {
  std::string log;                   // that it was made from
  std::vector<double> horizon_ms;    // of a prediction: the delay
  double expected_delay_ms = 0.0;    // of a joint loop: its mean
  std::vector<double> friction_deg;  // of a joint loop: half the hysteresis
  std::vector<IdentifiedPart> parts;

  void Visit(controller::SettingsVisitor& visitor);
};

IdentifiedChain MakeIdentifiedChain(const ChainLog& log, const std::vector<ChainFit>& fits);

}  // namespace gauntlet::sim
