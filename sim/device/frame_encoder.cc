#include "sim/device/frame_encoder.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/device/device_clock.h"

namespace gauntlet::sim {
namespace {

/// Seconds with all nanoseconds.
std::string TimeText(std::int64_t time_ns) {
  return fmt::format("{}.{:09}", time_ns / kNanosecondsPerSecond, time_ns % kNanosecondsPerSecond);
}

class CsvEncoder : public FrameEncoder {
 public:
  explicit CsvEncoder(const std::vector<std::string>& names) {
    std::vector<std::string> header = {"frame", "time_s"};
    header.insert(header.end(), names.begin(), names.end());
    header_ = CsvLine(header);
  }

  std::string Names() const override { return header_; }
  std::string Frame(const OutgoingFrame& frame) const override {
    std::string line = fmt::format("{},{}", frame.number, TimeText(frame.time_ns));
    for (const double value : frame.values) line += "," + NumberOrNothing(value);
    return line + "\n";
  }

 private:
  std::string header_;
};

}  // namespace

std::unique_ptr<FrameEncoder> MakeFrameEncoder(const DeviceAddress& address,
                                               const std::vector<std::string>& names) {
  switch (address.format) {
    case FrameFormat::kDetect:
    case FrameFormat::kCsv:
      return std::make_unique<CsvEncoder>(names);
    default:
      throw UserError({.place = Shown(address.text),
                       .problem = fmt::format("cannot send {}", WordOf(address.format))});
  }
}

}  // namespace gauntlet::sim
