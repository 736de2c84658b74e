#pragma once

#include <span>
#include <vector>

#include "sim/show/video/frame_clock.h"
#include "sim/show/video/painter.h"

namespace gauntlet::sim {

/// The range of angles that all panes share, and where its lines are.
struct AngleScale {
  double low_deg = 0.0;
  double high_deg = 90.0;
  double tick_deg = 30.0;
};

/// One angle over time; a value that is not finite interrupts it. View: the owner outlives it.
struct Curve {
  std::span<const double> angle_rad;
  Color color;
  double line_width = 1.5;  // at 1280 x 720
  bool head = false;        // a dot at the newest value
  bool filled = false;      // down or up to zero
};

/// A range that shows all of `whole` and, of the noisy curves, all but the rarest peaks; not less
/// than `smallest_range_deg`.
AngleScale ChooseAngleScale(std::span<const std::span<const double>> whole,
                            std::span<const std::span<const double>> noisy,
                            double smallest_range_deg = 2.0);

/// Curves over a window of about four seconds of the video, which first fills and then scrolls.
///
/// It scrolls by a whole number of pixels per frame, and each pixel column always shows the same
/// samples by their lowest and highest value: nothing flickers while it moves.
class CurvePlot {
 public:
  /// `times`: with labels below it.
  CurvePlot(const Rect& area, double unit, const AngleScale& scale, const FrameClock& clock,
            bool times = true);

  /// Fixed parts: lines and labels of angles.
  void DrawScale(Painter& painter) const;
  /// Curves up to `frame`, in the order given, and lines of time.
  void Draw(Painter& painter, int frame, std::span<const Curve> curves) const;

 private:
  double HeightOf(double angle_deg) const;
  void DrawTimes(Painter& painter, double scrolled_px) const;
  void AddPoints(const Curve& curve, double scrolled_px, int end, std::vector<Point>& points) const;

  Rect area_;
  double unit_;
  AngleScale scale_;
  FrameClock clock_;
  bool times_;
  double px_per_frame_;
  double px_per_sample_;
};

}  // namespace gauntlet::sim
