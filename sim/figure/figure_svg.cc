#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sim/figure/figure.h"
#include "sim/results/html_text.h"

namespace gauntlet::sim {
namespace {

/// To 0.1 px, without zeros behind the point.
std::string Number(double px) { return fmt::format("{:g}", std::round(10.0 * px) / 10.0 + 0.0); }

std::string WayOf(const FigureShape& shape) {
  std::string way;
  bool pen_down = false;
  for (const auto& [x, y] : shape.points) {
    const bool finite = std::isfinite(x) && std::isfinite(y);
    if (finite) {
      way += fmt::format("{}{} {}", pen_down ? way.back() == 'Z' ? "" : " " : "M", Number(x),
                         Number(y));
    }
    pen_down = finite;
  }
  return shape.kind == FigureShape::Kind::kArea ? way + "Z" : way;
}

/// The element's name, geometry and text.
struct Element {
  std::string name;
  std::string geometry;
  std::string text = {};
};

Element TextElement(const FigureShape& shape) {
  constexpr const char* kAnchors[] = {"start", "middle", "end"};
  const auto& [x, y] = shape.points.front();
  const std::string place =
      shape.kind == FigureShape::Kind::kUpwardText
          ? fmt::format(" transform=\"translate({} {}) rotate(-90)\"", Number(x), Number(y))
          : fmt::format(" x=\"{}\" y=\"{}\"", Number(x), Number(y));
  return {"text",
          fmt::format("{} text-anchor=\"{}\"", place, kAnchors[static_cast<int>(shape.anchor)]),
          EscapeHtml(shape.text)};
}

Element ElementOf(const FigureShape& shape) {
  switch (shape.kind) {
    case FigureShape::Kind::kLine:
      return {"line", fmt::format(" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"",
                                  Number(shape.points[0].x), Number(shape.points[0].y),
                                  Number(shape.points[1].x), Number(shape.points[1].y))};
    case FigureShape::Kind::kPath:
    case FigureShape::Kind::kArea:
      return {"path", fmt::format(" d=\"{}\"", WayOf(shape))};
    case FigureShape::Kind::kDot:
      return {"circle", fmt::format(" cx=\"{}\" cy=\"{}\" r=\"{}\"", Number(shape.points[0].x),
                                    Number(shape.points[0].y), Number(shape.radius))};
    case FigureShape::Kind::kBox: {
      const auto& [a, b] = std::pair(shape.points[0], shape.points[1]);
      return {
          "rect",
          fmt::format(" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}", Number(std::min(a.x, b.x)),
                      Number(std::min(a.y, b.y)), Number(std::abs(b.x - a.x)),
                      Number(std::abs(b.y - a.y)),
                      shape.radius > 0.0 ? fmt::format(" rx=\"{}\"", Number(shape.radius)) : "")};
    }
    case FigureShape::Kind::kText:
    case FigureShape::Kind::kUpwardText:
      break;
  }
  return TextElement(shape);
}

std::string SvgOf(const FigureShape& shape) {
  const auto [name, geometry, text] = ElementOf(shape);
  const auto& [css, said, attributes] = shape.ink;
  const std::string style = css.empty() ? "" : fmt::format(" class=\"{}\"", css);
  const std::string title = said.empty() ? "" : fmt::format("<title>{}</title>", EscapeHtml(said));
  const std::string inside = title + text;
  const std::string start = fmt::format("<{}{}{}{}", name, attributes, style, geometry);
  return inside.empty() ? start + "/>" : fmt::format("{}>{}</{}>", start, inside, name);
}

}  // namespace

std::string SvgOf(const Figure& figure, std::string_view style_sheet) {
  const std::string width = Number(figure.width_px), height = Number(figure.height_px);
  const std::string look =
      style_sheet.empty()
          ? fmt::format("class=\"{}\" style=\"--natural: {}px\"", figure.kind, width)
          : fmt::format("xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\"", width,
                        height);
  std::string svg = fmt::format("<svg {} viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}",
                                look, width, height, EscapeHtml(figure.said), style_sheet);
  for (const FigureShape& shape : figure.shapes) svg += SvgOf(shape);
  return svg + "</svg>\n";
}

}  // namespace gauntlet::sim
