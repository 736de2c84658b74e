#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/segment.h"
#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"
#include "sim/show/video/frame_clock.h"
#include "sim/show/video/look.h"
#include "sim/show/video/score_board.h"
#include "sim/show/video/video_encoder.h"

namespace gauntlet::sim {

/// One pane: a controller's hand and its numbers.
struct VideoPane {
  std::string title;
  std::string role = {};  // of the controller in the verdict: recommended, baseline; may be empty
  const Signal* hand_angle_rad = nullptr;   // ticks x joints
  const Signal* spool_angle_rad = nullptr;  // ticks x motors
  const Signal* object_pose = nullptr;      // ticks x 7: of the object, if there is one
  const Signal* tension_n = nullptr;  // ticks x cables: colours them; none: as the model has them
  std::size_t series = 1;             // number of its colour in palette::kSeries
};

/// How long the question stands before the motion, and the verdict after it.
inline constexpr double kTitle_s = 1.5;
inline constexpr double kVerdict_s = 2.5;

struct VideoInput {
  std::string title;
  std::string question;                    // on a card of its own before the motion; empty: none
  ScoreBoard verdict;                      // after it; no rows: none
  double rate_hz = 1000.0;                 // of ticks
  const Signal* true_angle_rad = nullptr;  // ticks x joints: what the wearer asks of the hand
  std::vector<VideoPane> panes;
  bool overlay = false;  // two panes as one picture, the second hand translucent behind the first
  std::vector<Segment> parts;         // of the motion that have a name, in ticks: chapters
  std::vector<int> measured_joints;   // whose scores count; empty: all
  std::vector<CountedTicks> counted;  // of each of these joints, which ticks do; none: all
  double jitter_above_hz = 10.0;      // lower edge of jitter: score.jitter_above_hz
  int joint = 0;                      // whose curves are drawn
  std::string joint_name;
  std::string camera;
  int width_px = 1280;
  int height_px = 720;
  int frames_per_s = 30;
  Excerpt excerpt;
  std::optional<Excerpt> again;  // a part of the motion that is shown once more behind it, slowly
  Look look = kGoodLook;
  int rate_factor = VideoFormat{}.rate_factor;
  int jobs = 2;
};

/// Stretches of a video of a whole motion of `samples`.
std::vector<VideoStretch> StretchesOf(bool has_title, double rate_hz, std::int64_t samples,
                                      int frames_per_s, const std::optional<Excerpt>& again);

/// The joints whose scores count.
std::vector<int> MeasuredJointsOf(const VideoInput& input);

/// Pictures slower than the motion have a magnified fingertip.
constexpr bool IsSlowMotion(const Excerpt& excerpt) { return excerpt.speed < 1.0; }

/// Draws off-screen and encodes frame by frame, so memory does not grow with the length. Each
/// library works in processes of its own (ordered_frames.h): no other thread may run meanwhile.
/// The file appears under its name only when it is whole.
/// Errors: RunError for a missing encoder, a full disk, too little memory, a process that crashed.
/// A target that ends in .webm is VP9 in WebM, .gif a GIF, any other H.264 in MP4. Where parts of
/// the motion have names, MP4 and WebM have chapters.
/// `progress` gets frames done and frames in all; false stops and throws Cancelled.
void WriteComparisonVideo(const VideoInput& input, const HandModel& hand,
                          const std::filesystem::path& target,
                          const std::function<bool(int, int)>& progress = {});

/// The frame at a moment as a picture. Errors: UserError for one outside the motion.
void WriteComparisonPng(const VideoInput& input, const HandModel& hand, double time_s,
                        const std::filesystem::path& target);

}  // namespace gauntlet::sim
