#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sim/show/video/image.h"
#include "sim/show/video/palette.h"

namespace gauntlet::sim {

/// In pixels, from the top left corner.
struct Rect {
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
};

struct Point {
  double x = 0.0;
  double y = 0.0;
};

enum class Align { kLeft, kCenter, kRight };

struct TextStyle {
  double size_px = 14.0;
  Color color = palette::kInkOnLight;
  bool bold = false;
  Align align = Align::kLeft;
  /// All digits take the same width, so that a running number stands still.
  bool tabular = false;
};

/// Draws shapes and text onto an image, smoothly.
class Painter {
 public:
  Painter() = default;
  virtual ~Painter() = default;
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  virtual void Fill(const Rect& rect, const Color& color, double radius = 0.0) = 0;
  virtual void FillGradient(const Rect& rect, const Color& top, const Color& bottom) = 0;
  virtual void FillGradientAcross(const Rect& rect, const Color& left, const Color& right) = 0;
  virtual void Outline(const Rect& rect, const Color& color, double line_width, double radius) = 0;
  void Line(Point from, Point to, const Color& color, double line_width) {
    Polyline(std::array{from, to}, color, line_width);
  }
  /// A point that is not finite interrupts the line.
  virtual void Polyline(std::span<const Point> points, const Color& color, double line_width) = 0;
  /// Between a line and a height; a point that is not finite interrupts both.
  virtual void FillBetween(std::span<const Point> points, double y, const Color& color) = 0;
  virtual void Dot(Point center, double radius, const Color& color) = 0;
  /// `picture` over what is there, its top left corner at whole pixels.
  virtual void Picture(const Image& picture, int x, int y, double opacity = 1.0) = 0;
  /// From the baseline at `at`.
  virtual void Text(std::string_view text, Point at, const TextStyle& style) = 0;
  virtual double TextWidth(std::string_view text, const TextStyle& style) = 0;
  /// The text, shortened by an ellipsis where it is wider than `width`.
  virtual std::string Elide(std::string_view text, double width, const TextStyle& style) = 0;

  /// Nothing is drawn outside `rect` until Unclip().
  virtual void Clip(const Rect& rect, double radius = 0.0) = 0;
  virtual void Unclip() = 0;
};

/// A painter on this image, which must outlive it. Errors: RunError without the drawing library.
std::unique_ptr<Painter> OpenPainter(ImageView image);

}  // namespace gauntlet::sim
