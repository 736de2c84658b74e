#include "sim/video/video_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/error.h"
#include "sim/scenario/scenario.h"

namespace gauntlet::sim {
namespace {

// The design, in pixels at 1280 x 720.
constexpr double kMargin = 20.0;
constexpr double kGap = 14.0;
constexpr double kHeaderHeight = 60.0;
constexpr double kProgressHeight = 4.0;
constexpr double kPadding = 14.0;
constexpr double kTitleHeight = 40.0;
constexpr double kScoreHeight = 54.0;
constexpr double kScoreGap = 16.0;
constexpr double kAngleLabelWidth = 28.0;
constexpr double kTimeLabelHeight = 18.0;
constexpr double kPlotCaptionHeight = 22.0;
constexpr double kPlotShare = 0.5;  // of what hand and curves have together
constexpr double kMaxPlotHeight = 280.0;
constexpr double kAngleShare = 0.24;  // of all plots, without their labels
constexpr double kTremblingShare = 0.3;
constexpr double kViewShare = 0.45;  // of a pane's width, where the hand stands beside

Rect Rounded(const Rect& rect) {
  const double x = std::round(rect.x), y = std::round(rect.y);
  return {x, y, std::round(rect.right()) - x, std::round(rect.bottom()) - y};
}

/// The plots' areas between two heights: captions above each, labels on the left and below. Either
/// all of them, or only the error.
void PlacePlots(double left, double right, double top, double bottom, bool all, double unit,
                PaneLayout& pane) {
  const double x = left + kAngleLabelWidth * unit, caption = kPlotCaptionHeight * unit;
  const double height = bottom - kTimeLabelHeight * unit - top - (all ? 3.0 : 1.0) * caption;
  double y = top;
  const auto place = [&](double share) {
    const Rect plot = Rounded({x, y + caption, right - x, share * height});
    y = plot.bottom();
    return plot;
  };
  if (!all) {
    pane.error = place(1.0);
    return;
  }
  pane.angle = place(kAngleShare);
  pane.error = place(1.0 - kAngleShare - kTremblingShare);
  pane.trembling = place(kTremblingShare);
}

Rect TitleOf(const Rect& card, double unit) {
  const double padding = kPadding * unit;
  return Rounded({card.x + padding, card.y, card.width - 2.0 * padding, kTitleHeight * unit});
}

/// From the top: title, hand, the two numbers side by side, angle, error.
PaneLayout LayOutTallPane(const Rect& card, double unit) {
  const double padding = kPadding * unit, gap = kScoreGap * unit;
  const double left = card.x + padding, right = card.right() - padding;
  PaneLayout pane = {.card = card, .title = TitleOf(card, unit)};
  const double below = card.height - (kTitleHeight + kScoreHeight) * unit;
  const double plot_height = std::min(kPlotShare * below, kMaxPlotHeight * unit);
  pane.view = Rounded({card.x, pane.title.bottom(), card.width, below - plot_height});
  const double width = (right - left - gap) / 2.0, height = kScoreHeight * unit;
  pane.tracking = Rounded({left, pane.view.bottom(), width, height});
  pane.jitter = Rounded({right - width, pane.view.bottom(), width, height});
  PlacePlots(left, right, pane.jitter.bottom(), card.bottom() - padding, true, unit, pane);
  return pane;
}

/// Below the title the hand on the left; on the right the two numbers and the error, or all plots.
PaneLayout LayOutBesideHand(const Rect& card, bool all_plots, double unit) {
  const double padding = kPadding * unit;
  PaneLayout pane = {.card = card, .title = TitleOf(card, unit)};
  pane.view = Rounded(
      {card.x, pane.title.bottom(), kViewShare * card.width, card.bottom() - pane.title.bottom()});
  const double left = pane.view.right() + padding, right = card.right() - padding;
  const double height = kScoreHeight * unit;
  pane.tracking = Rounded({left, pane.title.bottom(), right - left, height});
  pane.jitter = Rounded({left, pane.tracking.bottom(), right - left, height});
  PlacePlots(left - 0.5 * padding, right, pane.jitter.bottom(), card.bottom() - 0.5 * padding,
             all_plots, unit, pane);
  return pane;
}

/// All but the panes.
VideoLayout LayOutFrame(int width_px, int height_px) {
  if (width_px < VideoConfig::kMinWidth_px || height_px < VideoConfig::kMinHeight_px) {
    throw UserError(fmt::format("video: {} x {} px is too small, at least {} x {} px are needed",
                                width_px, height_px, VideoConfig::kMinWidth_px,
                                VideoConfig::kMinHeight_px));
  }
  VideoLayout layout;
  layout.unit = std::min(width_px / 1280.0, height_px / 720.0);
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
  VideoLayout layout = LayOutFrame(width_px, height_px);
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
    layout.panes.push_back(rows == 1 ? LayOutTallPane(card, unit)
                                     : LayOutBesideHand(card, false, unit));
  }
  return layout;
}

VideoLayout LayOutOverlay(int width_px, int height_px) {
  VideoLayout layout = LayOutFrame(width_px, height_px);
  const double margin = kMargin * layout.unit, top = layout.header.height;
  const Rect card = {std::round(margin), std::round(top), std::floor(width_px - 2.0 * margin),
                     std::floor(height_px - top - margin)};
  layout.panes = {LayOutBesideHand(card, true, layout.unit)};
  return layout;
}

}  // namespace gauntlet::sim
