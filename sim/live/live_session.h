#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/live/device/frame_sink.h"
#include "sim/live/device/frame_source.h"
#include "sim/live/duration_histogram.h"
#include "sim/live/frame_arrivals.h"
#include "sim/live/frame_channels.h"
#include "sim/live/live_view.h"
#include "sim/live/real_time.h"
#include "sim/live/session_recording.h"
#include "sim/live/stage_clock.h"
#include "sim/live/trend.h"
#include "sim/trial/trial.h"

namespace gauntlet::sim {

/// Another controller that gets the same samples and drives nothing.
struct ShadowSetup {
  std::string name;
  controller::ControllerConfig controller;
};

/// A controller between a glove and a hand in real time. Either of them may be a real one.
struct LiveSetup {
  TrialSetup trial;  // its links.config.glove is set where the glove is real
  std::vector<ShadowSetup> shadows = {};
  std::shared_ptr<const GloveSignal> simulated_glove = {};  // null: frames of `source`
  FrameSource* source = nullptr;
  FrameChannelsConfig channels = {};                 // of its frames
  bool names_may_follow = false;                     // of their columns, behind the first frames
  FrameSink* sink = nullptr;                         // null: the simulated hand alone
  bool sink_comes_back = true;                       // once it is gone; a pipe does not
  double seconds = 0.0;                              // 0: until the source ends, or StopAsked()
  double trace_s = 120.0;                            // the trace ends then
  std::function<void(const std::string&)> say = {};  // a line for the user
  LiveView* view = nullptr;                          // for one who watches
  SessionRecording* recording = nullptr;             // of the samples; null: none
};

inline constexpr std::size_t kMostSwitches = 256;  // and stretches, that are kept

/// Reason for which a session ended.
enum class LiveEnd : std::uint8_t { kSeconds, kGloveEnded, kStopped, kSinkGone, kHandStopped };

/// A tier of the watchdogs beyond `follow`.
struct TierFacts {
  std::int64_t entered = 0;
  double longest_s = 0.0;
};

/// Another controller took over.
struct Switched {
  double time_s = 0.0;  // since the first sample
  int to = 0;           // as in LiveView::Ask()
};

/// A stretch of half a second or more in which the hand was marked still [s], since the first
/// sample.
struct StillTime {
  double begin_s = 0.0;
  double end_s = 0.0;
};

/// Measurements of a session. Times are of CLOCK_MONOTONIC, in the computer.
struct LiveFacts {
  LiveEnd end = LiveEnd::kSeconds;
  double duration_s = 0.0;
  // The loop.
  std::int64_t ticks = 0;
  std::int64_t skipped_ticks = 0;
  std::int64_t longest_skip_ticks = 0;
  DurationHistogram lateness;   // of wake-ups
  DurationHistogram step;       // wake-up until the command, in real time
  DurationHistogram step_cpu;   // the same in processor time of the thread
  DurationHistogram tick_work;  // wake-up until the end of the tick, simulated hand included
  RealTimeRights rights;
  // From a sample to its command frame.
  std::array<DurationHistogram, kStages> stages;
  DurationHistogram total;
  Trend age_ms;                          // of the samples behind commands, over time [min]
  std::int64_t commands = 0;             // frames sent, or handed to the simulated hand
  std::int64_t repeated_samples = 0;     // commands behind which was the sample of the one before
  std::int64_t replaced_commands = 0;    // that the output thread found with a newer one
  std::int32_t largest_step_counts = 0;  // between two commands, of any motor
  // The way of the frames.
  ArrivalFacts arrivals;
  SourceCounts source;
  SinkCounts sink;
  std::int64_t input_overruns = 0;      // frames for which the ring to the control thread was full
  std::int64_t most_waiting = 0;        // frames in that ring
  std::int64_t most_queued = 0;         // frames in the receiver
  std::int64_t late_frames = 0;         // that arrived after the receiver needed them
  std::int64_t grid_shifts = 0;         // of the sampling grid, in ticks
  std::array<TierFacts, 4> tiers = {};  // of Watchdog::Tier
  std::int64_t switch_count = 0;
  std::vector<Switched> switches;  // the first of them, at most kMostSwitches
  std::vector<StillTime> still;    // the first of them, at most kMostSwitches
  std::int64_t rests = 0;          // times that the motors were brought to rest: sink gone, or end
  std::vector<std::int64_t> untrusted_samples;  // per channel
};

struct ShadowResult {
  Signal target_angle_rad;  // ticks x joints of the hand
  DurationHistogram step;
};

struct LiveResult {
  LiveFacts facts;
  Trace trace;  // from the first sample on, a row per tick; a skipped tick repeats the row before
  std::int64_t trace_rows_left_out = 0;
  RecordedFacts recorded;      // of LiveSetup::recording
  std::string columns_remark;  // of FrameChannels
  std::vector<ShadowResult> shadows;
};

/// Runs a session: the loop of a trial, with time of the real clock. Threads: input (a real glove),
/// control, output (real motors), log. The control thread neither allocates nor takes locks. Its
/// system calls are those of its sleep, of its processor time and of waking the output thread.
///
/// The recording has its samples within a second, its times from the first row of the trace on.
/// A disk that is full is tried again, and does not end the session.
///
/// A real glove is waited for. Frames that stay away, come late, repeated or in another order are
/// decided by the receiver and the watchdog of `link.glove`; a device that vanishes may come back.
/// Before a session with real motors ends, and while their sink is gone, the motors turn to their
/// rest positions at a limited speed, and so they follow again.
///
/// A watcher may switch to the controller of a shadow and back. The trace ends at the first switch:
/// it is of one controller. Shadows and the recording go on.
///
/// Errors: UserError for frames that are not those of the glove; RunError if no thread starts.
LiveResult RunLive(const LiveSetup& setup);

}  // namespace gauntlet::sim
