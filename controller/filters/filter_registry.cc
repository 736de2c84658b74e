#include "controller/filters/filter_registry.h"

#include <array>
#include <string>
#include <utility>

namespace gauntlet::controller {
namespace {

constexpr std::size_t kKindCount = std::variant_size_v<FilterSettings>;

template <std::size_t... kIndex>
std::array<FilterKind, kKindCount> MakeKinds(std::index_sequence<kIndex...>) {
  return {FilterKind{std::variant_alternative_t<kIndex, FilterSettings>::kKind,
                     std::variant_alternative_t<kIndex, FilterSettings>::kSummary,
                     FilterConfig{FilterSettings(std::in_place_index<kIndex>)}}...};
}

template <std::size_t... kIndex>
constexpr std::array<std::string_view, kKindCount> MakeNames(std::index_sequence<kIndex...>) {
  return {std::variant_alternative_t<kIndex, FilterSettings>::kKind...};
}

constexpr auto kNames = MakeNames(std::make_index_sequence<kKindCount>());

}  // namespace

std::string_view FilterConfig::kind() const { return kNames[settings.index()]; }

void FilterConfig::Visit(SettingsVisitor& visitor) {
  std::size_t index = settings.index();
  visitor.Choice({.key = "kind", .help = "which filter", .required = true}, kNames, index);
  if (index != settings.index() && index < kKindCount) {
    settings = FilterKinds()[index].defaults.settings;
  }
  std::visit([&visitor](auto& config) { config.Visit(visitor); }, settings);
}

std::span<const FilterKind> FilterKinds() {
  static const auto kKinds = MakeKinds(std::make_index_sequence<kKindCount>());
  return kKinds;
}

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
