#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/study/response.h"
#include "sim/study/robust.h"

namespace gauntlet::sim {

// Drawings of a page of cells, as SVG. What stands for a point carries its place in the page's list
// as `data-point`, so that scripts find it. Colours are those of page.css.

/// A setting or a score of many points.
struct ChartAxis {
  std::string name;
  std::vector<std::string> labels = {};  // of a list of values; empty: numbers from low to high
  double low = 0.0;
  double high = 1.0;
  bool log = false;

  /// Where a value stands from 0 to 1; NaN for one that is not there.
  double PlaceOf(double value) const;
  double PlaceOf(const std::string& value) const;
};

/// One line of parallel coordinates, one point of the front.
struct ChartPoint {
  std::vector<double> places;  // on the axes, 0 to 1; NaN: none
  double delay_ms = 0.0;
  double jitter_deg = 0.0;
  bool good = false;   // among the best
  bool faint = false;  // breaks a bound
};

/// The best of a score over a grid of two settings.
struct HeatMap {
  std::string x_name, y_name, score;
  std::vector<std::string> x_labels, y_labels;
  std::vector<double> best;         // y by x; NaN: nothing there
  std::vector<std::size_t> points;  // whose; kNoPoint where it is not among the page's
  bool lower_is_better = true;
};
inline constexpr std::size_t kNoPoint = static_cast<std::size_t>(-1);

std::string HeatMapSvg(const HeatMap& map);
std::string ParallelSvg(const std::vector<ChartAxis>& axes, const std::vector<ChartPoint>& points);
/// What one kind of filter can do: its settings with nothing of the same kind better in both.
struct FrontSeries {
  struct Place {
    double delay_ms = 0.0;
    double jitter_deg = 0.0;
    std::size_t point = kNoPoint;
  };
  std::string name;
  std::vector<Place> front;     // by delay
  std::optional<Place> answer;  // within the bounds
};

/// The fronts of many kinds in one drawing, in the order of its legend, each answer as a ring. The
/// bounds are drawn as lines where they are numbers.
std::string FrontsSvg(const std::vector<FrontSeries>& series, double most_delay_ms,
                      double most_jitter_deg);
/// Jitter against delay; the line joins what nothing is better than in both.
std::string FrontSvg(const std::vector<ChartPoint>& points);
/// A score, by its place in the response's metrics, over the one setting: a curve and the band of
/// its intervals for each controller.
std::string ResponseSvg(const Response& response, std::size_t metric, const std::string& setting);
std::string TornadoSvg(const RobustPlan& plan, const RobustScore& score, double nominal);

}  // namespace gauntlet::sim
