#pragma once

#include <string>
#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

// Settings that several kinds of motion share, described once.

// An hour of 18 channels at 1 kHz is half a gigabyte a signal.
inline constexpr double kLongestMotionS = 3600.0;

inline void VisitDuration(controller::SettingsVisitor& visitor, double& duration_s) {
  visitor.Number({"duration_s", "how long", 0.01, kLongestMotionS}, duration_s);
}

inline void VisitRange(controller::SettingsVisitor& visitor, double& range_percent) {
  visitor.Number({"range_percent",
                  "largest excursion, of each joint's range about its middle; the thumb's is where "
                  "it meets no finger",
                  0, 100},
                 range_percent);
}

inline void VisitChannels(controller::SettingsVisitor& visitor,
                          std::vector<std::string>& channels) {
  visitor.Texts({"channels", "names of the channels that take part; empty: all of them"}, channels);
}

}  // namespace gauntlet::sim
