#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/base/masked_stretch.h"
#include "sim/base/segment.h"
#include "sim/base/signal.h"
#include "sim/glove/sensor/converter.h"

namespace gauntlet::sim {

struct Recording;

/// True joint angles of the wearer over time. Channels are all of KnownChannels().
struct Motion {
  Signal angle_rad;               // samples x channels
  std::vector<Segment> segments;  // that a person labelled
  /// Angles that a recorded glove measured; empty without such a recording. NaN is missing.
  Signal measured_rad;
  std::vector<MaskedStretch> masked;           // of a recording: unknown motion, in samples
  std::shared_ptr<const Recording> recording;  // what it was made from, if it was
  double recording_start_s = 0.0;              // of the stretch that is played
  std::string reference_name = "ground truth";
  std::vector<std::string> remarks;  // what was repaired in a recording, one line each
};

/// Facts that all kinds of motion need besides their own settings.
struct MotionContext {
  double rate_hz = 1000.0;
  std::uint64_t seed = 0;
  std::uint64_t part = 0;         // place in a sequence: its random streams are its own
  std::vector<double> start_rad;  // per channel, where the part before ended; empty if none
  ConverterConfig converter;

  /// Errors: SettingError for more than an hour.
  int SampleCount(double duration_s) const;
  /// The angles that the motion begins with: where the part before ended, or this posture.
  std::vector<double> StartAngles(std::size_t posture = 0) const;
  /// For a random stream of one channel of this part.
  std::uint64_t StreamIndex(std::size_t channel) const { return part * 1000 + channel; }
};

/// A motion of this many samples at angle 0.
Motion StillMotion(int samples);
/// Calls `move(channel, number among them, motion)` for each channel that is named as
/// SelectChannels() says. The others hold their start.
Motion MoveChannels(const std::vector<std::string>& names, int samples,
                    const MotionContext& context,
                    const std::function<void(std::size_t, int, Motion&)>& move);
/// `channel` stands still at this angle.
void HoldChannel(std::size_t channel, double angle_rad, Motion& motion);

/// One entry per channel of KnownChannels(): is it named? An empty list names all.
/// Errors: SettingError of `channels` for an unknown name.
std::vector<bool> SelectChannels(const std::vector<std::string>& names);

/// Middle of where a motion that makes up its angles moves a channel, and `range_percent` of half
/// of it: the joint's range; for the thumb that part of it in which it meets no finger.
struct Excursion {
  double middle_rad;
  double half_rad;
};
Excursion ChannelExcursion(std::size_t channel, double range_percent);

}  // namespace gauntlet::sim
