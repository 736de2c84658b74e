#include "sim/trial/loop/event_config.h"

namespace gauntlet::sim {

LinksConfig LinksOf(const EventConfig& event, const LinksConfig& links) {
  LinksConfig both = links;
  const auto begin = [&](const char* key) -> TransportConfig& {
    if (links.hand) {
      throw controller::SettingError(
          key, "is short for a link to the hand, must not be given beside link.hand");
    }
    if (!both.hand) both.hand.emplace();
    return both.hand->transport;
  };
  if (event.jitter_ms) {
    DelayConfig& delay = begin("event.jitter_ms").delay;
    if (*event.jitter_ms > 0.0) {
      delay.settings = GammaDelay{.mean_ms = *event.jitter_ms, .deviation_ms = *event.jitter_ms};
    }
  }
  if (event.loss_percent) {
    begin("event.loss_percent").loss.settings = IndependentLoss{.percent = *event.loss_percent};
  }
  return both;
}

}  // namespace gauntlet::sim
