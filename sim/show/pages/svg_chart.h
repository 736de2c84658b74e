#pragma once

#include <string>
#include <vector>

namespace gauntlet::sim {

/// A curve of equidistant values. Colours: the glove's first, then those of controllers. A curve
/// without values only uses up a colour.
struct ChartCurve {
  std::string name;
  double first_x = 0.0;
  double step_x = 1.0;
  std::vector<double> values;
  double width_px = 1.4;    // a wide one is still seen behind another that covers it
  bool is_command = false;  // has the colour of commands
};

/// Bars side by side: bar i is centred at first_x + i step_x.
struct ChartBars {
  std::string name;
  double first_x = 0.0;
  double step_x = 1.0;
  std::vector<double> heights;
};

struct Chart {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<ChartBars> bars;  // behind the curves
  std::vector<ChartCurve> curves;
  int width_px = 460;  // small, so that its texts can be read on a phone, too
  int height_px = 270;
};

/// A drawing that stands by itself as a file and inside a page, in light and dark. Curves with more
/// points than the picture has columns keep the peaks of every column.
std::string SvgChart(const Chart& chart);

}  // namespace gauntlet::sim
