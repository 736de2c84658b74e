#include "sim/show/video/osmesa_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>

#include "sim/base/error.h"
#include "tests/video/tiny_model.h"

namespace gauntlet::sim {
namespace {

using testing::HasSubstr;

int Alpha(std::uint32_t pixel) { return static_cast<int>(pixel >> 24); }
int Red(std::uint32_t pixel) { return static_cast<int>(pixel >> 16 & 255); }
int Green(std::uint32_t pixel) { return static_cast<int>(pixel >> 8 & 255); }
int Blue(std::uint32_t pixel) { return static_cast<int>(pixel & 255); }

// A red box of 0.2 m right of the middle and a green ball up left of it, seen from 2 m by a camera
// with a field of view of 53.13 degrees: the picture's shorter side is 2 m in the plane of the
// shapes.
constexpr const char* kShapes = R"(
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="front" pos="0 -2 0" xyaxes="1 0 0 0 0 1" fovy="53.13"/>
    <camera name="back" pos="0 2 0" xyaxes="-1 0 0 0 0 1" fovy="53.13"/>
    <body pos="0.5 0 0">
      <joint type="slide" axis="0 0 1"/>
      <geom type="box" size="0.1 0.001 0.1" rgba="1 0 0 1"/>
    </body>
    <geom type="sphere" size="0.05" pos="-0.5 0 0.5" rgba="0 1 0 1"/>
  </worldbody>
</mujoco>)";

Image DrawShapes(const RendererConfig& config, double box_height = 0.0) {
  TinyModel model(kShapes);
  model.data().qpos[0] = box_height;
  mj_forward(&model.model(), &model.data());
  OsmesaRenderer renderer(model.model(), config);
  Image picture;
  renderer.Draw(model.data(), picture);
  return picture;
}

// 100 px are 2 m: the box spans x = 70 .. 80, y = 45 .. 55 and the ball is centred at (25, 25).
TEST(OsmesaRenderer, DrawsColouredBodiesWhereTheyAre) {
  const Image picture = DrawShapes({.width_px = 100, .height_px = 100, .camera = "front"});
  ASSERT_EQ(picture.width_px, 100);
  ASSERT_EQ(picture.height_px, 100);
  for (int y = 46; y < 54; ++y) {
    for (int x = 71; x < 79; ++x) {
      EXPECT_GT(Red(picture.Row(y)[x]), 200) << x << " " << y;
      EXPECT_LT(Green(picture.Row(y)[x]), 40);
    }
  }
  EXPECT_GT(Green(picture.Row(25)[25]), 200);
  EXPECT_LT(Red(picture.Row(25)[25]), 40);
}

TEST(OsmesaRenderer, LeavesTheBackgroundTransparentAndEdgesSmooth) {
  const Image picture = DrawShapes({.width_px = 100, .height_px = 100, .camera = "front"});
  int covered = 0, clear = 0, partly = 0;
  for (std::uint32_t pixel : picture.pixels) {
    // Premultiplied: no part is brighter than the alpha allows.
    EXPECT_LE(std::max({Red(pixel), Green(pixel), Blue(pixel)}), Alpha(pixel));
    ++(Alpha(pixel) == 255 ? covered : Alpha(pixel) == 0 ? clear : partly);
  }
  // A box of 10 x 10 px and a disc of radius 2.5 px; edges count half.
  EXPECT_NEAR(covered + 0.5 * partly, 100.0 + 3.1416 * 2.5 * 2.5, 8.0);
  EXPECT_GT(partly, 5);
  EXPECT_EQ(covered + partly + clear, 10000);
}

TEST(OsmesaRenderer, FollowsThePosture) {
  // 0.5 m up are 25 px up.
  const Image picture = DrawShapes({.width_px = 100, .height_px = 100, .camera = "front"}, 0.5);
  EXPECT_GT(Red(picture.Row(25)[75]), 200);
  EXPECT_EQ(Alpha(picture.Row(50)[75]), 0);
}

TEST(OsmesaRenderer, SeesFromTheNamedCamera) {
  const Image picture = DrawShapes({.width_px = 100, .height_px = 100, .camera = "back"});
  EXPECT_GT(Red(picture.Row(50)[25]), 200);
  EXPECT_EQ(Alpha(picture.Row(50)[75]), 0);
}

TEST(OsmesaRenderer, FieldOfViewIsThatOfTheShorterSide) {
  // In both the shorter side is 100 px and 2 m; the box's centre is 25 px right of the middle.
  const Image tall = DrawShapes({.width_px = 100, .height_px = 180, .camera = "front"});
  EXPECT_GT(Red(tall.Row(90)[79 - 1]), 200);
  EXPECT_EQ(Alpha(tall.Row(90)[82]), 0);
  const Image wide = DrawShapes({.width_px = 180, .height_px = 100, .camera = "front"});
  EXPECT_GT(Red(wide.Row(50)[118]), 200);
  EXPECT_EQ(Alpha(wide.Row(50)[122]), 0);
}

TEST(OsmesaRenderer, ATallPictureTakesTheUprightCamera) {
  TinyModel model(R"(
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="front" pos="0 -2 0" xyaxes="1 0 0 0 0 1" fovy="53.13"/>
    <camera name="front_upright" pos="0 -2 0" xyaxes="0 0 1 -1 0 0" fovy="53.13"/>
    <geom type="box" size="0.1 0.001 0.1" pos="0.5 0 0" rgba="1 0 0 1"/>
  </worldbody>
</mujoco>)");
  mj_forward(&model.model(), &model.data());
  Image wide, tall;
  OsmesaRenderer(model.model(), {.width_px = 100, .height_px = 80, .camera = "front"})
      .Draw(model.data(), wide);
  OsmesaRenderer(model.model(), {.width_px = 80, .height_px = 100, .camera = "front"})
      .Draw(model.data(), tall);
  EXPECT_GT(Red(wide.Row(40)[50 + 20]), 200);  // 80 px are 2 m: 20 px right
  EXPECT_GT(Red(tall.Row(50 + 25)[40]), 200);  // 100 px are 2 m: 25 px below
}

TEST(OsmesaRenderer, SupersamplingKeepsThePicture) {
  for (int supersampling : {1, 2, 3, 4}) {
    const Image picture = DrawShapes(
        {.width_px = 50, .height_px = 50, .camera = "front", .supersampling = supersampling});
    EXPECT_GT(Red(picture.Row(25)[37]), 200) << supersampling;
    EXPECT_EQ(Alpha(picture.Row(25)[37]), 255) << supersampling;
    EXPECT_EQ(Alpha(picture.Row(40)[10]), 0) << supersampling;
  }
}

TEST(OsmesaRenderer, TranslucentOverOpaqueStaysCovered) {
  TinyModel model(R"(
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="front" pos="0 -2 0" xyaxes="1 0 0 0 0 1" fovy="53.13"/>
    <geom type="box" size="0.5 0.001 0.5" rgba="1 0 0 1"/>
    <geom type="box" size="0.2 0.001 0.8" pos="0 -0.2 0" rgba="0 0 1 0.5"/>
  </worldbody>
</mujoco>)");
  mj_forward(&model.model(), &model.data());
  OsmesaRenderer renderer(model.model(), {.width_px = 100, .height_px = 100, .camera = "front"});
  Image picture;
  renderer.Draw(model.data(), picture);
  const std::uint32_t both = picture.Row(50)[50];
  EXPECT_EQ(Alpha(both), 255);
  // The front and the back of the blue box each leave half of what is behind them.
  EXPECT_NEAR(Red(both), 255 / 4, 5);
  EXPECT_NEAR(Blue(both), 255 * 3 / 4, 5);
  for (std::uint32_t pixel : picture.pixels) {
    ASSERT_LE(std::max({Red(pixel), Green(pixel), Blue(pixel)}), Alpha(pixel));
  }
}

TEST(OsmesaRenderer, CablesHaveTheColourOfTheirPull) {
  TinyModel model(R"(
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="front" pos="0 -2 0" xyaxes="1 0 0 0 0 1" fovy="53.13"/>
    <site name="a" pos="-1 0 0.5"/><site name="b" pos="1 0 0.5"/>
    <site name="c" pos="-1 0 -0.5"/><site name="d" pos="1 0 -0.5"/>
  </worldbody>
  <tendon>
    <spatial name="upper" width="0.1" rgba="0 1 0 1"><site site="a"/><site site="b"/></spatial>
    <spatial name="lower" width="0.1" rgba="0 1 0 1"><site site="c"/><site site="d"/></spatial>
  </tendon>
</mujoco>)");
  mj_forward(&model.model(), &model.data());
  OsmesaRenderer renderer(
      model.model(), {.width_px = 100, .height_px = 100, .camera = "front", .plain_cables = true});
  Image picture;
  const auto colour = [&](int row) { return picture.Row(row)[50]; };
  renderer.Draw(model.data(), picture);
  EXPECT_GT(Green(colour(25)), Red(colour(25)) + 50u);  // as the model has it
  const std::vector<float> slack_and_pulling = {0.0f, 1.0f};
  renderer.Draw(model.data(), picture, {.cable_share = slack_and_pulling});
  EXPECT_NEAR(Red(colour(25)), Green(colour(25)), 2);
  EXPECT_NEAR(Red(colour(25)), Blue(colour(25)), 2);
  EXPECT_GT(Red(colour(75)), 2u * Green(colour(75)));
  const std::vector<float> hardly = {0.0f, 0.01f};
  const auto most = Red(colour(75));
  renderer.Draw(model.data(), picture, {.cable_share = hardly});
  EXPECT_LT(Red(colour(75)), most);
}

TEST(OsmesaRenderer, LinksHaveTheColourOfTheirError) {
  TinyModel model(kShapes);  // a red box in a body of its own, a green ball in the world
  mj_forward(&model.model(), &model.data());
  OsmesaRenderer renderer(model.model(), {.width_px = 100, .height_px = 100, .camera = "front"});
  Image picture;
  const auto box = [&] { return picture.Row(50)[75]; };
  for (const float share : {0.0f, 0.5f, 1.0f}) {
    const std::vector<float> shares = {0.0f, share};
    renderer.Draw(model.data(), picture, {.link_share = shares, .link = Rgb(0x0000ff)});
    EXPECT_NEAR(Red(box()), 255 * (1.0 - share), 3);
    EXPECT_NEAR(Blue(box()), 255 * share, 3);
    EXPECT_GT(Green(picture.Row(25)[25]), 200);
  }
}

TEST(OsmesaRenderer, AShadowDarkensTheGround) {
  TinyModel model(R"(
<mujoco>
  <visual><headlight active="0"/></visual>
  <worldbody>
    <light directional="true" pos="0 0 3" dir="0 0 -1" diffuse="1 1 1"/>
    <camera name="front" pos="0 -2 2" xyaxes="1 0 0 0 1 1" fovy="45"/>
    <geom type="box" size="1 1 0.01" rgba="1 1 1 1"/>
    <geom type="box" size="0.2 0.2 0.02" pos="0 0 0.5" rgba="1 1 1 1"/>
  </worldbody>
</mujoco>)");
  mj_forward(&model.model(), &model.data());
  double brightness[2];
  for (bool shadows : {false, true}) {
    OsmesaRenderer renderer(
        model.model(), {.width_px = 100, .height_px = 100, .camera = "front", .shadows = shadows});
    Image picture;
    renderer.Draw(model.data(), picture);
    double sum = 0.0;
    for (std::uint32_t pixel : picture.pixels) sum += Green(pixel);
    brightness[shadows] = sum;
  }
  EXPECT_LT(brightness[true], 0.99 * brightness[false]);
}

// The camera looks along a plane with balls everywhere, most of them out of sight.
TEST(OsmesaRenderer, LeavesOutOnlyWhatIsOutOfSight) {
  std::string balls;
  for (int x = -6; x <= 6; ++x) {
    for (int y = -6; y <= 6; ++y) {
      balls += "<geom type='capsule' size='0.1 0.3' pos='" + std::to_string(0.7 * x) + " " +
               std::to_string(0.7 * y) + " 0' euler='" + std::to_string(20 * x) + " 30 0'/>";
    }
  }
  TinyModel model(
      "<mujoco><worldbody><camera name='front' pos='0.3 -2 0.4' xyaxes='1 0.2 0 0 0 1'/>" + balls +
      "</worldbody></mujoco>");
  mj_forward(&model.model(), &model.data());
  // Shadows keep everything; with no light that casts one, the picture must be the same.
  Image all, seen;
  for (const auto& [width, height] : {std::pair(160, 90), std::pair(90, 160)}) {
    RendererConfig config = {.width_px = width, .height_px = height, .camera = "front"};
    OsmesaRenderer(model.model(), config).Draw(model.data(), seen);
    config.shadows = true;
    OsmesaRenderer(model.model(), config).Draw(model.data(), all);
    EXPECT_EQ(all.pixels, seen.pixels);
  }
}

TEST(OsmesaRenderer, PlainCablesLookLikeRoundOnes) {
  TinyModel model(R"(
<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <worldbody>
    <camera name="front" pos="0 -2 0" xyaxes="1 0 0 0 0 1" fovy="53.13"/>
    <body><joint type="slide" axis="1 0 0"/><geom size="0.01"/>
      <site name="a" pos="-0.6 0 -0.2" size="0.001"/></body>
    <site name="b" pos="0.6 0 0.2" size="0.001"/>
  </worldbody>
  <tendon><spatial width="0.02" rgba="1 0 0 1"><site site="a"/><site site="b"/></spatial></tendon>
</mujoco>)");
  mj_forward(&model.model(), &model.data());
  double red[2] = {};
  for (bool plain : {false, true}) {
    OsmesaRenderer renderer(
        model.model(),
        {.width_px = 100, .height_px = 100, .camera = "front", .plain_cables = plain});
    Image picture;
    renderer.Draw(model.data(), picture);
    EXPECT_GT(Red(picture.Row(45)[65]), 100);
    for (std::uint32_t pixel : picture.pixels) red[plain] += Red(pixel) / 255.0;
  }
  EXPECT_GT(red[false], 90.0);
  EXPECT_NEAR(red[true] / red[false], 1.0, 0.2);
}

TEST(OsmesaRenderer, TheGroundCanBeLeftOut) {
  TinyModel model(R"(
<mujoco><worldbody>
  <camera name="front" pos="0 -2 1" xyaxes="1 0 0 0 1 1"/><geom type="plane" size="3 3 1"/>
</worldbody></mujoco>)");
  mj_forward(&model.model(), &model.data());
  for (bool ground : {false, true}) {
    OsmesaRenderer renderer(model.model(), {.camera = "front", .ground = ground});
    Image picture;
    renderer.Draw(model.data(), picture);
    EXPECT_EQ(Alpha(picture.Row(240)[320]), ground ? 255 : 0);
  }
}

TEST(OsmesaRenderer, TwoOnOneThreadDoNotDisturbEachOther) {
  TinyModel model(kShapes);
  mj_forward(&model.model(), &model.data());
  OsmesaRenderer small(model.model(), {.width_px = 40, .height_px = 40, .camera = "front"});
  Image first, again, other;
  small.Draw(model.data(), first);
  {
    OsmesaRenderer large(model.model(), {.width_px = 90, .height_px = 90, .camera = "back"});
    large.Draw(model.data(), other);
    small.Draw(model.data(), again);
    EXPECT_EQ(first.pixels, again.pixels);
  }
  small.Draw(model.data(), again);
  EXPECT_EQ(first.pixels, again.pixels);
}

TEST(OsmesaRenderer, NamesAnUnknownCameraAndTheNearest) {
  try {
    DrawShapes({.camera = "frnt"});
    FAIL() << "no error";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr("camera frnt"));
    EXPECT_THAT(error.what(), HasSubstr("did you mean front?"));
  }
}

TEST(OsmesaRenderer, RefusesASizeThatCannotBeDrawn) {
  EXPECT_THROW(DrawShapes({.width_px = 0}), UserError);
  EXPECT_THROW(DrawShapes({.width_px = 10000}), UserError);
  EXPECT_THROW(DrawShapes({.supersampling = 0}), UserError);
}

}  // namespace
}  // namespace gauntlet::sim
