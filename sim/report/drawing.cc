#include "sim/report/drawing.h"

#include "sim/results/html_text.h"

namespace gauntlet::sim {

Drawing::Drawing(double width, double height, std::string_view kind, const std::string& said) {
  Add("<svg class=\"{0}\" style=\"--natural: {1:g}px\" viewBox=\"0 0 {1:g} {2:g}\" role=\"img\" "
      "aria-label=\"{3}\">",
      kind, width, height, EscapeHtml(said));
}

void Drawing::Text(double x, double y, std::string_view anchor, const std::string& text,
                   std::string_view style) {
  Add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" class=\"{}\">{}</text>", x, y, anchor,
      style, EscapeHtml(text));
}

void Drawing::Line(double x1, double y1, double x2, double y2, std::string_view style) {
  Add("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>", x1, y1, x2,
      y2, style);
}

std::string Shortened(const std::string& text, std::size_t most) {
  return text.size() <= most ? text : text.substr(0, most - 1) + "…";
}

}  // namespace gauntlet::sim
