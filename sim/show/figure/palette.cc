#include "sim/show/figure/palette.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

using palette::kSeries;

constexpr std::array kRoles = {palette::kGround,  palette::kPanel,  palette::kInk,
                               palette::kMuted,   palette::kAccent, palette::kGood,
                               palette::kWarn,    palette::kWearer, palette::kGlove,
                               palette::kCommand, palette::kSecond};

double HueOf(std::size_t series) { return std::fmod(137.5 * static_cast<double>(series), 360.0); }

constexpr double kSaturation = 0.55, kLightness = 0.42;

}  // namespace

std::vector<std::size_t> SeriesOf(const std::vector<std::size_t>& order,
                                  std::optional<std::size_t> baseline) {
  std::vector<std::size_t> series(order.size(), 0);
  std::size_t next = 1;
  for (const std::size_t controller : order) {
    GAUNTLET_ASSERT(controller < series.size());
    if (controller != baseline) series[controller] = next++;
  }
  return series;
}

std::string CssOfSeries(std::size_t series) {
  if (series < kSeries.size()) return fmt::format("var(--{})", kSeries[series].name);
  return fmt::format("hsl({:g} {:g}% {:g}%)", HueOf(series), 100.0 * kSaturation,
                     100.0 * kLightness);
}

Color ColourOfSeries(std::size_t series) {
  if (series < kSeries.size()) return kSeries[series].OnLight();
  const auto part = [&](double offset) {  // HSL to sRGB
    const double k = std::fmod(offset + HueOf(series) / 30.0, 12.0);
    return kLightness -
           kSaturation * kLightness * std::max(-1.0, std::min({k - 3.0, 9.0 - k, 1.0}));
  };
  return {part(0.0), part(8.0), part(4.0)};
}

std::optional<std::uint8_t> TerminalColourOfSeries(std::size_t series) {
  if (series >= palette::kTerminalSeries.size()) return std::nullopt;
  return palette::kTerminalSeries[series];
}

std::string PaletteCss() {
  std::string light, dark;
  const auto add = [&](const Shade& shade) {
    light += fmt::format("--{}:#{:06x};", shade.name, shade.light);
    dark += fmt::format("--{}:#{:06x};", shade.name, shade.dark);
  };
  std::ranges::for_each(kRoles, add);
  std::ranges::for_each(kSeries, add);
  return fmt::format(
      ":root{{{}}}\n@media (prefers-color-scheme:dark){{:root:not([data-paper]){{{}}}}}\n", light,
      dark);
}

}  // namespace gauntlet::sim
