#include "sim/live/device/frame_decoder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/text.h"
#include "sim/live/device/binary_frames.h"
#include "sim/live/device/cyberglove_frames.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/device/osc_frames.h"
#include "sim/live/device/text_frames.h"
#include "sim/tables/missing.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

constexpr double kNanosecond_s = 1e-9;

/// A value as a whole number; none if it is missing or too large.
std::optional<std::int64_t> WholeNumber(double value) {
  constexpr double kLargest = 9.2e18;
  if (!(std::abs(value) < kLargest)) return std::nullopt;
  return std::llround(value);
}

/// The time of a row. Seconds and their fraction are converted apart, as a date in nanoseconds has
/// more digits than a double.
std::optional<std::int64_t> SenderTime_ns(const DeviceColumns& columns,
                                          std::span<const double> values) {
  if (columns.time.empty()) return std::nullopt;
  std::int64_t time_ns = 0;
  for (const TimeMapping& part : columns.time) {
    constexpr double kMost_s = 4e9;  // half of what 63 bits of nanoseconds hold
    const double time_s = values[part.column] * part.scale_s;
    if (!(std::abs(time_s) < kMost_s)) return std::nullopt;
    const double whole_s = std::floor(time_s);
    time_ns += static_cast<std::int64_t>(whole_s) * kNanosecondsPerSecond +
               std::llround((time_s - whole_s) / kNanosecond_s);
  }
  return time_ns;
}

/// Gives the bytes to the decoders of several formats. The first that makes a frame of them stays.
class DetectingDecoder : public FrameDecoder {
 public:
  explicit DetectingDecoder(std::vector<std::unique_ptr<FrameDecoder>> candidates)
      : candidates_(std::move(candidates)) {}

  void Decode(std::string_view bytes, std::int64_t arrival_ns,
              const FrameReceiver& receive) override {
    Try(receive, [&](FrameDecoder& decoder, const FrameReceiver& receiver) {
      decoder.Decode(bytes, arrival_ns, receiver);
    });
  }
  void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) override {
    Try(receive, [&](FrameDecoder& decoder, const FrameReceiver& receiver) {
      decoder.EndPacket(arrival_ns, receiver);
    });
  }
  void Restart() override {
    for (const auto& candidate : candidates_) candidate->Restart();
  }
  FrameFormat format() const override {
    return candidates_.size() == 1 ? chosen().format() : FrameFormat::kDetect;
  }
  const DeviceColumns& columns() const override { return chosen().columns(); }
  const SourceCounts& counts() const override { return chosen().counts(); }
  const std::string& problem() const override { return chosen().problem(); }

 private:
  /// Before a choice: the last candidate, that of text. A receiver sees the decoder of its frame.
  const FrameDecoder& chosen() const { return *(calling_ ? calling_ : candidates_.back().get()); }

  template <class Call>
  void Try(const FrameReceiver& receive, const Call& call) {
    if (candidates_.size() == 1) {
      call(*candidates_.front(), receive);
      return;
    }
    for (auto& candidate : candidates_) {
      calling_ = candidate.get();
      call(*candidate, receive);
      calling_ = nullptr;
      if (candidate->counts().frames == 0) continue;
      std::unique_ptr<FrameDecoder> found = std::move(candidate);
      candidates_.clear();
      candidates_.push_back(std::move(found));
      return;
    }
  }

  std::vector<std::unique_ptr<FrameDecoder>> candidates_;
  const FrameDecoder* calling_ = nullptr;
};

}  // namespace

void FrameDecoder::NameColumns(std::vector<std::string> names) {
  columns_.number.reset();
  columns_.time.clear();
  time_without_unit_.reset();
  clock_.Restart();
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string& name = names[i];
    if (!TextProblem(name).empty()) name = OneLine(name);
    const std::optional<double> scale_s = TimeScaleS(name);
    const bool has_time = !columns_.time.empty() || time_without_unit_;
    const bool goes_on = columns_.time.size() == 1 && columns_.time[0].column + 1 == i &&
                         columns_.time[0].scale_s == 1.0 && scale_s == kNanosecond_s;
    if (scale_s && !has_time && SenderClock::NeedsUnit(name)) {
      time_without_unit_ = i;
    } else if (scale_s && (!has_time || goes_on)) {
      columns_.time.push_back({.column = i, .scale_s = *scale_s});
    }
    if (!columns_.number && IsSampleNumber(name)) columns_.number = i;
  }
  columns_.names = std::move(names);
  ++columns_.version;
}

void FrameDecoder::Emit(std::span<double> values, std::int64_t arrival_ns,
                        const FrameReceiver& receive) {
  if (time_without_unit_) {
    if (const auto scale_s = clock_.Add(values[*time_without_unit_], arrival_ns)) {
      columns_.time = {{.column = *time_without_unit_, .scale_s = *scale_s}};
      time_without_unit_.reset();
      ++columns_.version;
    }
  }
  ++counts_.frames;
  receive(FrameOf(columns_, values, arrival_ns));
}

void FrameDecoder::Emit(DeviceFrame frame, std::span<double> values, const FrameReceiver& receive) {
  ++counts_.frames;
  for (double& value : values) value = std::isfinite(value) ? value : kMissing;
  frame.values = values;
  receive(frame);
}

DeviceFrame FrameOf(const DeviceColumns& columns, std::span<double> values,
                    std::int64_t arrival_ns) {
  for (double& value : values) value = std::isfinite(value) ? value : kMissing;
  DeviceFrame frame{.arrival_ns = arrival_ns, .values = values};
  if (columns.number) frame.number = WholeNumber(values[*columns.number]);
  frame.sender_time_ns = SenderTime_ns(columns, values);
  return frame;
}

std::unique_ptr<FrameDecoder> MakeFrameDecoder(FrameFormat format, ByteFlow flow,
                                               const std::string& osc_address) {
  switch (format) {
    case FrameFormat::kCsv:
    case FrameFormat::kLabels:
    case FrameFormat::kAlpha:
    case FrameFormat::kJson:
      return std::make_unique<TextFrames>(format, flow);
    case FrameFormat::kBinary:
      return std::make_unique<BinaryFrames>();
    case FrameFormat::kCyberglove:
      return std::make_unique<CybergloveFrames>(CybergloveFrames::Mode::kPoll);
    case FrameFormat::kCybergloveStream:
      return std::make_unique<CybergloveFrames>(CybergloveFrames::Mode::kStream);
    case FrameFormat::kOsc:
      return std::make_unique<OscFrames>(osc_address);
    case FrameFormat::kDetect:
      break;
  }
  std::vector<std::unique_ptr<FrameDecoder>> candidates;
  candidates.push_back(std::make_unique<BinaryFrames>());
  if (flow == ByteFlow::kPackets) candidates.push_back(std::make_unique<OscFrames>(osc_address));
  candidates.push_back(std::make_unique<TextFrames>(format, flow));
  return std::make_unique<DetectingDecoder>(std::move(candidates));
}

}  // namespace gauntlet::sim
