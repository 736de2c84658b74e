#pragma once

#include <span>
#include <vector>

#include "sim/show/video/comparison_video.h"
#include "sim/show/video/curve_plot.h"
#include "sim/show/video/frame_clock.h"
#include "sim/show/video/ghost.h"
#include "sim/show/video/hand_colours.h"
#include "sim/show/video/hand_view.h"
#include "sim/show/video/image.h"
#include "sim/show/video/running_scores.h"
#include "sim/show/video/video_layout.h"

namespace gauntlet::sim {

/// Drawings of a frame: the hands of all panes, their fingertips in slow motion, the wearer's.
struct DrawnHands {
  std::span<const Image> panes;
  std::span<const Image> insets;
  Ghost& wearer;
  Ghost& second;  // of an overlay: the second hand
  const HandView& view;
};

/// Everything in a frame but the drawn hands: titles, running numbers, curves. Const once made, so
/// many processes draw with one.
/// Errors: UserError for sizes, RunError for signals that do not fit together.
class ComparisonPicture {
 public:
  /// `input` and its signals must outlive the picture.
  explicit ComparisonPicture(const VideoInput& input);

  const FrameClock& clock() const { return clock_; }
  int frame_count() const { return clock_.FrameCount(); }
  /// Size of the pictures of hands that Draw() expects.
  int view_width_px() const;
  int view_height_px() const;
  /// Side of the pictures of fingertips; 0: there are none.
  int inset_px() const;
  const ColourScale& colour_scale() const { return colour_scale_; }
  const RunningScores& scores(int pane) const { return scores_[pane]; }
  /// The sample that a pane shows: its last one where a trial was stopped before.
  int SampleOf(int pane, int frame) const;

  /// Width of lines around the wearer's hand.
  int outline_px() const;
  /// Whole frames before and after the motion.
  void DrawTitle(ImageView image) const;
  void DrawVerdict(ImageView image) const;
  /// The whole frame of the motion, into an image of the video's size.
  void Draw(int frame, const DrawnHands& hands, ImageView image) const;

 private:
  const PaneLayout& PlaceOf(int pane) const { return layout_.panes[input_.overlay ? 0 : pane]; }
  Columns<Signal> Measured(const Signal& all_joints) const;
  int SampleCount(int pane) const;
  bool HasStopped(int pane, int frame) const { return clock_.Sample(frame) >= SampleCount(pane); }
  AngleScale ScaleOfErrors() const;
  AngleScale ScaleOfJitter() const;
  Signal JitterOf(const VideoPane& pane) const;
  void DrawBackground();
  void DrawHeader(Painter& painter) const;
  /// Returns where it begins.
  double DrawLegend(Painter& painter, double right, double baseline) const;
  void DrawClock(Painter& painter, int frame) const;
  /// The name of the part of the motion that is shown, if it has one.
  void DrawPart(Painter& painter, int frame, Point right_end) const;
  void DrawView(Painter& painter, int pane, const DrawnHands& hands) const;
  void DrawOverlay(Painter& painter, const DrawnHands& hands) const;
  void DrawPane(Painter& painter, int pane, int frame, const DrawnHands& hands) const;
  void DrawInset(Painter& painter, int pane, int frame, const DrawnHands& hands) const;
  void DrawCurves(Painter& painter, int place, int frame) const;
  void DrawStop(Painter& painter, int pane) const;
  void DrawScore(Painter& painter, Rect rect, int pane, int frame, std::string label,
                 std::vector<double> RunningScores::*score) const;

  const VideoInput& input_;
  FrameClock clock_;
  VideoLayout layout_;
  std::vector<int> measured_joints_;
  ColourScale colour_scale_;
  std::vector<RunningScores> scores_;
  std::vector<Signal> errors_;  // per pane: of the joint that is drawn, hand less wearer [rad]
  std::vector<Signal> jitter_curves_;  // likewise: of the hand, not a number near the ends
  // Per place of the layout.
  std::vector<CurvePlot> error_plots_;
  std::vector<CurvePlot> jitter_plots_;  // none where there is no room
  Image background_;
};

}  // namespace gauntlet::sim
