#pragma once

#include <string>
#include <vector>

#include "controller/timing.h"
#include "sim/live/live_session.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

class Json;

/// Content of a report besides the measurements.
struct LiveContext {
  std::string scenario;
  std::string controller;
  std::vector<std::string> controllers;  // that one first, then the shadows
  std::string glove;                     // description of the source
  std::string motors;                    // of the sink
  bool has_real_glove = false;
  bool has_motors = false;
  controller::Timing timing;
  double event_delay_ms = 0.0;   // of the scenario, for the simulated hand
  std::string counts_file = {};  // of a session with marks
  std::vector<controller::ConverterRange> converters = {};  // of its channels
  std::string receiver;  // kind of the receiver of `link.glove`; empty: none
};

/// Score of a controller that only listened, or of the one that drove, on what it asked of the
/// joints, against the reference.
struct ShadowScore {
  std::string name;
  bool drives = false;
  double jitter_rms_deg = 0.0;
  double delay_ms = 0.0;
  double tracking_rmse_deg = 0.0;
  double step_p99_us = 0.0;
};

/// The stage with the largest mean.
Stage LargestStage(const LiveFacts& facts);

/// The measurements for people: time by stages, frames, trend, queues, watchdog, loop, advice, and
/// which numbers are measured and which assumed.
ResultText LiveText(const LiveFacts& facts, const LiveContext& context);
/// The table of the controllers, and which to use.
ResultText ShadowText(const std::vector<ShadowScore>& scores, const std::string& reference);

/// `live.json`: the same as numbers, with the histograms.
Json LiveJson(const LiveFacts& facts, const LiveContext& context,
              const std::vector<ShadowScore>& shadows);

}  // namespace gauntlet::sim
