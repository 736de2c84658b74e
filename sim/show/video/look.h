#pragma once

#include <array>
#include <string_view>

namespace gauntlet::sim {

/// How finely the hands of a video are drawn: what its time goes into. See RendererConfig.
struct Look {
  std::string_view name;
  int supersampling;
  int sides;
  bool plain_cables;
  bool shadows;
};

inline constexpr Look kFastLook = {
    .name = "fast", .supersampling = 1, .sides = 8, .plain_cables = true, .shadows = false};
inline constexpr Look kGoodLook = {
    .name = "good", .supersampling = 2, .sides = 14, .plain_cables = true, .shadows = false};
inline constexpr Look kBestLook = {
    .name = "best", .supersampling = 4, .sides = 40, .plain_cables = false, .shadows = true};
inline constexpr std::array kLooks = {kFastLook, kGoodLook, kBestLook};

}  // namespace gauntlet::sim
