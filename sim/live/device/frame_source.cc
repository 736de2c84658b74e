#include "sim/live/device/frame_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/live/device/byte_device.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/device/frame_decoder.h"
#include "sim/recordings/table_source.h"
#include "sim/recordings/time_guess.h"
#include "sim/tables/recording_problem.h"
#include "sim/tables/table_layout.h"
#include "sim/tables/time_columns.h"

namespace gauntlet::sim {
namespace {

class RecordingSource : public FrameSource {
 public:
  RecordingSource(const DeviceAddress& address, const SourceOptions& options)
      : address_(address),
        options_(options),
        table_(FindTable(address.path, TableSource(address.path, options.file_array),
                         ProblemHandling::kRepair,
                         [this](RecordingProblem problem, std::size_t row) {
                           if (!NeedsRepair(problem) || row == damaged_row_) return;
                           damaged_row_ = row;
                           ++counts_.garbage;
                         })) {
    const TableLayout& layout = table_.layout;
    columns_.count = layout.columns;
    columns_.names = layout.names;
    columns_.version = 1;
    const auto number = std::ranges::find_if(layout.names, IsSampleNumber);
    if (number != layout.names.end()) columns_.number = number - layout.names.begin();
    columns_.time = TimeByName(table_.reader.name(), layout, options.file_time_unit);
    for (const TimeMapping& time : columns_.time) {
      if (time.is_text) table_.reader.ReadAsTime(time.column);
    }
    for (std::size_t c = 0; c < layout.columns; ++c) {
      if (KindOf(layout, c) == CellKind::kText) table_.reader.Ignore(c);
    }
    values_.resize(layout.columns);
    const bool has_time = !columns_.time.empty();
    if (options.is_paced && !has_time && !(options.file_rate_hz > 0.0)) {
      throw UserError(
          {.place = address.path,
           .problem = "has no column of time (as time_s); --rate HZ gives the rows per second"});
    }
  }

  State Wait(std::chrono::nanoseconds timeout, const FrameReceiver& receive) override {
    if (has_ended_) return State::kEnded;
    const std::int64_t end_ns = MonotonicNow_ns() + timeout.count();
    if (!has_row_ && !ReadRow()) return State::kEnded;
    if (due_ns_ > end_ns) {
      SleepUntil(end_ns);
      return State::kOpen;
    }
    SleepUntil(due_ns_);
    // Without pacing all rows are due: a part of them, so that the caller can stop.
    constexpr int kMostRows = 1000;
    for (int i = 0; i < kMostRows && has_row_ && due_ns_ <= MonotonicNow_ns(); ++i) {
      has_row_ = false;
      ++counts_.frames;
      receive(FrameOf(columns_, values_, options_.is_paced ? due_ns_ : MonotonicNow_ns()));
      if (!ReadRow()) return State::kEnded;
    }
    return State::kOpen;
  }

  const DeviceColumns& columns() const override { return columns_; }
  SourceCounts counts() const override { return counts_; }
  std::string problem() const override { return {}; }
  std::string Description() const override { return Shown(address_.text); }

 protected:
  const DeviceAddress& address() const override { return address_; }

 private:
  /// The next row and the time at which it is due.
  bool ReadRow() {
    has_row_ = table_.reader.NextRow(values_);
    if (!has_row_) {
      has_ended_ = true;
      return false;
    }
    if (!options_.is_paced) return true;
    const std::int64_t now_ns = MonotonicNow_ns();
    if (options_.file_rate_hz > 0.0) {
      if (rows_ == 0) start_ns_ = now_ns;
      due_ns_ = start_ns_ + std::llround(static_cast<double>(rows_) / options_.file_rate_hz * 1e9);
    } else {
      // A time that is missing, stands still, goes back or jumps far is due with the row before it.
      constexpr double kLongestGap_s = 10.0;
      double time_s = 0.0;
      for (const TimeMapping& part : columns_.time) time_s += values_[part.column] * part.scale_s;
      const double step_s = rows_ == 0 ? 0.0 : time_s - last_time_s_;
      if (rows_ == 0) due_ns_ = now_ns;
      if (step_s > 0.0 && step_s < kLongestGap_s) due_ns_ += std::llround(step_s * 1e9);
      if (std::isfinite(time_s)) last_time_s_ = time_s;
    }
    ++rows_;
    return true;
  }

  static void SleepUntil(std::int64_t time_ns) {
    const timespec until{.tv_sec = time_ns / kNanosecondsPerSecond,
                         .tv_nsec = time_ns % kNanosecondsPerSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
  }

  DeviceAddress address_;
  SourceOptions options_;
  SourceCounts counts_;
  std::size_t damaged_row_ = 0;  // the last one, a line of the file
  FoundTable table_;
  DeviceColumns columns_;
  std::vector<double> values_;
  bool has_row_ = false;
  bool has_ended_ = false;
  std::int64_t rows_ = 0;
  std::int64_t start_ns_ = 0;
  std::int64_t due_ns_ = 0;
  double last_time_s_ = 0.0;
};

/// The rows of a recording as frames, at the times of its time column or at a rate. The formats are
/// those of TableSource().
/// Errors: UserError of the file; one if it has neither a time nor a rate.
std::unique_ptr<FrameSource> OpenRecordingSource(const DeviceAddress& address,
                                                 const SourceOptions& options) {
  return std::make_unique<RecordingSource>(address, options);
}

/// A device and the decoder of its bytes.
class DecodedSource : public FrameSource {
 public:
  DecodedSource(DeviceAddress address, std::unique_ptr<ByteDevice> device)
      : address_(std::move(address)),
        device_(std::move(device)),
        decoder_(MakeFrameDecoder(address_.format, device_->flow(), address_.osc_address)) {}
  ~DecodedSource() override {
    if (const std::string farewell = decoder_->Farewell(); !farewell.empty()) {
      device_->Write(farewell);
    }
  }

  State Wait(std::chrono::nanoseconds timeout, const FrameReceiver& receive) override {
    if (const std::string request = decoder_->Request(MonotonicNow_ns()); !request.empty()) {
      device_->Write(request);
    }
    const auto take = [&](const ArrivedBytes& arrived) {
      if (device_->counts().reopened != reopened_) {
        reopened_ = device_->counts().reopened;
        decoder_->Restart();
      }
      constexpr std::size_t kShown = 24;
      beginning_ += arrived.bytes.substr(0, kShown - std::min(kShown, beginning_.size()));
      decoder_->Decode(arrived.bytes, arrived.arrival_ns, receive);
      if (device_->flow() == ByteFlow::kPackets) decoder_->EndPacket(arrived.arrival_ns, receive);
    };
    const State state = device_->Wait(timeout, take);
    if (state != State::kOpen) decoder_->Restart();
    return state;
  }

  const DeviceColumns& columns() const override { return decoder_->columns(); }
  SourceCounts counts() const override {
    SourceCounts counts = decoder_->counts();
    const SourceCounts& of_device = device_->counts();
    counts.foreign = of_device.foreign;
    counts.overflowed = of_device.overflowed;
    counts.reopened = of_device.reopened;
    counts.bytes = of_device.bytes;
    return counts;
  }
  std::string problem() const override {
    return device_->problem().empty() ? decoder_->problem() : device_->problem();
  }
  std::string Description() const override {
    const FrameFormat format = decoder_->format();
    const std::string facts = device_->Facts();
    return fmt::format("{}{}{}", Shown(address_.text),
                       format == FrameFormat::kDetect ? "" : fmt::format(", {}", WordOf(format)),
                       facts.empty() ? "" : ", " + facts);
  }

 protected:
  const DeviceAddress& address() const override { return address_; }

 private:
  std::string Beginning() const override { return beginning_; }

  DeviceAddress address_;
  std::string beginning_;
  std::unique_ptr<ByteDevice> device_;
  std::unique_ptr<FrameDecoder> decoder_;
  std::uint64_t reopened_ = 0;
};

}  // namespace

std::string FrameSource::AdviceWithoutFrames() const {
  const SourceCounts counted = counts();
  const DeviceAddress& at = address();
  const bool is_serial = at.kind == DeviceKind::kSerial;
  if (counted.bytes == 0) {
    std::string advice = "nothing arrives: ";
    if (is_serial) {
      advice += "is the glove switched on, and is this its port?";
    } else if (at.kind == DeviceKind::kUdp || at.kind == DeviceKind::kOsc) {
      advice += fmt::format(
          "does the sender send to this machine, port {}, and does a firewall "
          "let it in? 0.0.0.0 as host takes packets from other machines",
          at.port);
    } else {
      advice += "does the program on the left of the pipe write at once (stdbuf -oL)?";
    }
    return advice;
  }
  const std::string reason = problem();
  return fmt::format(
      "{} bytes arrived, and none is a frame{}; they begin with '{}'; try {}a format behind a "
      "comma, "
      "as {},csv",
      counted.bytes, reason.empty() ? "" : fmt::format(" ({})", reason), Shown(Beginning()),
      is_serial ? "another baud rate behind @, or " : "", Shown(at.text));
}

std::unique_ptr<FrameSource> OpenFrameSource(const DeviceAddress& address,
                                             const SourceOptions& options) {
  switch (address.kind) {
    case DeviceKind::kFile:
      return OpenRecordingSource(address, options);
    case DeviceKind::kStdin:
      return std::make_unique<DecodedSource>(address, OpenStandardInput());
    case DeviceKind::kUdp:
    case DeviceKind::kOsc:
      return std::make_unique<DecodedSource>(address, OpenUdpListener(address));
    case DeviceKind::kSerial:
      return std::make_unique<DecodedSource>(address, OpenSerialPort(address));
    case DeviceKind::kNone:
    case DeviceKind::kStdout:
      break;
  }
  throw UserError({.place = Shown(address.text), .problem = "is no source of frames"});
}

}  // namespace gauntlet::sim
