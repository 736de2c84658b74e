#pragma once

namespace gauntlet::sim {

/// sRGB, each part in 0 .. 1.
struct Color {
  double red = 0.0;
  double green = 0.0;
  double blue = 0.0;
  double alpha = 1.0;
};

/// From 0xRRGGBB, as designers write it.
constexpr Color Rgb(unsigned hex, double alpha = 1.0) {
  return {((hex >> 16) & 255) / 255.0, ((hex >> 8) & 255) / 255.0, (hex & 255) / 255.0, alpha};
}

/// One colour per meaning, everywhere. The four signals can be told apart with any kind of colour
/// blindness: they differ in lightness, too (contrast against white: 6.7, 1.9, 3.1, 4.9).
namespace palette {
inline constexpr Color kPage = Rgb(0xeef1f5);
inline constexpr Color kCard = Rgb(0xffffff);
inline constexpr Color kCardEdge = Rgb(0xdde3ea);
inline constexpr Color kViewTop = Rgb(0xdfe6ee);  // behind the hand
inline constexpr Color kViewBottom = Rgb(0xf6f8fa);
inline constexpr Color kGrid = Rgb(0xe6eaef);
inline constexpr Color kInk = Rgb(0x17212b);
inline constexpr Color kMutedInk = Rgb(0x5b6875);  // 5.7 to 1 on white
inline constexpr Color kWarning = Rgb(0xb42318);
inline constexpr Color kGood = Rgb(0x0a7d55);
inline constexpr Color kBar = Rgb(0x9aa7b5);

inline constexpr Color kTrue = Rgb(0xb3124f);
inline constexpr Color kRaw = Rgb(0xb3bfcb);
inline constexpr Color kCommand = Rgb(0xd97a06);
inline constexpr Color kHand = Rgb(0x1d6fd8);
/// The second hand of two in one picture, where no commands are drawn (contrast: 3.3).
inline constexpr Color kSecondHand = Rgb(0x0f9d7a);
}  // namespace palette

}  // namespace gauntlet::sim
