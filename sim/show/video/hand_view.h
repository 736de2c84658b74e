#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <vector>

#include "sim/hand/camera_view.h"
#include "sim/hand/hand_model.h"
#include "sim/show/video/camera_window.h"
#include "sim/show/video/comparison_video.h"
#include "sim/show/video/osmesa_renderer.h"

namespace gauntlet::sim {

struct FreeData {
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using DataOfModel = std::unique_ptr<mjData, FreeData>;

/// A state of the hand's model, to put it into recorded postures. Errors: RunError, out of memory.
DataOfModel MakeData(const HandModel& hand);

/// Puts `data` into the wearer's posture, whose hand has no motors, or into that of a pane, with
/// its object.
void SetWearer(const VideoInput& input, const HandModel& hand, int sample, mjData& data);
void SetPane(const VideoPane& pane, const HandModel& hand, int sample, mjData& data);

/// A fingertip as its camera sees it, in tangents; `rate_hz` points a second from `first_s` on.
struct FingertipPath {
  struct Place {
    Point tip;
    Point smooth;  // without jitter: without the angles' part above `jitter_above_hz`
  };
  double first_s = 0.0;
  double rate_hz = 0.0;
  std::vector<Place> places;

  /// The nearest; within the path.
  int IndexAt(double time_s) const;
};

/// View of the camera on all hands in all panes, the same for each: the shapes that move in any of
/// them, and the palm, as large as fits. It follows the palm of the wearer's hand and does not
/// turn.
///
/// Slow motion also has a picture of each fingertip, `kMagnification` times as large, that follows
/// the fingertip without its jitter: so what moves there is the jitter. Near either end of the
/// motion, where the score jitter_rms_deg has no value, there is none.
///
/// Const once made, so that many processes draw with one.
class HandView {
 public:
  static constexpr double kMagnification = 5.0;

  /// `inset_px`: side of the picture of a fingertip; 0: there is none.
  HandView(const VideoInput& input, const HandModel& hand, int width_px, int height_px,
           int inset_px = 0);

  /// Window of the camera while the wearer's hand is as in `wearer`. None for the free camera, and
  /// where nothing moves: all that it sees.
  std::optional<CameraWindow> WindowAt(const mjData& wearer) const;
  /// How hands are drawn; the window is set for each frame.
  RendererConfig RendererOf(const VideoInput& input) const;
  RendererConfig InsetRendererOf(const VideoInput& input) const;
  /// Per body of the model, whether it is of the hand and moves against the camera's own; none for
  /// the free camera.
  const std::vector<bool>& bodies() const { return bodies_; }
  /// Fingertip path of each pane; no places where there is no window or no picture of it.
  const FingertipPath& fingertip(int pane) const { return fingertips_[pane]; }
  int inset_px() const { return inset_px_; }
  CameraWindow InsetAround(Point tangents) const;

 private:
  std::optional<CameraWindow> FrameWhatMoves(const VideoInput& input, const HandModel& hand,
                                             mjData& data) const;
  /// Place of the palm, which the window follows; the middle of the picture where there is no palm.
  Point PalmIn(const mjData& data) const;

  int width_px_;
  int height_px_;
  int inset_px_;
  CameraView view_;
  std::optional<int> camera_;
  int palm_;  // body; -1: none
  std::vector<bool> bodies_;
  std::optional<CameraWindow> window_;  // around the palm
  std::vector<FingertipPath> fingertips_;
};

}  // namespace gauntlet::sim
