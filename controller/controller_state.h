#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "controller/controller.h"
#include "controller/filters/filter.h"
#include "controller/linearisation/linearisation.h"
#include "controller/motor_rounding.h"
#include "controller/tendon_map.h"

namespace gauntlet::controller {

/// The stages of a controller and what flows between them.
struct Controller::State {
  State(const ControllerConfig& config_in, const GloveCalibration& glove_in,
        const TendonTransmission& hand_in);

  void StartChannel(int channel) noexcept;
  void StepFilters() noexcept;
  void HoldInactiveChannels() noexcept;
  void StepMotors() noexcept;
  void Reset() noexcept;
  /// Goes on where `before`, a controller of the same glove and hand, stands.
  void TakeOver(const State& before) noexcept;

  ControllerConfig config;
  GloveCalibration glove;
  TendonTransmission hand;

  std::unique_ptr<Linearisation> linearisation;
  SampleGuard guard;
  std::vector<std::unique_ptr<Filter>> chain;
  std::unique_ptr<Filter> predictor;  // may be null
  TendonMap tendon_map;
  MotorRounding rounding;

  int samples_to_event = 0;
  std::vector<std::uint8_t> active;  // per channel
  int inactive_count = 0;
  std::vector<double> linearised_rad;
  std::vector<double> filtered_counts;
  std::vector<double> filtered_rad;
  std::vector<double> target_rad;
  std::vector<double> held_rad;  // targets of inactive channels
  std::vector<double> exact_motor_counts;
  std::vector<std::int32_t> motor_counts;
};

}  // namespace gauntlet::controller
