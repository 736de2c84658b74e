#pragma once

#include <vector>

#include "sim/show/video/painter.h"

namespace gauntlet::sim {

inline constexpr int kMaxPanes = 8;

/// Errors: UserError for a number of controllers that a video cannot show side by side.
void CheckPaneCount(int pane_count);

/// Places of the parts of one pane. All edges are whole pixels.
struct PaneLayout {
  Rect card{};
  Rect title{};
  Rect view{};      // the hand
  Rect tracking{};  // the running numbers
  Rect jitter{};
  // The plots' areas, without their labels.
  Rect error{};         // no height where no curve has room
  Rect jitter_curve{};  // no height where only the error has room
};

struct VideoLayout {
  double unit = 1.0;       // pixels of one pixel in the design of 1280 x 720
  double card_unit = 1.0;  // the same of title and end card, which are full of text
  Rect header;
  Rect progress;
  std::vector<PaneLayout> panes;
};

/// Panes in one row, the hand above each number with its curve; from five on in two rows, the hand
/// beside them, because curves would become too low. All panes have the same size. Errors:
/// UserError for a size or a number of panes that cannot be laid out.
/// One or two panes of a small frame have no curves and letters of twice the size.
VideoLayout LayOutVideo(int width_px, int height_px, int pane_count);

/// For two hands in one picture: one pane, these beside their numbers and curves. Errors: as
/// above.
VideoLayout LayOutOverlay(int width_px, int height_px);

}  // namespace gauntlet::sim
