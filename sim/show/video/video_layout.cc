#include "sim/show/video/video_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/study/scenario/scenario.h"

namespace gauntlet::sim {
namespace {

// The design, in pixels at 1280 x 720.
constexpr double kMargin = 20.0;
constexpr double kGap = 14.0;
constexpr double kHeaderHeight = 60.0;
constexpr double kProgressHeight = 4.0;
constexpr double kPadding = 14.0;
constexpr double kTitleHeight = 38.0;
constexpr double kScoreHeight = 34.0;
constexpr double kAngleLabelWidth = 40.0;
constexpr double kTimeLabelHeight = 20.0;
constexpr double kPlotShare = 0.29;  // of a card: numbers and curves below a hand
constexpr double kViewShare = 0.45;  // of a pane's width, where the hand stands beside
// Letters of smaller frames could not be read: curves make room for larger ones.
constexpr double kSmallUnit = 0.6;
constexpr double kSmallFactor = 2.0;

Rect Rounded(const Rect& rect) {
  const double x = std::round(rect.x), y = std::round(rect.y);
  return {x, y, std::round(rect.right()) - x, std::round(rect.bottom()) - y};
}

/// Each number above its curve, between two heights: labels on the left and below. Either both of
/// them, or only the error with both numbers above it.
void PlaceCurves(const Rect& area, bool all, double unit, PaneLayout& pane) {
  const double score = kScoreHeight * unit, x = area.x + kAngleLabelWidth * unit;
  const double plots = area.height - kTimeLabelHeight * unit - 2.0 * score;
  double y = area.y;
  const auto place = [&](double left, double height) {
    const Rect rect = Rounded({left, y, area.right() - left, height});
    y = rect.bottom();
    return rect;
  };
  pane.tracking = place(area.x, score);
  if (all) pane.error = place(x, 0.55 * plots);
  pane.jitter = place(area.x, score);
  if (all) {
    pane.jitter_curve = place(x, 0.45 * plots);
  } else {
    pane.error = place(x, plots);
  }
}

Rect TitleOf(const Rect& card, double unit) {
  const double padding = kPadding * unit;
  return Rounded({card.x + padding, card.y, card.width - 2.0 * padding, kTitleHeight * unit});
}

/// From the top: title, hand, the numbers.
PaneLayout LayOutSmallPane(const Rect& card, double unit) {
  const double padding = kPadding * unit, score = std::round(kScoreHeight * unit);
  PaneLayout pane = {.card = card, .title = TitleOf(card, unit)};
  const double x = pane.title.x, width = pane.title.width;
  pane.jitter = {x, card.bottom() - std::round(0.25 * padding) - score, width, score};
  pane.tracking = {x, pane.jitter.y - score, width, score};
  pane.view = {card.x, pane.title.bottom(), card.width, pane.tracking.y - pane.title.bottom()};
  return pane;
}

/// From the top: title, hand, error, jitter.
PaneLayout LayOutTallPane(const Rect& card, double unit) {
  const double padding = kPadding * unit;
  PaneLayout pane = {.card = card, .title = TitleOf(card, unit)};
  const double below = std::max(kPlotShare * card.height, 186.0 * unit);
  pane.view = Rounded(
      {card.x, pane.title.bottom(), card.width, card.bottom() - below - pane.title.bottom()});
  PlaceCurves({card.x + padding, pane.view.bottom(), card.width - 2.0 * padding,
               card.bottom() - pane.view.bottom() - 0.25 * padding},
              true, unit, pane);
  return pane;
}

/// Below the title the hand on the left; on the right numbers and curves.
PaneLayout LayOutBesideHand(const Rect& card, bool all_plots, double unit) {
  const double padding = kPadding * unit;
  PaneLayout pane = {.card = card, .title = TitleOf(card, unit)};
  pane.view = Rounded(
      {card.x, pane.title.bottom(), kViewShare * card.width, card.bottom() - pane.title.bottom()});
  const double left = pane.view.right() + padding;
  PlaceCurves({left, pane.title.bottom(), card.right() - padding - left,
               card.bottom() - pane.title.bottom() - 0.5 * padding},
              all_plots, unit, pane);
  return pane;
}

/// All but the panes.
VideoLayout LayOutFrame(int width_px, int height_px, bool is_small) {
  if (width_px < VideoConfig::kMinWidth_px || height_px < VideoConfig::kMinHeight_px) {
    throw UserError(fmt::format("video: {} x {} px is too small, at least {} x {} px are needed",
                                width_px, height_px, VideoConfig::kMinWidth_px,
                                VideoConfig::kMinHeight_px));
  }
  VideoLayout layout;
  layout.card_unit = std::min(width_px / 1280.0, height_px / 720.0);
  layout.unit = is_small ? kSmallFactor * layout.card_unit : layout.card_unit;
  const double unit = layout.unit, margin = kMargin * unit;
  layout.header = Rounded({margin, 0.0, width_px - 2.0 * margin, kHeaderHeight * unit});
  layout.progress = Rounded({0.0, height_px - kProgressHeight * unit, static_cast<double>(width_px),
                             kProgressHeight * unit});
  return layout;
}

}  // namespace

void CheckPaneCount(int pane_count) {
  if (pane_count >= 1 && pane_count <= kMaxPanes) return;
  throw UserError({.place = "video",
                   .problem = fmt::format("{} controllers, must be from 1 to {}: choose some with "
                                          "--controllers, here or later in gauntlet render",
                                          pane_count, kMaxPanes)});
}

VideoLayout LayOutVideo(int width_px, int height_px, int pane_count) {
  CheckPaneCount(pane_count);
  const bool is_small =
      pane_count <= 2 && std::min(width_px / 1280.0, height_px / 720.0) < kSmallUnit;
  VideoLayout layout = LayOutFrame(width_px, height_px, is_small);
  const double unit = layout.unit;
  const double margin = kMargin * unit, gap = kGap * unit;
  const int rows = pane_count <= 4 ? 1 : 2;
  const int columns = (pane_count + rows - 1) / rows;
  const double width = (width_px - 2.0 * margin - (columns - 1) * gap) / columns;
  const double height = (height_px - layout.header.height - margin - (rows - 1) * gap) / rows;
  for (int i = 0; i < pane_count; ++i) {
    const int row = i / columns, column = i % columns;
    const double x = margin + column * (width + gap);
    const double y = layout.header.height + row * (height + gap);
    const Rect card = {std::round(x), std::round(y), std::floor(width), std::floor(height)};
    layout.panes.push_back(is_small    ? LayOutSmallPane(card, unit)
                           : rows == 1 ? LayOutTallPane(card, unit)
                                       : LayOutBesideHand(card, false, unit));
  }
  return layout;
}

VideoLayout LayOutOverlay(int width_px, int height_px) {
  VideoLayout layout = LayOutFrame(width_px, height_px, false);
  const double margin = kMargin * layout.unit, top = layout.header.height;
  const Rect card = {std::round(margin), std::round(top), std::floor(width_px - 2.0 * margin),
                     std::floor(height_px - top - margin)};
  layout.panes = {LayOutBesideHand(card, true, layout.unit)};
  return layout;
}

}  // namespace gauntlet::sim
