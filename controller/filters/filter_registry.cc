#include "controller/filters/filter_registry.h"

namespace gauntlet::controller {

void FilterConfig::Visit(SettingsVisitor& visitor) {
  VisitKind(visitor, {.key = "kind", .help = "which filter", .required = true}, settings);
}

std::span<const FilterKind> FilterKinds() { return AllKinds<FilterConfig>(); }

std::unique_ptr<Filter> MakeFilter(const FilterConfig& config, int channel_count, double rate_hz) {
  return std::visit(
      [&](const auto& settings) { return MakeFilter(settings, channel_count, rate_hz); },
      config.settings);
}

}  // namespace gauntlet::controller
