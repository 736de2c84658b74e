#include "sim/show/video/ghost.h"

#include <gtest/gtest.h>

namespace gauntlet::sim {
namespace {

constexpr std::uint32_t kOpaque = 0xff000000u;

/// A square of 10 px on nothing.
Image Square(int left) {
  Image image(40, 20);
  for (int y = 5; y < 15; ++y) {
    for (int x = left; x < left + 10; ++x) image.Row(y)[x] = kOpaque;
  }
  return image;
}

int Covered(const Image& image) {
  int count = 0;
  for (const std::uint32_t pixel : image.pixels) count += pixel >> 24 != 0;
  return count;
}

TEST(Ghost, IsTheWearersShapeInOneColour) {
  Ghost ghost(Rgb(0xff0000), 1);
  ghost.SetHand(Square(10));
  EXPECT_EQ(Covered(ghost.shape()), 100);
  const std::uint32_t inside = ghost.shape().Row(10)[15];
  EXPECT_GT(inside >> 24, 60u);
  EXPECT_LT(inside >> 24, 200u);                // what is behind shines through
  EXPECT_EQ(inside >> 16 & 255, inside >> 24);  // premultiplied
  EXPECT_EQ(inside & 0xffff, 0u);
}

TEST(Ghost, ItsOutlineIsSeenOverAHandThatIsElsewhere) {
  Ghost ghost(Rgb(0xff0000), 1);
  ghost.SetHand(Square(10));
  EXPECT_EQ(Covered(ghost.OutlineOver(Image(40, 20))), 36);  // its outermost pixels
  EXPECT_EQ(Covered(ghost.OutlineOver(Square(10))), 0);      // it follows
  EXPECT_EQ(Covered(ghost.OutlineOver(Square(11))), 0);      // nearly
  EXPECT_GT(Covered(ghost.OutlineOver(Square(16))), 15);
  EXPECT_LT(Covered(ghost.OutlineOver(Square(16))), 36);
}

}  // namespace
}  // namespace gauntlet::sim
