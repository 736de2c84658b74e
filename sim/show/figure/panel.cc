#include "sim/show/figure/panel.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace gauntlet::sim {
namespace {

/// Calls `add(value, text, ink of the line)` for each tick.
template <class Add>
void ForEachTick(const FigureAxis& axis, const Add& add) {
  if (axis.ticks == 0) return;
  const double step = TickStep(axis.range, axis.ticks);
  for (const double tick : Ticks(axis.range, step)) {
    const double value = std::round(tick / step) * step;
    const std::string text = fmt::format("{}{:g}", value < 0.0 ? "−" : "", std::abs(value));
    add(value, text, Ink{.css = value == 0.0 ? "axis" : "grid"});
  }
}

}  // namespace

Panel::Panel(const FigureBox& area, FigureAxis x, FigureAxis y)
    : area_(area), x_(std::move(x)), y_(std::move(y)) {}

double Panel::X(double value) const {
  return area_.left + x_.range.Share(value) * (area_.right - area_.left);
}

double Panel::Y(double value) const {
  return area_.bottom - y_.range.Share(value) * (area_.bottom - area_.top);
}

void Panel::AddAxes(Figure& figure, const FigureLayout& layout) const {
  ForEachTick(y_, [&](double value, const std::string& text, const Ink& line) {
    const double y = Y(value);
    if (y_.lines) figure.Line({area_.left, y}, {area_.right, y}, line);
    figure.Text({area_.left - layout.tick_gap, y + layout.baseline}, Anchor::kEnd, text);
  });
  ForEachTick(x_, [&](double value, const std::string& text, const Ink& line) {
    const double x = X(value);
    if (x_.lines) figure.Line({x, area_.top}, {x, area_.bottom}, line);
    figure.Text({x, area_.bottom + layout.tick_drop}, Anchor::kMiddle, text);
  });
  const auto [middle_x, middle_y] = area_.centre();
  if (!x_.name.empty()) {
    figure.Text({middle_x, area_.bottom + layout.name_drop}, Anchor::kMiddle, x_.name, {"name"});
  }
  if (!y_.name.empty()) figure.UpwardText({layout.name_left, middle_y}, y_.name, {"name"});
}

}  // namespace gauntlet::sim
