#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/hand/hand_model.h"
#include "sim/show/video/comparison_video.h"

namespace gauntlet::sim {

inline const std::vector<std::string> kChannels = GloveChannelNames();

inline const HandModel& TheHand() {
  static const HandModel hand{HandConfig{}};
  return hand;
}

/// Half a second of fingers that bend, once exactly and once by half, as a video of two panes.
class SmallComparison {
 public:
  SmallComparison() {
    const auto channels = static_cast<Eigen::Index>(kChannels.size());
    true_angle_rad_ = Signal::Zero(kSamples, channels);
    for (int i = 0; i < kSamples; ++i) {
      const double bent = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * i / kSamples);
      for (int channel : {4, 6, 8, 10}) true_angle_rad_(i, channel) = bent;
    }
    half_ = 0.5 * true_angle_rad_;
    spool_ = Signal::Zero(kSamples, channels);
    input.title = "A test";
    input.true_angle_rad = &true_angle_rad_;
    input.joint = 4;
    input.joint_name = "index_mcp";
    input.camera = "hand";
    input.width_px = 480;
    input.height_px = 270;
    input.panes = {PaneOf("all", true_angle_rad_, 1), PaneOf("half", half_, 2)};
  }

  VideoPane PaneOf(const char* title, const Signal& hand_rad, std::size_t series) const {
    return {
        .title = title, .hand_angle_rad = &hand_rad, .spool_angle_rad = &spool_, .series = series};
  }

  SmallComparison(const SmallComparison&) = delete;  // the input points into it
  SmallComparison& operator=(const SmallComparison&) = delete;

  static constexpr int kSamples = 500;
  VideoInput input;

 private:
  Signal true_angle_rad_, half_, spool_;
};

}  // namespace gauntlet::sim
