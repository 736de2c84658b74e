#include "controller/filters/filter_registry.h"

#include <string>

namespace gauntlet::controller {

void FilterConfig::Visit(SettingsVisitor& visitor) {
  VisitKind(visitor, {.key = "kind", .help = "which filter", .required = true}, settings);
}

std::span<const FilterKind> FilterKinds() { return AllKinds<FilterConfig>(); }

std::unique_ptr<Filter> MakeFilter(const FilterConfig& config, int channel_count, double rate_hz) {
  if (channel_count < 1) {
    throw SettingError("channels", "is " + std::to_string(channel_count) + ", must be at least 1");
  }
  if (!(rate_hz > 0.0)) {
    throw SettingError("rate_hz", "is " + NumberText(rate_hz) + ", must be above 0");
  }
  return std::visit(
      [&](const auto& settings) { return MakeFilter(settings, channel_count, rate_hz); },
      config.settings);
}

}  // namespace gauntlet::controller
