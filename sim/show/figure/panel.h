#pragma once

#include <string>

#include "sim/show/figure/figure.h"

namespace gauntlet::sim {

/// One axis of a panel.
struct FigureAxis {
  Extent range;
  std::string name = {};
  int ticks = 0;       // about; 0: no labels
  bool lines = false;  // across the panel at each tick
};

/// Part of a figure with an x axis to the right and a y axis upwards.
class Panel {
 public:
  Panel(const FigureBox& area, FigureAxis x, FigureAxis y);

  double X(double value) const;
  double Y(double value) const;
  FigurePoint At(double x, double y) const { return {X(x), Y(y)}; }
  const FigureBox& area() const { return area_; }

  /// Lines, labels and names of both axes. The line at 0 has the class `axis`, others `grid`.
  void AddAxes(Figure& figure, const FigureLayout& layout = kFigureLayout) const;

 private:
  FigureBox area_;
  FigureAxis x_, y_;
};

}  // namespace gauntlet::sim
