#include "sim/show/video/curve_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/base/signal.h"

namespace gauntlet::sim {
namespace {

constexpr double kWindow_s = 4.0;      // about: then jitter of 10 Hz is 7 px wide in a 300 px plot
constexpr double kHeadRoom = 5.0;      // pixels right of the newest value
constexpr double kNoisyShare = 0.005;  // of the noisiest values that may lie outside, each side
constexpr double kRangeMargin = 0.06;  // of the range, free above and below
constexpr double kFillOpacity = 0.3;
constexpr double kTargetTicks = 3.5;
constexpr double kMinAngleTick_px = 15.0;
constexpr double kMinTimeTick_px = 70.0;
constexpr int kMaxTimeTicks = 8;
constexpr double kLabelSize = 14.0;

/// The smallest of the usual steps that is at least `step`.
double UsualStep(double step, std::span<const double> steps) {
  const auto found = std::lower_bound(steps.begin(), steps.end(), step);
  return found == steps.end() ? steps.back() : *found;
}

void Include(double value, AngleScale& scale) {
  if (!std::isfinite(value)) return;
  scale.low_deg = std::min(scale.low_deg, value);
  scale.high_deg = std::max(scale.high_deg, value);
}

void IncludeMost(std::span<const double> angle_rad, AngleScale& scale) {
  std::vector<double> values;
  values.reserve(angle_rad.size());
  for (double value : angle_rad) {
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) return;
  const auto rare = static_cast<std::ptrdiff_t>(kNoisyShare * values.size());
  std::nth_element(values.begin(), values.begin() + rare, values.end());
  Include(kDegPerRad * values[rare], scale);
  std::nth_element(values.begin(), values.end() - 1 - rare, values.end());
  Include(kDegPerRad * *(values.end() - 1 - rare), scale);
}

}  // namespace

AngleScale ChooseAngleScale(std::span<const std::span<const double>> whole,
                            std::span<const std::span<const double>> noisy,
                            double smallest_range_deg) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  AngleScale scale{.low_deg = kInfinity, .high_deg = -kInfinity};
  for (const auto& curve : whole) {
    for (double value : curve) Include(kDegPerRad * value, scale);
  }
  for (const auto& curve : noisy) IncludeMost(curve, scale);
  if (scale.low_deg > scale.high_deg) scale.low_deg = scale.high_deg = 0.0;
  const double middle = 0.5 * (scale.low_deg + scale.high_deg);
  const double range = std::max(scale.high_deg - scale.low_deg, smallest_range_deg);
  scale.low_deg = middle - (0.5 + kRangeMargin) * range;
  scale.high_deg = middle + (0.5 + kRangeMargin) * range;
  constexpr double kSteps[] = {0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 20, 30, 45, 60, 90, 180};
  scale.tick_deg = UsualStep(range / kTargetTicks, kSteps);
  return scale;
}

CurvePlot::CurvePlot(const Rect& area, double unit, const AngleScale& scale,
                     const FrameClock& clock, bool times)
    : area_(area), unit_(unit), scale_(scale), clock_(clock), times_(times) {
  const double frames_per_s = clock.frames_per_s;
  px_per_frame_ = std::max(1.0, std::round(area.width / (kWindow_s * frames_per_s)));
  px_per_sample_ = px_per_frame_ * frames_per_s / (clock.rate_hz() * clock.speed());
}

double CurvePlot::HeightOf(double angle_deg) const {
  const double share = (angle_deg - scale_.low_deg) / (scale_.high_deg - scale_.low_deg);
  return area_.bottom() - share * area_.height;
}

void CurvePlot::DrawScale(Painter& painter) const {
  const TextStyle label = {.size_px = kLabelSize * unit_,
                           .color = palette::kMutedOnLight,
                           .align = Align::kRight,
                           .tabular = true};
  const double tick_px = area_.height * scale_.tick_deg / (scale_.high_deg - scale_.low_deg);
  const double step_deg =
      scale_.tick_deg * std::max(1.0, std::ceil(kMinAngleTick_px * unit_ / tick_px));
  const auto first = static_cast<int>(std::ceil(scale_.low_deg / step_deg));
  const auto last = static_cast<int>(std::floor(scale_.high_deg / step_deg));
  for (int tick = first; tick <= last; ++tick) {
    const double angle_deg = tick * step_deg;
    const double y = std::floor(HeightOf(angle_deg)) + 0.5;
    painter.Line({area_.x, y}, {area_.right(), y}, palette::kGrid, 1.0);
    const std::string sign = angle_deg < 0.0 ? "−" : "";
    painter.Text(fmt::format("{}{:g}°", sign, std::abs(angle_deg)),
                 {area_.x - 6.0 * unit_, y + 0.36 * label.size_px}, label);
  }
}

void CurvePlot::DrawTimes(Painter& painter, double scrolled_px) const {
  const double px_per_s = px_per_sample_ * clock_.rate_hz();
  const double before_px = clock_.first_s() * px_per_s + scrolled_px;  // left of the plot
  constexpr double kSteps[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60};
  const double step_s =
      UsualStep(std::max(kMinTimeTick_px * unit_, area_.width / kMaxTimeTicks) / px_per_s, kSteps);
  const TextStyle label = {.size_px = kLabelSize * unit_,
                           .color = palette::kMutedOnLight,
                           .align = Align::kCenter,
                           .tabular = true};
  for (int tick = static_cast<int>(std::ceil(before_px / (px_per_s * step_s)));; ++tick) {
    const double x = area_.x + std::floor(tick * step_s * px_per_s - before_px) + 0.5;
    if (x > area_.right()) return;
    painter.Line({x, area_.y}, {x, area_.bottom()}, palette::kGrid, 1.0);
    if (!times_) continue;
    const std::string text = fmt::format("{:g} s", tick * step_s);
    if (x + 0.5 * painter.TextWidth(text, label) > area_.right() + 8.0 * unit_) continue;
    painter.Text(text, {x, area_.bottom() + 17.0 * unit_}, label);
  }
}

void CurvePlot::AddPoints(const Curve& curve, double scrolled_px, int end,
                          std::vector<Point>& points) const {
  const auto add = [&](int sample) {
    const double x = area_.x + (sample - clock_.first) * px_per_sample_ - scrolled_px;
    points.push_back({x, HeightOf(kDegPerRad * curve.angle_rad[sample])});
  };
  const auto first_sample_of = [&](std::int64_t column) {
    return static_cast<int>(clock_.first + std::ceil(column / px_per_sample_));
  };
  // One column further left, so that the line comes in from outside.
  auto column = std::max<std::int64_t>(0, static_cast<std::int64_t>(scrolled_px) - 1);
  for (int sample = first_sample_of(column); sample < end; ++column) {
    const int next = std::min(end, std::max(sample, first_sample_of(column + 1)));
    int low = -1, high = -1;
    bool gap = false;
    for (; sample < next; ++sample) {
      const double value = curve.angle_rad[sample];
      if (!std::isfinite(value)) {
        gap = true;
        continue;
      }
      if (low < 0 || value < curve.angle_rad[low]) low = sample;
      if (high < 0 || value > curve.angle_rad[high]) high = sample;
    }
    if (low >= 0) {
      add(std::min(low, high));
      if (low != high) add(std::max(low, high));
    }
    if (gap) points.push_back({kNaN, kNaN});
  }
}

void CurvePlot::Draw(Painter& painter, int frame, std::span<const Curve> curves) const {
  const double newest_px = frame * px_per_frame_;
  const double scrolled_px =
      std::max(0.0, newest_px - (area_.width - std::ceil(kHeadRoom * unit_)));
  DrawTimes(painter, scrolled_px);

  painter.Clip({area_.x, area_.y - 2.0 * unit_, area_.width, area_.height + 4.0 * unit_});
  std::vector<Point> points;
  for (const Curve& curve : curves) {
    const int end = std::min(clock_.Sample(frame) + 1, static_cast<int>(curve.angle_rad.size()));
    points.clear();
    AddPoints(curve, scrolled_px, end, points);
    if (end > clock_.first) {
      const double x = area_.x + (end - 1 - clock_.first) * px_per_sample_ - scrolled_px;
      points.push_back({x, HeightOf(kDegPerRad * curve.angle_rad[end - 1])});
    }
    if (curve.filled) {
      Color fill = curve.color;
      fill.alpha = kFillOpacity;
      painter.FillBetween(points, HeightOf(0.0), fill);
    }
    painter.Polyline(points, curve.color, curve.line_width * unit_);
    if (curve.head && end > clock_.first) painter.Dot(points.back(), 3.2 * unit_, curve.color);
  }
  painter.Unclip();
}

}  // namespace gauntlet::sim
