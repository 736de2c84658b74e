#pragma once

#include <cstdint>
#include <vector>

#include "sim/show/figure/palette.h"
#include "sim/show/video/image.h"

namespace gauntlet::sim {

/// The wearer's hand behind and around the robot's: its shape in one colour to be drawn under the
/// robot's hand, and its outline to be drawn over it. Where the hand lags, both are seen; of one
/// that follows, nothing.
class Ghost {
 public:
  explicit Ghost(const Color& color, int outline_px) : color_(color), outline_px_(outline_px) {}

  /// From a picture that is opaque where the wearer's hand is.
  void SetHand(const Image& hand);

  /// Under the robot's hand.
  const Image& shape() const { return shape_; }
  /// Over a picture of the robot's hand: but where the two have an edge in common.
  const Image& OutlineOver(const Image& hand);

 private:
  Color color_;
  int outline_px_;
  std::vector<std::uint8_t> edge_;  // of the wearer's hand, per pixel how much of it there is
  Image shape_;
  Image outline_;
};

}  // namespace gauntlet::sim
