#pragma once

#include <vector>

#include "sim/hand/hand_model.h"
#include "sim/show/video/comparison_video.h"
#include "sim/show/video/scene_geoms.h"

namespace gauntlet::sim {

/// Scale of the colours of all panes of a video.
struct ColourScale {
  double largest_tension_n = 0.0;  // in any pane; 0: no tension is known
  /// Links with this error have the full colour: one of the usual steps that all joints in
  /// all panes stay below for 98 % of the time.
  double full_error_deg = 1.0;
};

ColourScale ColourScaleOf(const VideoInput& input);

/// Colour of all that belongs to a pane's hand.
Color ColourOfPane(const VideoInput& input, int pane);

/// Colours of a hand at a sample: the pull of its cables, and the distance of each link's joints
/// from the wearer's. Links that no measured joint moves have the colour of what carries them.
/// Colours are absent where the wearer's motion is unknown.
class HandColours {
 public:
  /// `input` and `hand` must outlive it.
  HandColours(const VideoInput& input, const HandModel& hand, const ColourScale& scale);

  /// Valid until the next call.
  SceneColours Of(int pane, int sample);

 private:
  void ShareOfPull(const VideoPane& pane, int sample);
  void ShareOfError(const VideoPane& pane, int sample);
  bool Counts(std::size_t measured, int sample) const;

  const VideoInput& input_;
  const HandModel& hand_;
  ColourScale scale_;
  std::vector<int> tendon_of_cable_;      // -1: the model draws none
  std::vector<int> measured_joints_;      // in the hand's order
  std::vector<bool> has_measured_joint_;  // per body
  std::vector<float> cable_share_, link_share_;
};

}  // namespace gauntlet::sim
