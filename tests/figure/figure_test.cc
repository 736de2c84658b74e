// Figures: places, widths of texts, and the SVG of each shape.
#include "sim/show/figure/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "controller/number.h"
#include "sim/show/figure/panel.h"

namespace gauntlet::sim {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

TEST(Panel, HasTheRangesOfItsAxesFromTheLowerLeftToTheUpperRightCorner) {
  const Panel panel({10.0, 20.0, 110.0, 220.0}, {{-1.0, 1.0}}, {{0.0, 4.0}});
  EXPECT_EQ(panel.X(-1.0), 10.0);
  EXPECT_EQ(panel.X(0.0), 60.0);
  EXPECT_EQ(panel.X(1.0), 110.0);
  EXPECT_EQ(panel.Y(0.0), 220.0);
  EXPECT_EQ(panel.Y(1.0), 170.0);
}

TEST(Panel, LabelsEachTickOnceAndDrawsTheLineAtZeroAsAnAxis) {
  Figure figure{200.0, 100.0, "test", "test"};
  const Panel panel(figure.Inside(), {{0.0, 1.0}, "time"}, {{-0.3, 0.3}, "angle", 6, true});
  panel.AddAxes(figure);
  std::vector<std::string> texts, lines;
  for (const FigureShape& shape : figure.shapes) {
    if (shape.kind == FigureShape::Kind::kLine) lines.push_back(shape.ink.css);
    if (!shape.text.empty()) texts.push_back(shape.text);
  }
  EXPECT_THAT(texts, testing::ElementsAre("−0.3", "−0.2", "−0.1", "0", "0.1", "0.2", "0.3", "time",
                                          "angle"));
  EXPECT_THAT(lines, testing::ElementsAre("grid", "grid", "grid", "axis", "grid", "grid", "grid"));
}

TEST(SvgOf, DrawsEachShapeWithItsTitleAndEscapesTexts) {
  Figure figure{100.0, 50.0, "kind", "a < b"};
  figure.Line({0.0, 1.0}, {2.0, 3.04}, {"grid"});
  figure.Path({{0.0, 0.0}, {1.0, 1.0}, {controller::kNaN, 0.0}, {2.0, 2.0}}, {"curve"});
  figure.Area({{0.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}, InkOfSeries(2, "band"));
  figure.Box({8.0, 9.0}, {2.0, 4.0}, InkOfPoint(7, "cell"), 3.0);
  figure.Dot({5.0, 6.0}, 1.5, {"dot", "<said>"});
  figure.Text({1.0, 2.0}, Anchor::kEnd, "x & y");
  const std::string svg = SvgOf(figure);
  EXPECT_THAT(
      svg,
      AllOf(HasSubstr("<svg class=\"kind\" style=\"--natural: 100px\" viewBox=\"0 0 100 50\" "
                      "role=\"img\" aria-label=\"a &lt; b\">"),
            HasSubstr("<line class=\"grid\" x1=\"0\" y1=\"1\" x2=\"2\" y2=\"3\"/>"),
            HasSubstr("<path class=\"curve\" d=\"M0 0 1 1M2 2\"/>"),
            HasSubstr("<path style=\"--series: var(--c2)\" class=\"band\" d=\"M0 0 1 1 0 1Z\"/>"),
            HasSubstr("<rect data-point=\"7\" class=\"cell\" x=\"2\" y=\"4\" width=\"6\" "
                      "height=\"5\" rx=\"3\"/>"),
            HasSubstr("<circle class=\"dot\" cx=\"5\" cy=\"6\" r=\"1.5\"><title>&lt;said&gt;"
                      "</title></circle>"),
            HasSubstr("<text x=\"1\" y=\"2\" text-anchor=\"end\">x &amp; y</text>"),
            EndsWith("</svg>\n"), Not(HasSubstr("nan"))));
}

TEST(SvgOf, IsAFileWithAStyleSheet) {
  const Figure figure{10.0, 20.0, "kind", "said"};
  EXPECT_THAT(SvgOf(figure, "<style>a{}</style>"),
              HasSubstr("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10\" height=\"20\" "
                        "viewBox=\"0 0 10 20\" role=\"img\" aria-label=\"said\"><style>a{}"));
}

TEST(TextWidth, IsThatOfTheLettersAndProportionalToTheirSize) {
  EXPECT_NEAR(TextWidth("iii", 1000.0), 3.0 * 278.0, 1e-9);
  EXPECT_NEAR(TextWidth("WWW", 10.0), 3.0 * 9.89, 1e-9);
  EXPECT_NEAR(TextWidth("°", 10.0), TextWidth("…", 10.0), 1e-9);  // one letter each
}

TEST(FittedText, KeepsWhatFitsAndWholeLetters) {
  EXPECT_EQ(FittedText("channel", 200.0), "channel");
  const std::string shown = FittedText("ääääääääää", 60.0, 10.0);
  EXPECT_LE(TextWidth(shown, 10.0), 60.0);
  EXPECT_EQ(shown, "ääääää…");
}

}  // namespace
}  // namespace gauntlet::sim
