#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/show/pages/cells_chart.h"

namespace gauntlet::sim {

/// Jitter against delay; the line joins what nothing is better than in both.
std::string FrontSvg(const std::vector<ChartPoint>& points);

/// Front of one kind of filter: its settings with nothing of the same kind better in both.
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

/// Jitter against delay of the controllers as HTML: a figure for each of three widths of the page,
/// of which style sheets show one, or a sentence if no controller has both scores.
std::string ControllersFront(const Summary& summary);
/// ControllersFront() as an SVG that is complete as a file; empty if no controller has both scores.
std::string ControllersFrontFile(const Summary& summary);

}  // namespace gauntlet::sim
