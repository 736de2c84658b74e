#include "sim/trial/link/transport_config.h"

#include <string_view>
#include <vector>

#include "sim/trial/link/presets.h"

namespace gauntlet::sim {

bool TransportConfig::has_jitter() const {
  return !std::holds_alternative<ConstantDelay>(delay.settings) || batch_ms > 0.0;
}

TransportConfig TransportConfig::WithoutJitter() const {
  TransportConfig steady = *this;
  // The wait for the next batch is uniform from 0 to its interval.
  steady.delay.settings = ConstantDelay{.delay_ms = delay.MeanMs() + 0.5 * batch_ms};
  steady.batch_ms = 0.0;
  return steady;
}

void TransportConfig::Visit(controller::SettingsVisitor& visitor) {
  static const std::vector<std::string_view> kNames = [] {
    std::vector<std::string_view> names;
    for (const LinkPreset& known : LinkPresets()) names.push_back(known.name);
    return names;
  }();
  const std::size_t before = preset;
  std::size_t chosen = preset;
  visitor.Choice({"preset", "a known link; gives its values to the settings below"}, kNames,
                 chosen);
  if (chosen != before && chosen < kNames.size()) {
    *this = LinkPresets()[chosen].transport;
    preset = chosen;
  }
  controller::VisitGroup(visitor, {"delay", "time of a frame on its way"}, delay);
  controller::VisitGroup(visitor, {"loss", "which frames are lost"}, loss);
  visitor.Number({"frame_ms", "time for which a frame occupies the link; 0: none waits", 0, 1000},
                 frame_ms);
  visitor.Number(
      {"batch_ms", "frames arrive together at multiples of this interval; 0: each by itself", 0,
       1000},
      batch_ms);
}

}  // namespace gauntlet::sim
