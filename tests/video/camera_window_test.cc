#include "sim/show/video/camera_window.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/show/video/osmesa_renderer.h"
#include "tests/video/tiny_model.h"

namespace gauntlet::sim {
namespace {

// A ball, seen from below and aside by a camera with a roll of its own.
constexpr const char* kBall = R"(
<mujoco>
  <worldbody>
    <camera name="front" pos="0.3 -2 -0.4" xyaxes="0.96 0.28 0 -0.084 0.288 0.954" fovy="40"/>
    <body pos="0.1 0.2 0.15"><geom type="sphere" size="0.04"/></body>
  </worldbody>
</mujoco>)";

/// The middle of all that is drawn.
Point MiddleOf(const Image& picture) {
  double x = 0.0, y = 0.0, sum = 0.0;
  for (int v = 0; v < picture.height_px; ++v) {
    for (int u = 0; u < picture.width_px; ++u) {
      const double cover = picture.Row(v)[u] >> 24;
      x += cover * (u + 0.5), y += cover * (v + 0.5), sum += cover;
    }
  }
  return {x / sum, y / sum};
}

// The renderer is the independent calculation.
TEST(CameraWindow, APointIsWhereTheRendererDrawsIt) {
  const TinyModel ball(kBall);
  mj_forward(&ball.model(), &ball.data());
  const int camera = FindCamera(ball.model(), "front", false).value();
  const auto seen =
      SeenFrom(ball.data(), camera, std::span<const mjtNum, 3>(ball.data().geom_xpos, 3));
  ASSERT_TRUE(seen);
  const auto [x, y] = seen->tangents;
  for (const CameraWindow& window : {CameraWindow{x - 0.3, x + 0.1, y - 0.05, y + 0.2},
                                     CameraWindow{x - 0.05, x + 0.1, y - 0.1, y + 0.05}}) {
    const CameraWindow framed = WindowAround(window, 160, 120);
    Image picture;
    OsmesaRenderer(ball.model(),
                   {.width_px = 160, .height_px = 120, .camera = "front", .window = framed})
        .Draw(ball.data(), picture);
    const Point expected = PixelOf(framed, seen->tangents, 160, 120);
    const Point drawn = MiddleOf(picture);
    EXPECT_NEAR(drawn.x, expected.x, 0.7);  // a ball's picture is not quite round aside
    EXPECT_NEAR(drawn.y, expected.y, 0.7);
  }
}

TEST(CameraWindow, NothingIsSeenBehindTheCamera) {
  const TinyModel ball(kBall);
  mj_forward(&ball.model(), &ball.data());
  const mjtNum behind_m[3] = {0.0, -5.0, 0.0};
  EXPECT_FALSE(SeenFrom(ball.data(), 0, behind_m));
}

TEST(CameraWindow, WindowAroundKeepsTheSidesRatioAndAllThatIsShown) {
  const CameraWindow shown = {-0.1, 0.3, 0.2, 0.3};
  for (const auto& [width, height] : {std::pair(300, 400), std::pair(400, 100)}) {
    const CameraWindow window = WindowAround(shown, width, height);
    EXPECT_NEAR(window.width() / window.height(), double(width) / height, 1e-12);
    EXPECT_LT(window.left, shown.left);
    EXPECT_GT(window.right, shown.right);
    EXPECT_LT(window.bottom, shown.bottom);
    EXPECT_GT(window.top, shown.top);
    EXPECT_NEAR(window.left + window.right, shown.left + shown.right, 1e-12);
    EXPECT_NEAR(window.bottom + window.top, shown.bottom + shown.top, 1e-12);
  }
}

}  // namespace
}  // namespace gauntlet::sim
