// Colours are told apart: from their ground, and from each other with any kind of colour vision.
#include "sim/show/figure/palette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gauntlet::sim {
namespace {

using namespace palette;

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

// Of linear light. Source: Machado, Oliveira, Fernandes 2009, table 1, severity 1.0.
constexpr Matrix kNormal = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Matrix kProtanopia = {{{0.152286, 1.052583, -0.204868},
                                 {0.114503, 0.786281, 0.099216},
                                 {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix kDeuteranopia = {{{0.367322, 0.860646, -0.227968},
                                   {0.280085, 0.672501, 0.047413},
                                   {-0.011820, 0.042940, 0.968881}}};
constexpr Matrix kTritanopia = {{{1.255528, -0.076749, -0.178779},
                                 {-0.078411, 0.930809, 0.147602},
                                 {0.004733, 0.691367, 0.303900}}};

Vector Times(const Matrix& matrix, const Vector& v) {
  Vector product{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) product[i] += matrix[i][j] * v[j];
  }
  return product;
}

Vector LinearLightOf(unsigned hex) {
  const Color color = Rgb(hex);
  Vector light = {color.red, color.green, color.blue};
  for (double& part : light) {
    part = part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
  }
  return light;
}

/// Contrast of two colours by WCAG 2.2: (L1 + 0.05) / (L2 + 0.05) of their relative luminances.
double ContrastOf(unsigned a, unsigned b) {
  const auto luminance = [](unsigned hex) {
    const auto [red, green, blue] = LinearLightOf(hex);
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  };
  const auto [low, high] = std::minmax({luminance(a), luminance(b)});
  return (high + 0.05) / (low + 0.05);
}

/// CIE L*a*b* of D65.
Vector LabOf(unsigned hex, const Matrix& vision) {
  Vector light = Times(vision, LinearLightOf(hex));
  for (double& part : light) part = std::clamp(part, 0.0, 1.0);
  constexpr Matrix kXyz = {
      {{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};
  constexpr Vector kWhite = {0.95047, 1.0, 1.08883};
  Vector xyz = Times(kXyz, light);
  for (int i = 0; i < 3; ++i) {
    const double t = xyz[i] / kWhite[i];
    xyz[i] = t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
  }
  return {116.0 * xyz[1] - 16.0, 500.0 * (xyz[0] - xyz[1]), 200.0 * (xyz[1] - xyz[2])};
}

/// The least CIE 1976 difference of two colours over all kinds of colour vision.
double LeastDifference(unsigned a, unsigned b) {
  double least = INFINITY;
  for (const Matrix& vision : {kNormal, kProtanopia, kDeuteranopia, kTritanopia}) {
    const Vector p = LabOf(a, vision), q = LabOf(b, vision);
    least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  return least;
}

TEST(Palette, ContrastIsThatOfWcag) {
  EXPECT_NEAR(ContrastOf(0x000000, 0xffffff), 21.0, 1e-9);
  EXPECT_NEAR(ContrastOf(0x777777, 0xffffff), 4.48, 0.005);  // the usual example of a failure
  EXPECT_EQ(ContrastOf(0x123456, 0x123456), 1.0);
}

/// 0xRRGGBB of one of the 256 colours of xterm, of the cube or the greys.
unsigned TerminalRgb(unsigned number) {
  constexpr std::array<unsigned, 6> kLevels = {0, 95, 135, 175, 215, 255};
  if (number >= 232) return (8 + 10 * (number - 232)) * 0x010101;
  const unsigned place = number - 16;
  return kLevels[place / 36] << 16 | kLevels[place / 6 % 6] << 8 | kLevels[place % 6];
}

TEST(Palette, ATerminalOfAnyGroundShowsItsColours) {
  for (const unsigned a : kTerminalSeries) {
    EXPECT_GE(ContrastOf(TerminalRgb(a), 0xffffff), 3.0) << a;
    EXPECT_GE(ContrastOf(TerminalRgb(a), 0x000000), 3.0) << a;
    for (const unsigned b : kTerminalSeries) {
      if (a == b) continue;
      EXPECT_GE(LeastDifference(TerminalRgb(a), TerminalRgb(b)), 9.0) << a << " " << b;
    }
  }
}

TEST(Palette, EverythingIsSeenOnBothGrounds) {
  for (const Shade& ground : {kGround, kPanel}) {
    const auto expect = [&](const Shade& shade, double least) {
      EXPECT_GE(ContrastOf(shade.light, ground.light), least) << shade.name;
      EXPECT_GE(ContrastOf(shade.dark, ground.dark), least) << shade.name;
    };
    for (const Shade& text : {kInk, kMuted, kAccent, kGood, kWarn}) expect(text, 4.5);
    for (const Shade& mark : {kWearer, kGlove, kCommand, kSecond}) expect(mark, 3.0);
    for (const Shade& series : kSeries) expect(series, 3.0);
  }
}

// 2.3 is just noticeable side by side; thin lines need more.
TEST(Palette, ColoursThatAreComparedDifferForEveryKindOfColourVision) {
  const auto expect = [](const Shade& a, const Shade& b, double least) {
    EXPECT_GE(LeastDifference(a.light, b.light), least) << a.name << " " << b.name << ", light";
    EXPECT_GE(LeastDifference(a.dark, b.dark), least) << a.name << " " << b.name << ", dark";
  };
  for (std::size_t i = 0; i < kSeries.size(); ++i) {
    const bool first = i < 4;  // baseline, recommended, two alternatives
    expect(kSeries[i], kWearer, first ? 15.0 : 8.0);
    for (std::size_t j = 0; j < i; ++j) expect(kSeries[i], kSeries[j], first ? 15.0 : 8.0);
  }
  expect(kHand, kCommand, 15.0);
  expect(kSeries[2], kCommand, 15.0);
  expect(kWearer, kGlove, 15.0);
  expect(kWearer, kSecond, 15.0);
}

TEST(Palette, TheBaselineHasItsOwnColourAndTheOthersThoseOfTheirOrder) {
  EXPECT_EQ(SeriesOf({2, 0, 1}, 0), (std::vector<std::size_t>{0, 2, 1}));
  EXPECT_EQ(SeriesOf({0, 1, 2}, 0), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(SeriesOf({1, 0}, std::nullopt), (std::vector<std::size_t>{2, 1}));
}

TEST(Palette, PagesDefineBothSchemes) {
  const std::string css = PaletteCss();
  EXPECT_NE(css.find("--wearer:#ae226f;"), std::string::npos);
  EXPECT_GT(css.find("--wearer:#ff4f70;"), css.find("prefers-color-scheme:dark"));
  EXPECT_EQ(CssOfSeries(1), "var(--c1)");
  EXPECT_EQ(CssOfSeries(12).substr(0, 4), "hsl(");
}

}  // namespace
}  // namespace gauntlet::sim
