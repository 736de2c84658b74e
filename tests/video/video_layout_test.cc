#include "sim/show/video/video_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <vector>

#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

bool Inside(const Rect& inner, const Rect& outer) {
  return inner.x >= outer.x && inner.y >= outer.y && inner.right() <= outer.right() &&
         inner.bottom() <= outer.bottom();
}

bool Apart(const Rect& a, const Rect& b) {
  return a.right() <= b.x || b.right() <= a.x || a.bottom() <= b.y || b.bottom() <= a.y;
}

class EveryVideoLayout : public testing::TestWithParam<std::tuple<std::pair<int, int>, int>> {};

TEST_P(EveryVideoLayout, PartsAreLargeEnoughAndDoNotOverlap) {
  const auto [size, pane_count] = GetParam();
  const auto [width, height] = size;
  const VideoLayout layout = LayOutVideo(width, height, pane_count);
  const Rect frame = {0.0, 0.0, static_cast<double>(width), static_cast<double>(height)};
  ASSERT_EQ(layout.panes.size(), static_cast<std::size_t>(pane_count));
  for (std::size_t i = 0; i < layout.panes.size(); ++i) {
    const PaneLayout& pane = layout.panes[i];
    EXPECT_TRUE(Inside(pane.card, frame));
    EXPECT_TRUE(Apart(pane.card, layout.header));
    EXPECT_TRUE(Apart(pane.card, layout.progress));
    std::vector<Rect> parts = {pane.title, pane.view, pane.tracking, pane.jitter};
    if (pane.error.height > 0.0) parts.push_back(pane.error);
    if (pane.jitter_curve.height > 0.0) parts.push_back(pane.jitter_curve);
    if (pane_count <= 3) {
      EXPECT_GE(pane.view.height, 0.55 * pane.card.height);
    }
    const bool is_small = width < 700 && pane_count <= 2;
    EXPECT_EQ(pane.error.height > 0.0, !is_small);
    EXPECT_EQ(pane.jitter_curve.height > 0.0, pane_count <= 4 && !is_small);
    for (const Rect& part : parts) {
      EXPECT_TRUE(Inside(part, pane.card));
      EXPECT_EQ(part.x, std::round(part.x));
      EXPECT_EQ(part.width, std::round(part.width));
      EXPECT_GE(part.width, 0.15 * pane.card.width);
      EXPECT_GE(part.height, 12.0 * layout.unit);
      for (const Rect& other : parts) {
        EXPECT_TRUE(&part == &other || Apart(part, other));
      }
    }
    // One size of picture serves all panes.
    EXPECT_EQ(pane.view.width, layout.panes[0].view.width);
    EXPECT_EQ(pane.view.height, layout.panes[0].view.height);
    for (std::size_t j = 0; j < i; ++j) EXPECT_TRUE(Apart(pane.card, layout.panes[j].card));
  }
}

TEST(VideoLayout, AnOverlayHasItsHandsBesideNumbersAndAllCurves) {
  for (const auto& [width, height] : {std::pair(1280, 720), {480, 270}, {1000, 1000}}) {
    const VideoLayout layout = LayOutOverlay(width, height);
    ASSERT_EQ(layout.panes.size(), 1u);
    const PaneLayout& pane = layout.panes[0];
    const Rect parts[] = {pane.title,  pane.view,  pane.tracking,
                          pane.jitter, pane.error, pane.jitter_curve};
    for (const Rect& part : parts) {
      EXPECT_TRUE(Inside(part, pane.card));
      EXPECT_GE(part.height, 12.0 * layout.unit);
      for (const Rect& other : parts) EXPECT_TRUE(&part == &other || Apart(part, other));
    }
    EXPECT_GT(pane.view.height, 0.8 * pane.card.height);
    EXPECT_TRUE(Apart(pane.card, layout.header));
    EXPECT_TRUE(Apart(pane.card, layout.progress));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sizes, EveryVideoLayout,
    testing::Combine(testing::Values(std::pair(1280, 720), std::pair(1920, 1080),
                                     std::pair(640, 360), std::pair(1000, 1000)),
                     testing::Range(1, kMaxPanes + 1)));

// Letters of 14 design pixels, as a telephone shows a picture of 640 px on 360.
TEST(VideoLayout, LettersOfASmallFrameCanBeRead) {
  EXPECT_GE(14.0 * LayOutVideo(640, 360, 2).unit * 360.0 / 640.0, 7.5);
  EXPECT_EQ(LayOutVideo(640, 360, 3).unit, 0.5);
  EXPECT_EQ(LayOutVideo(1280, 720, 2).unit, 1.0);
}

TEST(VideoLayout, RefusesWhatCannotBeRead) {
  EXPECT_THROW(LayOutVideo(1280, 720, 0), UserError);
  EXPECT_THROW(LayOutVideo(1280, 720, kMaxPanes + 1), UserError);
  EXPECT_THROW(LayOutVideo(320, 180, 1), UserError);
}

}  // namespace
}  // namespace gauntlet::sim
