#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

void LinkConfig::Check() const {
  controller::CheckSettings(*this);
  controller::WithinSetting("delay", [this] { transport.delay.Check(); });
  controller::WithinSetting("watchdog", [this] { watchdog.Check(); });
}

void LinksConfig::Check() const {
  if (glove) controller::WithinSetting("link.glove", [this] { glove->Check(); });
  if (hand) controller::WithinSetting("link.hand", [this] { hand->Check(); });
}

}  // namespace gauntlet::sim
