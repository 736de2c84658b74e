#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/base/error.h"
#include "sim/show/video/drawing_library.h"

namespace gauntlet::sim {
namespace {

// Where it is not installed, fontconfig gives its default, DejaVu Sans on Debian.
constexpr const char* kFontFamily = "Inter";

void SetColor(cairo_t* cairo, const Color& color) {
  cairo_set_source_rgba(cairo, color.red, color.green, color.blue, color.alpha);
}

/// Removes the first letter of UTF-8 text and returns it: all up to the next byte that starts one.
std::string_view RemoveLetter(std::string_view& text) {
  std::size_t size = 1;
  while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80) ++size;
  const std::string_view letter = text.substr(0, size);
  text.remove_prefix(size);
  return letter;
}

bool IsDigit(std::string_view letter) {
  return letter.size() == 1 && letter[0] >= '0' && letter[0] <= '9';
}

double Advance(cairo_t* cairo, std::string_view text) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, std::string(text).c_str(), &extents);
  return extents.x_advance;
}

class CairoPainter final : public Painter {
 public:
  explicit CairoPainter(ImageView image);
  ~CairoPainter() override;

  void Fill(const Rect& rect, const Color& color, double radius) override;
  void FillGradient(const Rect& rect, const Color& top, const Color& bottom) override;
  void FillGradientAcross(const Rect& rect, const Color& left, const Color& right) override;
  void Outline(const Rect& rect, const Color& color, double line_width, double radius) override;
  void Polyline(std::span<const Point> points, const Color& color, double line_width) override;
  void FillBetween(std::span<const Point> points, double y, const Color& color) override;
  void Dot(Point center, double radius, const Color& color) override;
  void Picture(const Image& picture, int x, int y, double opacity) override;
  void Text(std::string_view text, Point at, const TextStyle& style) override;
  double TextWidth(std::string_view text, const TextStyle& style) override;
  std::string Elide(std::string_view text, double width, const TextStyle& style) override;
  void Clip(const Rect& rect, double radius) override;
  void Unclip() override;

 private:
  void FillFrom(const Rect& rect, Point from, Point to, const Color& first, const Color& last);
  void UseFont(const TextStyle& style);
  void Trace(const Rect& rect, double radius);

  cairo_surface_t* surface_ = nullptr;
  cairo_t* cairo_ = nullptr;
};

CairoPainter::CairoPainter(ImageView image) {
  surface_ = cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(image.pixels),
                                                 CAIRO_FORMAT_ARGB32, image.width_px,
                                                 image.height_px, 4 * image.width_px);
  cairo_ = cairo_create(surface_);
  if (const cairo_status_t status = cairo_status(cairo_); status != CAIRO_STATUS_SUCCESS) {
    throw RunError(std::string("video: cannot draw: ") + cairo_status_to_string(status));
  }
  // The same letters on every screen: no hinting to pixels, no subpixel colours.
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo_, options);
  cairo_font_options_destroy(options);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
}

CairoPainter::~CairoPainter() {
  cairo_destroy(cairo_);
  cairo_surface_finish(surface_);
  cairo_surface_destroy(surface_);
}

void CairoPainter::Trace(const Rect& rect, double radius) {
  if (radius <= 0.0) {
    cairo_rectangle(cairo_, rect.x, rect.y, rect.width, rect.height);
    return;
  }
  constexpr double kQuarter = std::numbers::pi / 2.0;
  radius = std::min({radius, rect.width / 2.0, rect.height / 2.0});
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, rect.right() - radius, rect.y + radius, radius, -kQuarter, 0.0);
  cairo_arc(cairo_, rect.right() - radius, rect.bottom() - radius, radius, 0.0, kQuarter);
  cairo_arc(cairo_, rect.x + radius, rect.bottom() - radius, radius, kQuarter, 2.0 * kQuarter);
  cairo_arc(cairo_, rect.x + radius, rect.y + radius, radius, 2.0 * kQuarter, 3.0 * kQuarter);
  cairo_close_path(cairo_);
}

void CairoPainter::Fill(const Rect& rect, const Color& color, double radius) {
  Trace(rect, radius);
  SetColor(cairo_, color);
  cairo_fill(cairo_);
}

void CairoPainter::FillGradient(const Rect& rect, const Color& top, const Color& bottom) {
  FillFrom(rect, {rect.x, rect.y}, {rect.x, rect.bottom()}, top, bottom);
}

void CairoPainter::FillGradientAcross(const Rect& rect, const Color& left, const Color& right) {
  FillFrom(rect, {rect.x, rect.y}, {rect.right(), rect.y}, left, right);
}

void CairoPainter::FillFrom(const Rect& rect, Point from, Point to, const Color& first,
                            const Color& last) {
  cairo_pattern_t* gradient = cairo_pattern_create_linear(from.x, from.y, to.x, to.y);
  cairo_pattern_add_color_stop_rgb(gradient, 0.0, first.red, first.green, first.blue);
  cairo_pattern_add_color_stop_rgb(gradient, 1.0, last.red, last.green, last.blue);
  cairo_set_source(cairo_, gradient);
  Trace(rect, 0.0);
  cairo_fill(cairo_);
  cairo_pattern_destroy(gradient);
}

void CairoPainter::Outline(const Rect& rect, const Color& color, double line_width, double radius) {
  const double half = line_width / 2.0;  // the line lies inside the rectangle
  Trace({rect.x + half, rect.y + half, rect.width - line_width, rect.height - line_width}, radius);
  SetColor(cairo_, color);
  cairo_set_line_width(cairo_, line_width);
  cairo_stroke(cairo_);
}

void CairoPainter::Polyline(std::span<const Point> points, const Color& color, double line_width) {
  bool pen_down = false;
  for (const Point& point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      pen_down = false;
    } else if (pen_down) {
      cairo_line_to(cairo_, point.x, point.y);
    } else {
      cairo_move_to(cairo_, point.x, point.y);
      pen_down = true;
    }
  }
  SetColor(cairo_, color);
  cairo_set_line_width(cairo_, line_width);
  cairo_stroke(cairo_);
}

void CairoPainter::FillBetween(std::span<const Point> points, double y, const Color& color) {
  const auto finite = [](const Point& point) {
    return std::isfinite(point.x) && std::isfinite(point.y);
  };
  for (auto begin = points.begin(); begin != points.end();) {
    const auto first = std::find_if(begin, points.end(), finite);
    const auto end = std::find_if_not(first, points.end(), finite);
    if (first != end) {
      cairo_move_to(cairo_, first->x, y);
      for (const Point& point : std::span(first, end)) cairo_line_to(cairo_, point.x, point.y);
      cairo_line_to(cairo_, std::prev(end)->x, y);
      cairo_close_path(cairo_);
    }
    begin = end;
  }
  SetColor(cairo_, color);
  cairo_fill(cairo_);
}

void CairoPainter::Dot(Point center, double radius, const Color& color) {
  if (!std::isfinite(center.x) || !std::isfinite(center.y)) return;
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, center.x, center.y, radius, 0.0, 2.0 * std::numbers::pi);
  SetColor(cairo_, color);
  cairo_fill(cairo_);
}

void CairoPainter::Picture(const Image& picture, int x, int y, double opacity) {
  // Cairo only reads it.
  auto* pixels =
      reinterpret_cast<unsigned char*>(const_cast<std::uint32_t*>(picture.pixels.data()));
  cairo_surface_t* source = cairo_image_surface_create_for_data(
      pixels, CAIRO_FORMAT_ARGB32, picture.width_px, picture.height_px, 4 * picture.width_px);
  cairo_set_source_surface(cairo_, source, x, y);
  cairo_pattern_set_filter(cairo_get_source(cairo_), CAIRO_FILTER_NEAREST);
  if (opacity < 1.0) {
    cairo_paint_with_alpha(cairo_, opacity);
  } else {
    cairo_paint(cairo_);
  }
  cairo_surface_destroy(source);
}

void CairoPainter::UseFont(const TextStyle& style) {
  cairo_select_font_face(cairo_, kFontFamily, CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo_, style.size_px);
}

double CairoPainter::TextWidth(std::string_view text, const TextStyle& style) {
  UseFont(style);
  if (!style.tabular) return Advance(cairo_, text);
  const double digit_width = Advance(cairo_, "0");
  double width = 0.0;
  while (!text.empty()) {
    const std::string_view letter = RemoveLetter(text);
    width += IsDigit(letter) ? digit_width : Advance(cairo_, letter);
  }
  return width;
}

void CairoPainter::Text(std::string_view text, Point at, const TextStyle& style) {
  UseFont(style);
  SetColor(cairo_, style.color);
  if (style.align != Align::kLeft) {
    at.x -= TextWidth(text, style) * (style.align == Align::kCenter ? 0.5 : 1.0);
  }
  if (!style.tabular) {
    cairo_move_to(cairo_, at.x, at.y);
    cairo_show_text(cairo_, std::string(text).c_str());
    cairo_new_path(cairo_);
    return;
  }
  const double digit_width = Advance(cairo_, "0");
  while (!text.empty()) {
    const std::string_view letter = RemoveLetter(text);
    const double advance = Advance(cairo_, letter);
    const double width = IsDigit(letter) ? digit_width : advance;
    cairo_move_to(cairo_, at.x + (width - advance) / 2.0, at.y);
    cairo_show_text(cairo_, std::string(letter).c_str());
    at.x += width;
  }
  cairo_new_path(cairo_);
}

std::string CairoPainter::Elide(std::string_view text, double width, const TextStyle& style) {
  if (TextWidth(text, style) <= width) return std::string(text);
  std::string shown;
  while (!text.empty()) {
    const std::string longer = shown + std::string(RemoveLetter(text));
    if (TextWidth(longer + "…", style) > width) break;
    shown = longer;
  }
  return shown + "…";
}

void CairoPainter::Clip(const Rect& rect, double radius) {
  cairo_save(cairo_);
  Trace(rect, radius);
  cairo_clip(cairo_);
}

void CairoPainter::Unclip() { cairo_restore(cairo_); }

cairo_status_t Append(void* closure, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::unique_ptr<Painter> OpenCairoPainter(ImageView image) {
  return std::make_unique<CairoPainter>(image);
}

std::string EncodeCairoPng(const Image& image) {
  // Cairo only reads it.
  auto* pixels = reinterpret_cast<unsigned char*>(const_cast<std::uint32_t*>(image.pixels.data()));
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create_for_data(pixels, CAIRO_FORMAT_ARGB32, image.width_px,
                                          image.height_px, 4 * image.width_px),
      &cairo_surface_destroy);
  std::string content;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), Append, &content);
  if (status != CAIRO_STATUS_SUCCESS) {
    throw RunError(std::string("picture: cannot encode: ") + cairo_status_to_string(status));
  }
  return content;
}

}  // namespace gauntlet::sim
