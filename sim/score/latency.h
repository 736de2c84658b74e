#pragma once

#include <string_view>
#include <vector>

#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// The signals of one trial in the order in which a sample passes them, as angles of the hand's
/// joints. Views; none may be null. Shapes: ticks x joints. A joint with a NaN has no latency.
struct LatencyInput {
  double rate_hz = 1000.0;                     // of ticks
  const Signal* wearer_angle_rad = nullptr;    // what is asked of the hand
  const Signal* raw_angle_rad = nullptr;       // before the filter
  const Signal* filtered_angle_rad = nullptr;  // behind the filter, every tick
  const Signal* target_angle_rad = nullptr;    // behind prediction, what the hand was asked for
  const Signal* command_angle_rad = nullptr;   // the frame that has arrived at the servos
  const Signal* hand_angle_rad = nullptr;
  double ticks_per_event = 20.0;        // the controller sends a frame every so many ticks
  double ticks_per_servo_frame = 20.0;  // the servo takes one every so many; up to 1: at once
  double look_ahead_s = 0.0;            // of the prediction
  double earliest_delay_s = 0.0;        // of the whole way, see DelaySamples()
  int first_servo_frame = 0;            // the tick of one of the servo's frames, where they begin
  const std::vector<CountedTicks>* counted = nullptr;  // of each joint; null: all ticks of all
};

/// One stage of the way from the wearer's joint to the hand's.
struct LatencyStage {
  std::string_view key;            // "filter_ms"
  std::string_view help;           // "the filter"
  double mean_ms = 0.0;            // over the channels that have a latency
  std::vector<double> channel_ms;  // NaN for a channel that does not move
};

/// Parts of the delay.
struct LatencyBudget {
  std::vector<LatencyStage> stages;
  double sum_ms = 0.0;    // of the stages
  double total_ms = 0.0;  // measured between the two ends
};

/// The delay of each stage, measured by itself with DelaySamples() between what goes in and what
/// comes out, and of the whole way. The stages are: sensor, filter, waiting for the event,
/// prediction, event delay, waiting for the servo's frame, servo and cables. That of a prediction
/// is below 0, by as much as it makes up for.
///
/// A stage may pass its input on: its lags begin 50 ms before 0, those of the prediction by its
/// horizon sooner.
///
/// All signals pass means over 4 ms and the same zero-phase low pass of 6 Hz (4 to 8 Hz) first:
/// noise that a filter takes over from its input would otherwise draw the correlation to the
/// filter's own impulse response. So these are delays of the motion and not of its noise. What the
/// controller sends and what the servo takes is what was there at the last event (a multiple of the
/// period) or frame.
///
/// Only ticks that count have a share, also through the low pass.
///
/// Means are over the channels in which every stage and the whole has a value.
/// Errors: std::invalid_argument for signals that do not fit each other.
LatencyBudget MeasureLatency(const LatencyInput& input);

}  // namespace gauntlet::sim
