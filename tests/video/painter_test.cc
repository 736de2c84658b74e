#include "sim/show/video/painter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gauntlet::sim {
namespace {

TEST(Painter, FillsWholePixelsExactly) {
  Image image(10, 10);
  { OpenPainter(image)->Fill({2.0, 3.0, 4.0, 5.0}, Rgb(0x336699)); }
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) {
      const bool inside = x >= 2 && x < 6 && y >= 3 && y < 8;
      EXPECT_EQ(image.Row(y)[x], inside ? 0xff336699u : 0u) << x << " " << y;
    }
  }
}

TEST(Painter, LaysAPictureOverByItsAlpha) {
  Image image(2, 1), picture(2, 1);
  picture.pixels = {0xff0000ffu, 0x00000000u};
  {
    const std::unique_ptr<Painter> opened = OpenPainter(image);
    Painter& painter = *opened;
    painter.Fill({0.0, 0.0, 2.0, 1.0}, Rgb(0xffffff));
    painter.Picture(picture, 0, 0);
  }
  EXPECT_EQ(image.pixels[0], 0xff0000ffu);
  EXPECT_EQ(image.pixels[1], 0xffffffffu);
}

TEST(Painter, ClipsUntilToldOtherwise) {
  Image image(4, 1);
  {
    const std::unique_ptr<Painter> opened = OpenPainter(image);
    Painter& painter = *opened;
    painter.Clip({0.0, 0.0, 2.0, 1.0});
    painter.Fill({0.0, 0.0, 4.0, 1.0}, Rgb(0xffffff));
    painter.Unclip();
    painter.Fill({3.0, 0.0, 1.0, 1.0}, Rgb(0xff0000));
  }
  EXPECT_EQ(image.pixels, (std::vector<std::uint32_t>{0xffffffffu, 0xffffffffu, 0u, 0xffff0000u}));
}

TEST(Painter, AValueThatIsMissingInterruptsALine) {
  Image image(30, 3);
  const Point points[] = {{0.0, 1.5}, {10.0, 1.5}, {NAN, NAN}, {20.0, 1.5}, {30.0, 1.5}};
  { OpenPainter(image)->Polyline(points, Rgb(0xffffff), 1.0); }
  EXPECT_EQ(image.Row(1)[5], 0xffffffffu);
  EXPECT_EQ(image.Row(1)[15], 0u);
  EXPECT_EQ(image.Row(1)[25], 0xffffffffu);
}

TEST(Painter, FillsBetweenALineAndAHeightButNotWhereValuesAreMissing) {
  Image image(40, 10);
  const Point points[] = {{0.0, 2.0}, {10.0, 2.0}, {NAN, NAN}, {20.0, 8.0}, {30.0, 8.0}};
  { OpenPainter(image)->FillBetween(points, 5.0, Rgb(0xffffff)); }
  EXPECT_EQ(image.Row(1)[5], 0u);
  EXPECT_EQ(image.Row(3)[5], 0xffffffffu);
  EXPECT_EQ(image.Row(6)[5], 0u);
  EXPECT_EQ(image.Row(3)[15], 0u);
  EXPECT_EQ(image.Row(6)[15], 0u);
  EXPECT_EQ(image.Row(6)[25], 0xffffffffu);
  EXPECT_EQ(image.Row(3)[25], 0u);
  EXPECT_EQ(image.Row(6)[35], 0u);
}

TEST(Painter, AGradientGoesFromLeftToRight) {
  Image image(100, 2);
  { OpenPainter(image)->FillGradientAcross({0.0, 0.0, 100.0, 2.0}, Rgb(0x000000), Rgb(0xffffff)); }
  for (int x = 0; x < 100; ++x) EXPECT_NEAR(image.Row(1)[x] & 255, 2.55 * (x + 0.5), 3.0);
}

TEST(Painter, TabularNumbersDoNotMove) {
  Image image(10, 10);
  const std::unique_ptr<Painter> opened = OpenPainter(image);
  Painter& painter = *opened;
  const TextStyle style = {.size_px = 20.0, .tabular = true};
  EXPECT_EQ(painter.TextWidth("1.11°", style), painter.TextWidth("8.80°", style));
}

TEST(Painter, ElidesOnlyWhatIsTooLongAndKeepsLettersWhole) {
  Image image(10, 10);
  const std::unique_ptr<Painter> opened = OpenPainter(image);
  Painter& painter = *opened;
  const TextStyle style = {.size_px = 15.0};
  EXPECT_EQ(painter.Elide("Kalman", 1000.0, style), "Kalman");
  const std::string title = "Müller-Größe, prädiktiv, äöüß";
  for (double width = 20.0; width < painter.TextWidth(title, style); width += 3.0) {
    const std::string shown = painter.Elide(title, width, style);
    EXPECT_LE(painter.TextWidth(shown, style), width + 1e-9);
    ASSERT_TRUE(shown.ends_with("…"));
    const std::string kept = shown.substr(0, shown.size() - std::string("…").size());
    EXPECT_TRUE(title.starts_with(kept));
    EXPECT_NE(static_cast<unsigned char>(title[kept.size()]) & 0xc0, 0x80) << "half a letter";
  }
}

}  // namespace
}  // namespace gauntlet::sim
