#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "controller/settings.h"
#include "sim/base/signal.h"

namespace gauntlet::sim {

/// Tremor of the wearer's hand. It is no noise of the glove, which measures it correctly.
/// `belongs_to_truth` chooses whether the robot hand should follow it.
///
/// Narrow-band random oscillation: eight sines per channel of random phase and frequency within the
/// band, and eight, with half of the power, that all channels share.
/// Source: physiological tremor lies at 8 to 12 Hz (Elble, Koller 1990); 0.1 to 0.3 deg at finger
/// joints is an assumption, illness reaches several degrees at 4 to 6 Hz.
struct TremorConfig {
  double rms_deg = 0.0;  // 0: none
  double from_hz = 8.0;
  double to_hz = 12.0;
  std::vector<std::string> channels;
  bool belongs_to_truth = false;

  void Visit(controller::SettingsVisitor& visitor);
};

/// Shapes: samples x channels of KnownChannels(); no rows if there is no tremor.
Signal SynthesiseTremor(const TremorConfig& config, int samples, double rate_hz,
                        std::uint64_t seed);

}  // namespace gauntlet::sim
