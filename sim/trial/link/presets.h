#pragma once

#include <span>
#include <string_view>

#include "sim/trial/link/link_config.h"

namespace gauntlet::sim {

/// A link that has been measured, or computed from its data sheet.
struct LinkPreset {
  std::string_view name;
  std::string_view summary;
  std::string_view source;
  TransportConfig transport;
};

/// All presets. The first, none, is a link without delay, loss and jitter.
std::span<const LinkPreset> LinkPresets();

}  // namespace gauntlet::sim
