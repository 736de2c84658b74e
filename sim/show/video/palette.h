#pragma once

#include "sim/show/figure/palette.h"

namespace gauntlet::sim::palette {

// Grounds and lines of pictures and videos, which are light; signals have the colours of pages.
inline constexpr Color kPage = Rgb(0xeef1f5);
inline constexpr Color kCard = Rgb(0xffffff);
inline constexpr Color kCardEdge = Rgb(0xdde3ea);
inline constexpr Color kViewTop = Rgb(0xdfe6ee);  // behind the hand
inline constexpr Color kViewBottom = Rgb(0xf6f8fa);
inline constexpr Color kGrid = Rgb(0xe6eaef);
inline constexpr Color kInkOnLight = kInk.OnLight();
inline constexpr Color kMutedOnLight = kMuted.OnLight();
inline constexpr Color kJointError = Rgb(0xf5820b);  // on all hands, dark and light parts
inline constexpr Color kWarning = Rgb(0xb42318);
inline constexpr Color kBetter = kGood.OnLight();

}  // namespace gauntlet::sim::palette
