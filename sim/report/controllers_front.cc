#include "sim/report/controllers_front.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/figure/panel.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {
namespace {

constexpr double kFrontHeight = 380.0;
constexpr double kPointRadius = 6.0;   // radius
constexpr double kNameLetters = 13.0;  // of the names
constexpr double kWordWidth = 560.0;   // least width of a figure that says who is dominated
/// Best delay of the controller of a prosthesis. Source: Farrell and Weir 2007.
constexpr Extent kBestDelay_ms = {100.0, 125.0};

struct FrontPoint {
  std::size_t controller;
  std::string name;
  double delay_ms;
  double jitter_deg;
  bool dominated;
};

std::vector<FrontPoint> PointsOf(const Summary& summary) {
  const std::size_t delay = MetricIndex("delay_ms"), jitter = MetricIndex("jitter_rms_deg");
  std::vector<FrontPoint> points;
  for (std::size_t c = 0; c < summary.controllers.size(); ++c) {
    const auto& [name, scores] =
        std::tie(summary.controllers[c].name, summary.controllers[c].summary);
    if (!std::isfinite(scores[delay].mean) || !std::isfinite(scores[jitter].mean)) continue;
    points.push_back({c, name, scores[delay].mean, scores[jitter].mean, summary.dominated[c] != 0});
  }
  return points;
}

bool Meet(const FigureBox& a, const FigureBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

/// Places names where they cover no other name and no point: the first free of eight places.
class NamePlaces {
 public:
  NamePlaces(const FigureBox& area, const std::vector<FigurePoint>& points) : area_(area) {
    constexpr double kReach = kPointRadius + 1.0;
    for (const auto& [x, y] : points) {
      taken_.push_back({x - kReach, y - kReach, x + kReach, y + kReach});
    }
  }

  void Add(Figure& figure, FigurePoint point, const std::string& name, const char* css) {
    constexpr struct {
      double x, y;
      Anchor anchor;
    } kPlaces[] = {{12, 4, Anchor::kStart},   {-12, 4, Anchor::kEnd},   {12, -12, Anchor::kStart},
                   {-12, -12, Anchor::kEnd},  {12, 20, Anchor::kStart}, {-12, 20, Anchor::kEnd},
                   {0, -16, Anchor::kMiddle}, {0, 26, Anchor::kMiddle}};
    const double width = TextWidth(name, kNameLetters);
    double least = std::numeric_limits<double>::infinity();
    FigureBox best;
    std::size_t chosen = 0;
    for (std::size_t i = 0; i < std::size(kPlaces) && least > 0.0; ++i) {
      const double left =
          point.x + kPlaces[i].x - 0.5 * width * static_cast<int>(kPlaces[i].anchor);
      const double baseline = point.y + kPlaces[i].y;
      const FigureBox box = {left, baseline - 12.0, left + width, baseline + 4.0};
      const double outside = box.left < area_.left || box.right > area_.right + kPointRadius ||
                             box.top < 0.0 || box.bottom > area_.bottom;
      const double covered =
          std::ranges::any_of(taken_, [&](const FigureBox& other) { return Meet(box, other); });
      if (2.0 * outside + covered >= least) continue;
      least = 2.0 * outside + covered;
      best = box;
      chosen = i;
    }
    taken_.push_back(best);
    figure.Text({point.x + kPlaces[chosen].x, point.y + kPlaces[chosen].y}, kPlaces[chosen].anchor,
                name, {css});
  }

 private:
  FigureBox area_;
  std::vector<FigureBox> taken_;
};

std::string SaidOf(const std::vector<FrontPoint>& points) {
  std::string said = "Jitter against delay.";
  for (const FrontPoint& point : points) {
    said += fmt::format(" {}: {} ms, {} deg{};", point.name, Short(point.delay_ms),
                        Short(point.jitter_deg), point.dominated ? ", dominated" : "");
  }
  return said;
}

Panel PanelOf(const Figure& figure, const std::vector<FrontPoint>& points) {
  Extent delay = {0.0, 145.0}, jitter = {0.0, 1e-3};  // at least
  for (const FrontPoint& point : points) {
    delay.Take(1.1 * point.delay_ms);
    jitter.Take(1.15 * point.jitter_deg);
  }
  return {figure.Inside(),
          {delay, "delay, ms", figure.width_px < 500.0 ? 5 : 9},
          {jitter, "jitter, deg RMS", 5, true}};
}

std::string FrontOf(const std::vector<FrontPoint>& points, const char* kind, double width_px) {
  Figure figure{width_px, kFrontHeight, kind, SaidOf(points)};
  const Panel panel = PanelOf(figure, points);
  const auto [left, top, right, bottom] = panel.area();
  const double band = panel.X(kBestDelay_ms.low);
  figure.Box({band, top}, {panel.X(kBestDelay_ms.high), bottom}, {"band"});
  figure.Text({band + 7.0, top + 17.0}, Anchor::kStart, "100 to", {"band-name"});
  figure.Text({band + 7.0, top + 33.0}, Anchor::kStart, "125 ms", {"band-name"});
  panel.AddAxes(figure);
  std::vector<FigurePoint> places, front;
  for (const FrontPoint& point : points) {
    places.push_back(panel.At(point.delay_ms, point.jitter_deg));
    if (!point.dominated) front.push_back(places.back());
  }
  std::ranges::sort(front, {}, &FigurePoint::x);
  figure.Path(front, {"front-line"});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const char* css = points[i].dominated ? "point dominated" : "point";
    figure.Dot(places[i], kPointRadius, InkOfSeries(points[i].controller, css));
  }
  NamePlaces names({left, top, right, bottom}, places);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool says = points[i].dominated && width_px >= kWordWidth;
    names.Add(figure, places[i], points[i].name + (says ? " (dominated)" : ""),
              points[i].dominated ? "label faint" : "label");
  }
  return SvgOf(figure);
}

}  // namespace

std::string ControllersFront(const Summary& summary) {
  const std::vector<FrontPoint> points = PointsOf(summary);
  if (points.empty()) {
    return "<p class=\"note\">The wearer did not move, so there is no delay to draw.</p>\n";
  }
  return FrontOf(points, "wide", 1040.0) + FrontOf(points, "middle", 640.0) +
         FrontOf(points, "narrow", 360.0);
}

}  // namespace gauntlet::sim
