#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/chart_scale.h"

namespace gauntlet::sim {

/// Offsets that all figures share. Units: px.
struct FigureLayout {
  double letters = 12.5;    // size of the letters
  double baseline = 4.0;    // from the middle of a mark down to the baseline of its text
  double tick_gap = 8.0;    // between the panel and the labels beside it
  double tick_drop = 18.0;  // from the panel down to the baseline of the labels below it
  double name_drop = 40.0;  // from the panel down to the baseline of the name of the x axis
  double name_left = 13.0;  // from the left edge to the baseline of the name of the y axis
  double left = 58.0;       // margins of a panel with labels and names
  double top = 12.0;
  double right = 14.0;
  double bottom = 46.0;
};
inline constexpr FigureLayout kFigureLayout;

/// Place in a figure. Units: px from the top left corner.
struct FigurePoint {
  double x = 0.0;
  double y = 0.0;
};

struct FigureBox {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;

  FigurePoint centre() const { return {0.5 * (left + right), 0.5 * (top + bottom)}; }
  bool Meets(const FigureBox& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

enum class Anchor { kStart, kMiddle, kEnd };

/// Appearance and meaning of a shape.
struct Ink {
  std::string css = {};         // class of the style sheet
  std::string said = {};        // text that the pointer and screen readers find
  std::string attributes = {};  // further attributes in SVG, for scripts and colours
};

/// Ink with the number of a point as `data-point`, which scripts look for.
Ink InkOfPoint(std::size_t point, std::string css, std::string attributes = {});
/// Ink with the colour of a series of the palette, as the CSS variable `--series`.
Ink InkOfSeries(std::size_t series, std::string css, std::string said = {});

struct FigureShape {
  enum class Kind { kLine, kPath, kArea, kBox, kDot, kText, kUpwardText };
  Kind kind;
  std::vector<FigurePoint> points;  // of a box two opposite corners; of a dot and a text one
  Ink ink;
  double radius = 0.0;  // of a dot, or of the corners of a box. Units: px
  std::string text = {};
  Anchor anchor = Anchor::kStart;
};

/// A picture of lines, boxes, dots and texts, in which later shapes cover earlier ones.
struct Figure {
  double width_px = 0.0;
  double height_px = 0.0;
  std::string kind;  // class of the SVG
  std::string said;  // content of the picture, for readers who do not see it
  std::vector<FigureShape> shapes = {};

  /// Panel area that leaves the margins of `layout` free.
  FigureBox Inside(const FigureLayout& layout = kFigureLayout) const;

  void Line(FigurePoint from, FigurePoint to, const Ink& ink) { Add(kLine, {from, to}, ink); }
  /// A point that is not finite interrupts a path.
  void Path(const std::vector<FigurePoint>& points, const Ink& ink) { Add(kPath, points, ink); }
  /// Closed and filled.
  void Area(const std::vector<FigurePoint>& points, const Ink& ink) { Add(kArea, points, ink); }
  void Box(FigurePoint corner, FigurePoint opposite, const Ink& ink, double corner_radius = 0.0) {
    Add(kBox, {corner, opposite}, ink).radius = corner_radius;
  }
  void Dot(FigurePoint centre, double radius, const Ink& ink) {
    Add(kDot, {centre}, ink).radius = radius;
  }
  /// From, around or up to the baseline at `at`.
  void Text(FigurePoint at, Anchor anchor, const std::string& text, const Ink& ink = {});
  /// Around `at`, from bottom to top.
  void UpwardText(FigurePoint at, const std::string& text, const Ink& ink = {});

 private:
  using enum FigureShape::Kind;
  FigureShape& Add(FigureShape::Kind shape, const std::vector<FigurePoint>& points,
                   const Ink& ink) {
    return shapes.emplace_back(FigureShape{shape, points, ink});
  }
};

/// A figure as SVG. With a style sheet it is complete as a file; without one it has the styles of
/// the page around it, and its natural width as `--natural`.
std::string SvgOf(const Figure& figure, std::string_view style_sheet = {});

/// Width of a text in DejaVu Sans, the widest of the usual fonts. Units: px.
double TextWidth(std::string_view text, double letters_px = kFigureLayout.letters);
/// The text, shortened by an ellipsis if it is wider than `width_px`.
std::string FittedText(const std::string& text, double width_px,
                       double letters_px = kFigureLayout.letters);

}  // namespace gauntlet::sim
