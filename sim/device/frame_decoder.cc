#include "sim/device/frame_decoder.h"

#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/device/device_clock.h"
#include "sim/device/text_frames.h"
#include "sim/recordings/missing.h"
#include "sim/recordings/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr double kNanosecond_s = 1e-9;

/// A value as a whole number; none if it is missing or too large.
std::optional<std::int64_t> WholeNumber(double value) {
  constexpr double kLargest = 9.2e18;
  if (!(std::abs(value) < kLargest)) return std::nullopt;
  return std::llround(value);
}

/// The time of a frame. Seconds and their fraction are converted apart, as a date in nanoseconds
/// has more digits than a double.
std::optional<std::int64_t> SenderTime_ns(const DeviceColumns& columns,
                                          std::span<const double> values) {
  if (columns.time.empty()) return std::nullopt;
  std::int64_t time_ns = 0;
  for (const TimeMapping& part : columns.time) {
    constexpr double kMost_s = 4e9;  // seconds of int64 in nanoseconds, over two
    const double time_s = values[part.column] * part.scale_s;
    if (!(std::abs(time_s) < kMost_s)) return std::nullopt;
    const double whole_s = std::floor(time_s);
    time_ns += static_cast<std::int64_t>(whole_s) * kNanosecondsPerSecond +
               std::llround((time_s - whole_s) / kNanosecond_s);
  }
  return time_ns;
}

}  // namespace

void SetColumnNames(std::vector<std::string> names, DeviceColumns& columns) {
  columns.number.reset();
  columns.time.clear();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::optional<double> scale_s = TimeScaleS(names[i]);
    const bool goes_on = columns.time.size() == 1 && columns.time[0].column + 1 == i &&
                         columns.time[0].scale_s == 1.0 && scale_s == kNanosecond_s;
    if (scale_s && (columns.time.empty() || goes_on)) {
      columns.time.push_back({.column = i, .scale_s = *scale_s});
    }
    if (!columns.number && IsSampleNumber(names[i])) columns.number = i;
  }
  columns.names = std::move(names);
  ++columns.version;
}

DeviceFrame FrameOf(const DeviceColumns& columns, std::span<double> values,
                    std::int64_t arrival_ns) {
  for (double& value : values) value = std::isfinite(value) ? value : kMissing;
  DeviceFrame frame{.arrival_ns = arrival_ns, .values = values};
  if (columns.number) frame.number = WholeNumber(values[*columns.number]);
  frame.sender_time_ns = SenderTime_ns(columns, values);
  return frame;
}

std::unique_ptr<FrameDecoder> MakeFrameDecoder(FrameFormat format, bool begins_whole,
                                               const std::string& /*osc_address*/) {
  return std::make_unique<TextFrames>(format, begins_whole);
}

}  // namespace gauntlet::sim
