#include "sim/glove/motions/motion_config.h"

#include <array>
#include <string_view>

#include "sim/glove/motions/postures.h"

namespace gauntlet::sim {
namespace {

// An hour of 18 channels at 1 kHz is half a gigabyte a signal.
constexpr double kLongestMotionS = 3600.0;

constexpr std::array<std::string_view, 3> kKindNames = {"hold", "recording", "random"};

void VisitDuration(controller::SettingsVisitor& visitor, double& duration_s) {
  visitor.Number({.key = "duration_s", .help = "how long", .min = 0.01, .max = kLongestMotionS},
                 duration_s);
}

}  // namespace

void HoldConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Choice({.key = "posture", .help = "what the hand and arm hold"}, PostureNames(), posture);
}

void RecordedMotionConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Path({.key = "file",
                .help = "comma-separated joint angles: time_s and channels by name, in degrees",
                .required = true},
               file);
  visitor.Number(
      {.key = "start_s", .help = "where in the recording to start", .min = 0, .max = 1e9}, start_s);
  visitor.Number({.key = "duration_s",
                  .help = "how long; 0 plays it to its end",
                  .min = 0,
                  .max = kLongestMotionS},
                 duration_s);
}

void RandomMotionConfig::Visit(controller::SettingsVisitor& visitor) {
  VisitDuration(visitor, duration_s);
  visitor.Number({.key = "bandwidth_hz",
                  .help = "frequency at which the amplitude has fallen to 0.707 (-3 dB)",
                  .min = 0.01,
                  .max = 50},
                 bandwidth_hz);
  visitor.Number({.key = "range_percent",
                  .help = "largest excursion, of each joint's range about its middle",
                  .min = 0,
                  .max = 100},
                 range_percent);
}

void MotionConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::VisitEnum(visitor, {.key = "kind", .help = "what the wearer does"}, kKindNames, kind);
  switch (kind) {
    case MotionKind::kHold:
      return hold.Visit(visitor);
    case MotionKind::kRecording:
      return recording.Visit(visitor);
    case MotionKind::kRandom:
      return random.Visit(visitor);
  }
}

}  // namespace gauntlet::sim
