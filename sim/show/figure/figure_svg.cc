#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "sim/results/html_text.h"
#include "sim/show/figure/figure.h"

namespace gauntlet::sim {
namespace {

/// To 0.1 px, without zeros behind the point.
std::string Number(double px) { return fmt::format("{:g}", std::round(10.0 * px) / 10.0 + 0.0); }

std::string Attributes(std::initializer_list<std::pair<const char*, double>> values) {
  std::string out;
  for (const auto& [name, px] : values) out += fmt::format(" {}=\"{}\"", name, Number(px));
  return out;
}

std::string WayOf(const std::vector<FigurePoint>& points) {
  std::string way;
  bool pen_down = false;
  for (const auto& [x, y] : points) {
    const bool finite = std::isfinite(x) && std::isfinite(y);
    if (finite) way += fmt::format("{}{} {}", pen_down ? " " : "M", Number(x), Number(y));
    pen_down = finite;
  }
  return way;
}

/// Name and geometry of the element of a shape.
std::pair<const char*, std::string> ElementOf(const FigureShape& shape) {
  using enum FigureShape::Kind;
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  if (shape.kind == kPath || shape.kind == kArea) {
    const char* end = shape.kind == kArea ? "Z" : "";
    return {"path", fmt::format(" d=\"{}{}\"", WayOf(shape.points), end)};
  }
  const FigurePoint a = shape.points.front(), b = shape.points.back();
  if (shape.kind == kLine)
    return {"line", Attributes({{"x1", a.x}, {"y1", a.y}, {"x2", b.x}, {"y2", b.y}})};
  if (shape.kind == kDot)
    return {"circle", Attributes({{"cx", a.x}, {"cy", a.y}, {"r", shape.radius}})};
  if (shape.kind == kBox) {
    const std::string corners = shape.radius > 0.0 ? Attributes({{"rx", shape.radius}}) : "";
    return {"rect", Attributes({{"x", std::min(a.x, b.x)},
                                {"y", std::min(a.y, b.y)},
                                {"width", std::abs(b.x - a.x)},
                                {"height", std::abs(b.y - a.y)}}) +
                        corners};
  }
  const std::string place =
      shape.kind == kText
          ? Attributes({{"x", a.x}, {"y", a.y}})
          : fmt::format(" transform=\"translate({} {}) rotate(-90)\"", Number(a.x), Number(a.y));
  return {"text",
          fmt::format("{} text-anchor=\"{}\"", place, kAnchors[static_cast<int>(shape.anchor)])};
}

std::string SvgOf(const FigureShape& shape) {
  const auto [name, geometry] = ElementOf(shape);
  const auto& [css, said, attributes] = shape.ink;
  const std::string style = css.empty() ? "" : fmt::format(" class=\"{}\"", css);
  const std::string title = said.empty() ? "" : fmt::format("<title>{}</title>", EscapeHtml(said));
  const std::string inside = title + EscapeHtml(shape.text);
  const std::string start = fmt::format("<{}{}{}{}", name, attributes, style, geometry);
  return inside.empty() ? start + "/>" : fmt::format("{}>{}</{}>", start, inside, name);
}

}  // namespace

std::string SvgOf(const Figure& figure, std::string_view style_sheet) {
  const std::string size = Attributes({{"width", figure.width_px}, {"height", figure.height_px}});
  const std::string look =
      style_sheet.empty()
          ? fmt::format("class=\"{}\" style=\"--natural: {:g}px\"", figure.kind, figure.width_px)
          : "xmlns=\"http://www.w3.org/2000/svg\"" + size;
  std::string svg =
      fmt::format("<svg {} viewBox=\"0 0 {:g} {:g}\" role=\"img\" aria-label=\"{}\">{}", look,
                  figure.width_px, figure.height_px, EscapeHtml(figure.said), style_sheet);
  for (const FigureShape& shape : figure.shapes) svg += SvgOf(shape);
  return svg + "</svg>\n";
}

}  // namespace gauntlet::sim
