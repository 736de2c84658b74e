#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

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

  /// Place of a value from 0 to 1; NaN for one that is not there.
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

  const char* css() const { return faint ? "faint" : good ? "good" : ""; }
};

/// A scale of colours with a limit in its middle.
struct LimitScale {
  std::vector<double> times_limit;       // y by x, as HeatMap::best
  std::string at_zero, at_limit, above;  // labels
};

/// The best of a score over a grid of two settings.
struct HeatMap {
  std::size_t x = 0, y = 0;  // the settings, among the axes
  std::string x_name, y_name, score;
  std::vector<std::string> x_labels, y_labels;
  std::vector<double> best;         // y by x; NaN: nothing there
  std::vector<std::size_t> points;  // whose; kNoPoint where it is not among the page's
  bool lower_is_better = true;
  std::optional<LimitScale> scale = {};  // none: from the lowest value to the highest

  double FilledShare() const;
};
inline constexpr std::size_t kNoPoint = static_cast<std::size_t>(-1);

std::string HeatMapSvg(const HeatMap& map);
/// The points over two of their axes, coloured by `shares`: 0 best, 1 worst, NaN none.
std::string ScatterSvg(const std::vector<ChartAxis>& axes, std::size_t x, std::size_t y,
                       const std::vector<ChartPoint>& points, const std::vector<double>& shares);
std::string ParallelSvg(const std::vector<ChartAxis>& axes, const std::vector<ChartPoint>& points);

}  // namespace gauntlet::sim
