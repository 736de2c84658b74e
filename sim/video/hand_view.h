#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sim/hand/camera_view.h"
#include "sim/hand/hand_model.h"
#include "sim/video/camera_window.h"
#include "sim/video/comparison_video.h"
#include "sim/video/osmesa_renderer.h"

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

/// A fingertip's way over the picture: pixels from its top left corner, `rate_hz` a second.
struct FingertipWay {
  double rate_hz = 0.0;
  std::vector<Point> points;
};

/// What the camera shows of all hands in all panes, the same for each: the shapes that move in any
/// of them, and the palm, as large as fits; the wearer's fingertip and that of each pane.
///
/// Jitter of fingertips is drawn `kTremblingGain` times as large: 0.3 deg of a finger are 0.4 mm,
/// which is invisible. The factor applies to the angles' part above `jitter_above_hz`, as in the
/// score jitter_rms_deg. Near either end, where the score has no value, it is 1.
///
/// Const once made, so that many processes draw with one.
class HandView {
 public:
  static constexpr double kTremblingGain = 10.0;

  HandView(const VideoInput& input, const HandModel& hand, int width_px, int height_px);

  /// None for the free camera, and where nothing moves: all that the camera sees.
  const std::optional<CameraWindow>& window() const { return window_; }
  /// How hands are drawn for it.
  RendererConfig RendererOf(const VideoInput& input) const;
  /// Per body of the model, whether it is of the hand and moves against the camera's own; none for
  /// the free camera.
  const std::vector<bool>& bodies() const { return bodies_; }
  /// No points where there is no window.
  const FingertipWay& wearers_fingertip() const { return wearers_fingertip_; }
  const FingertipWay& fingertip(int pane) const { return fingertips_[pane]; }

 private:
  std::optional<CameraWindow> FrameWhatMoves(const VideoInput& input, const HandModel& hand,
                                             mjData& data) const;

  int width_px_;
  int height_px_;
  CameraView view_;
  std::optional<int> camera_;
  std::vector<bool> bodies_;
  std::optional<CameraWindow> window_;
  FingertipWay wearers_fingertip_;
  std::vector<FingertipWay> fingertips_;
};

}  // namespace gauntlet::sim
