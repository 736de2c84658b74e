#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// sRGB, each part in 0 .. 1.
struct Color {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
  double alpha = 1.0;
};

/// From 0xRRGGBB.
constexpr Color Rgb(unsigned hex, double alpha = 1.0) {
  return {((hex >> 16) & 255) / 255.0, ((hex >> 8) & 255) / 255.0, (hex & 255) / 255.0, alpha};
}

/// A colour on light and on dark ground, as 0xRRGGBB.
struct Shade {
  std::string_view name;  // of the CSS variable
  unsigned light;
  unsigned dark;

  constexpr Color OnLight(double alpha = 1.0) const { return Rgb(light, alpha); }
};

/// One colour per meaning in pages, pictures and videos. Every colour has a contrast of at least 3
/// to both grounds (WCAG 2.2, 1.4.11), and those of texts of at least 4.5 (1.4.3). Colours of
/// curves that are compared are also different with protanopia, deuteranopia and tritanopia.
namespace palette {

inline constexpr Shade kGround = {"ground", 0xffffff, 0x12161c};
inline constexpr Shade kPanel = {"panel", 0xf5f6f8, 0x1a2029};
inline constexpr Shade kInk = {"ink", 0x1b2330, 0xe6eaf0};
inline constexpr Shade kMuted = {"muted", 0x5b6675, 0x98a3b2};
inline constexpr Shade kAccent = {"accent", 0x2563c9, 0x78a9f5};
inline constexpr Shade kGood = {"good", 0x14734a, 0x5cc795};
inline constexpr Shade kWarn = {"warn", 0x9a4a00, 0xefae62};

inline constexpr Shade kWearer = {"wearer", 0xae226f, 0xff4f70};
/// A translucent hand of the baseline, whose own colour is too near to the grey of a solid hand.
inline constexpr Shade kSecond = {"second", 0xb07a00, 0xf0c23c};
inline constexpr Shade kGlove = {"glove", 0x848e9b, 0x5c7080};
inline constexpr Shade kCommand = {"command", 0xb86a00, 0xf0a94a};
/// Controllers: the baseline, then the others in the order of the verdict.
inline constexpr std::array<Shade, 9> kSeries = {{{"c0", 0x172333, 0x90a6b4},
                                                  {"c1", 0x0454b3, 0x6ca5e9},
                                                  {"c2", 0x3f8c5c, 0x87fddb},
                                                  {"c3", 0x974c1f, 0xdf8f1f},
                                                  {"c4", 0xa86aa9, 0xa67cc0},
                                                  {"c5", 0x937a02, 0xedc56c},
                                                  {"c6", 0x316a76, 0xaae7ef},
                                                  {"c7", 0x6b4f3a, 0xd5a389},
                                                  {"c8", 0x42296c, 0x9a78e0}}};
/// Colours of series in a terminal, as numbers of its 256 colours (xterm): near the hues above, and
/// with a contrast of at least 3 to a white and to a black ground, since a program does not see
/// which.
inline constexpr std::array<std::uint8_t, 9> kTerminalSeries = {241, 25, 29,  130, 96,
                                                                136, 67, 138, 104};
/// One hand alone: as the controller that is recommended.
inline constexpr Shade kHand = kSeries[1];

}  // namespace palette

/// Numbers in palette::kSeries of all controllers: 0 for the baseline, 1, 2, .. for the others in
/// the order of the verdict. Shapes: `order` has each controller once.
std::vector<std::size_t> SeriesOf(const std::vector<std::size_t>& order,
                                  std::optional<std::size_t> baseline);

/// The colour of a series as CSS: its variable, or beyond the palette a hue far from those of its
/// neighbours.
std::string CssOfSeries(std::size_t series);
/// Colour of a series on light ground.
Color ColourOfSeries(std::size_t series);
/// Colour of a series in a terminal; none beyond the palette.
std::optional<std::uint8_t> TerminalColourOfSeries(std::size_t series);

/// CSS that defines a variable for each colour, in the light and in the dark scheme. Paper is light
/// (`data-paper` at the root).
std::string PaletteCss();

}  // namespace gauntlet::sim
