#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "sim/show/video/image.h"
#include "sim/show/video/palette.h"

struct _cairo;
struct _cairo_surface;

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

/// Draws shapes and text onto an image, smoothly. The image must outlive the painter.
class Painter {
 public:
  explicit Painter(ImageView image);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  void Fill(const Rect& rect, const Color& color, double radius = 0.0);
  void FillGradient(const Rect& rect, const Color& top, const Color& bottom);
  void FillGradientAcross(const Rect& rect, const Color& left, const Color& right);
  void Outline(const Rect& rect, const Color& color, double line_width, double radius);
  void Line(Point from, Point to, const Color& color, double line_width);
  /// A point that is not finite interrupts the line.
  void Polyline(std::span<const Point> points, const Color& color, double line_width);
  /// Between a line and a height; a point that is not finite interrupts both.
  void FillBetween(std::span<const Point> points, double y, const Color& color);
  void Dot(Point center, double radius, const Color& color);
  /// `picture` over what is there, its top left corner at whole pixels.
  void Picture(const Image& picture, int x, int y, double opacity = 1.0);
  /// From the baseline at `at`.
  void Text(std::string_view text, Point at, const TextStyle& style);
  double TextWidth(std::string_view text, const TextStyle& style);
  /// The text, shortened by an ellipsis where it is wider than `width`.
  std::string Elide(std::string_view text, double width, const TextStyle& style);

  /// Nothing is drawn outside `rect` until Unclip().
  void Clip(const Rect& rect, double radius = 0.0);
  void Unclip();

 private:
  void FillGradient(const Rect& rect, Point from, Point to, const Color& first, const Color& last);
  void UseFont(const TextStyle& style);
  void Trace(const Rect& rect, double radius);

  _cairo_surface* surface_ = nullptr;
  _cairo* cairo_ = nullptr;
};

}  // namespace gauntlet::sim
