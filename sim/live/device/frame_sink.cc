#include "sim/live/device/frame_sink.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/csv_line.h"
#include "sim/base/descriptor.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/text.h"
#include "sim/live/device/address.h"
#include "sim/live/device/binary_frames.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/device/osc_packet.h"
#include "sim/live/device/serial_line.h"
#include "sim/live/device/udp_socket.h"

namespace gauntlet::sim {
namespace {

/// Makes bytes of frames: the inverse of FrameDecoder.
class FrameEncoder {
 public:
  virtual ~FrameEncoder() = default;

  /// Bytes that name the values; empty in a format without names.
  virtual std::string Names() const { return {}; }
  virtual std::string Frame(const OutgoingFrame& frame) const = 0;
};

constexpr std::int64_t kNamesPeriod_ns = kNanosecondsPerSecond;
constexpr std::string_view kNumberColumn = "frame";
constexpr std::string_view kTimeColumn = "time_s";

/// Seconds with all nanoseconds.
std::string TimeText(std::int64_t time_ns) {
  return fmt::format("{}.{:09}", time_ns / kNanosecondsPerSecond, time_ns % kNanosecondsPerSecond);
}

class CsvEncoder : public FrameEncoder {
 public:
  explicit CsvEncoder(std::vector<std::string> names) {
    names.insert(names.begin(), {std::string(kNumberColumn), std::string(kTimeColumn)});
    header_ = CsvLine(names);
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

/// As programs for serial plotters have them: no number and no time.
class LabelsEncoder : public FrameEncoder {
 public:
  explicit LabelsEncoder(std::vector<std::string> names) : names_(std::move(names)) {}

  std::string Frame(const OutgoingFrame& frame) const override {
    std::string line;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string value = NumberOrNothing(frame.values[i]);
      line += fmt::format("{}{}:{}", i > 0 ? " " : "", names_[i], value.empty() ? "nan" : value);
    }
    return line + "\n";
  }

 private:
  std::vector<std::string> names_;
};

class JsonEncoder : public FrameEncoder {
 public:
  explicit JsonEncoder(std::vector<std::string> names) : names_(std::move(names)) {}

  std::string Frame(const OutgoingFrame& frame) const override {
    Json object;
    object[std::string(kNumberColumn)] = frame.number;
    object[std::string(kTimeColumn)] = static_cast<double>(frame.time_ns) / 1e9;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      object[names_[i]] = NumberOrNull(frame.values[i]);
    }
    return object.dump(-1, Json::InvalidText::kReplaced) + "\n";
  }

 private:
  std::vector<std::string> names_;
};

class BinaryEncoder : public FrameEncoder {
 public:
  explicit BinaryEncoder(const std::vector<std::string>& names) : names_(BinaryNames(names)) {}

  std::string Names() const override { return names_; }
  std::string Frame(const OutgoingFrame& frame) const override { return BinaryFrame(frame); }

 private:
  std::string names_;
};

/// One message with all values; below an address that ends with a slash one message for each, in a
/// bundle.
class OscEncoder : public FrameEncoder {
 public:
  OscEncoder(std::string address, const std::vector<std::string>& names)
      : address_(std::move(address)) {
    if (!address_.ends_with('/')) return;
    for (std::string name : names) {
      const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0; };
      std::ranges::replace_if(name, std::not_fn(is_plain), '_');
      messages_.push_back({.address = address_ + name, .numbers = {}});
    }
  }

  std::string Frame(const OutgoingFrame& frame) const override {
    if (messages_.empty()) {
      return OscMessageBytes(address_, {frame.values.begin(), frame.values.end()});
    }
    std::vector<OscMessage> messages = messages_;
    for (std::size_t i = 0; i < messages.size(); ++i) messages[i].numbers = {frame.values[i]};
    return OscBundleBytes(messages);
  }

 private:
  std::string address_;
  std::vector<OscMessage> messages_;
};

/// Errors: UserError for a format that cannot be written, or not with these names.
std::unique_ptr<FrameEncoder> MakeFrameEncoder(const DeviceAddress& address,
                                               const std::vector<std::string>& names) {
  switch (address.format) {
    case FrameFormat::kDetect:
    case FrameFormat::kCsv:
      return std::make_unique<CsvEncoder>(names);
    case FrameFormat::kLabels:
      return std::make_unique<LabelsEncoder>(names);
    case FrameFormat::kJson:
      return std::make_unique<JsonEncoder>(names);
    case FrameFormat::kBinary:
      return std::make_unique<BinaryEncoder>(names);
    case FrameFormat::kOsc:
      return std::make_unique<OscEncoder>(
          address.osc_address.empty() ? "/gauntlet" : address.osc_address, names);
    case FrameFormat::kAlpha:
    case FrameFormat::kCyberglove:
    case FrameFormat::kCybergloveStream:
      break;
  }
  throw UserError({.place = Shown(address.text),
                   .problem = fmt::format("{} is only received; csv, labels, json and binary are "
                                          "sent",
                                          WordOf(address.format))});
}

class CountingSink : public FrameSink {
 public:
  explicit CountingSink(std::string description) : description_(std::move(description)) {}

  SinkCounts counts() const override { return counts_; }
  std::string problem() const override { return problem_; }
  std::string Description() const override { return description_; }

 protected:
  Result Count(Result result, std::size_t bytes) {
    if (result == Result::kSent) {
      ++counts_.frames;
      counts_.bytes += bytes;
    }
    if (result == Result::kDropped) ++counts_.dropped;
    if (result == Result::kGone) ++counts_.failed;
    return result;
  }
  Result Failed(int error) {
    problem_ = std::strerror(error);
    return Count(Result::kGone, 0);
  }

 private:
  SinkCounts counts_;
  std::string problem_;
  std::string description_;
};

class NoSink : public CountingSink {
 public:
  using CountingSink::CountingSink;
  Result Send(const OutgoingFrame& /*frame*/) override { return Count(Result::kSent, 0); }
};

class UdpSink : public CountingSink {
 public:
  UdpSink(const DeviceAddress& address, std::unique_ptr<FrameEncoder> encoder)
      : CountingSink(Shown(address.text)),
        to_(FindSocketAddress(address)),
        socket_(::socket(to_.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)),
        encoder_(std::move(encoder)) {
    const int on = 1;
    setsockopt(socket_.get(), SOL_SOCKET, SO_BROADCAST, &on, sizeof on);
    // A connected socket is told that nothing listens there.
    if (connect(socket_.get(), reinterpret_cast<const sockaddr*>(&to_.storage), to_.size) != 0) {
      throw UserError({.place = Shown(address.text), .problem = std::strerror(errno)});
    }
  }

  Result Send(const OutgoingFrame& frame) override {
    const std::int64_t now_ns = MonotonicNow_ns();
    if (now_ns >= names_due_ns_) {
      const std::string names = encoder_->Names();
      if (!names.empty()) send(socket_.get(), names.data(), names.size(), MSG_NOSIGNAL);
      names_due_ns_ = now_ns + kNamesPeriod_ns;
    }
    const std::string bytes = encoder_->Frame(frame);
    if (send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) >= 0) {
      return Count(Result::kSent, bytes.size());
    }
    if (errno == EAGAIN || errno == ENOBUFS) return Count(Result::kDropped, 0);
    return Failed(errno);
  }

 private:
  SocketAddress to_;
  Descriptor socket_;
  std::unique_ptr<FrameEncoder> encoder_;
  std::int64_t names_due_ns_ = 0;
};

/// Frames as a stream of bytes. If only a part of a frame found room, its rest goes first, and
/// frames meanwhile are dropped, so that none of them grows old.
class StreamSink : public CountingSink {
 public:
  StreamSink(std::string description, std::unique_ptr<FrameEncoder> encoder,
             bool repeats_names = false)
      : CountingSink(std::move(description)),
        encoder_(std::move(encoder)),
        rest_(encoder_->Names()),
        names_due_ns_(repeats_names ? MonotonicNow_ns() + kNamesPeriod_ns
                                    : std::numeric_limits<std::int64_t>::max()) {}

  Result Send(const OutgoingFrame& frame) override {
    if (is_gone_ && !Return()) return Count(Result::kGone, 0);
    if (const int error = WriteRest(); error != 0) return Lose(error);
    if (!rest_.empty()) return Count(Result::kDropped, 0);
    if (const std::int64_t now_ns = MonotonicNow_ns(); now_ns >= names_due_ns_) {
      rest_ = encoder_->Names();
      names_due_ns_ = now_ns + kNamesPeriod_ns;
    }
    rest_ += encoder_->Frame(frame);
    const std::size_t size = rest_.size();
    if (const int error = WriteRest(); error != 0) return Lose(error);
    if (rest_.size() < size) return Count(Result::kSent, size);
    rest_.clear();
    return Count(Result::kDropped, 0);
  }

 protected:
  virtual int descriptor() const = 0;
  /// Opens a device again that was gone. False: it still is.
  virtual bool Reopen() { return false; }
  virtual void Close() {}

 private:
  bool Return() {
    if (!Reopen()) return false;
    is_gone_ = false;
    rest_ = encoder_->Names();
    return true;
  }
  Result Lose(int error) {
    is_gone_ = true;
    Close();
    return Failed(error);
  }

  /// Writes as much as there is room for; returns the system's error, 0 if none.
  int WriteRest() {
    while (!rest_.empty()) {
      // A pipe that is ready takes a page without waiting; O_NONBLOCK would also change the
      // terminal of the shell.
      constexpr std::size_t kPage = 4096;
      pollfd ready{.fd = descriptor(), .events = POLLOUT, .revents = 0};
      const int count = poll(&ready, 1, 0);
      if (count == 0 || (count < 0 && errno == EINTR)) return 0;
      if ((ready.revents & (POLLERR | POLLHUP)) != 0) return EPIPE;
      const ssize_t wrote = write(descriptor(), rest_.data(), std::min(rest_.size(), kPage));
      if (wrote < 0) return errno == EAGAIN || errno == EINTR ? 0 : errno;
      rest_.erase(0, static_cast<std::size_t>(wrote));
    }
    return 0;
  }

  std::unique_ptr<FrameEncoder> encoder_;
  std::string rest_;  // bytes of a frame that wait for room
  std::int64_t names_due_ns_;
  bool is_gone_ = false;
};

class StandardOutput : public StreamSink {
 public:
  using StreamSink::StreamSink;

 protected:
  int descriptor() const override { return STDOUT_FILENO; }
};

class SerialSink : public StreamSink {
 public:
  SerialSink(const DeviceAddress& address, std::unique_ptr<FrameEncoder> encoder,
             bool repeats_names)
      : StreamSink(Shown(address.text), std::move(encoder), repeats_names), line_(address) {}

  std::string Description() const override {
    return fmt::format("{}, {}", StreamSink::Description(), line_.facts());
  }

 protected:
  int descriptor() const override { return line_.descriptor(); }
  bool Reopen() override { return line_.Reopen().empty(); }
  void Close() override { line_.Close(); }

 private:
  SerialLine line_;
};

}  // namespace

std::unique_ptr<FrameSink> OpenFrameSink(const DeviceAddress& address,
                                         const std::vector<std::string>& names,
                                         bool repeats_names) {
  switch (address.kind) {
    case DeviceKind::kNone:
      return std::make_unique<NoSink>(address.text);
    case DeviceKind::kStdout:
      return std::make_unique<StandardOutput>(address.text, MakeFrameEncoder(address, names));
    case DeviceKind::kSerial:
      return std::make_unique<SerialSink>(address, MakeFrameEncoder(address, names), repeats_names);
    case DeviceKind::kUdp:
    case DeviceKind::kOsc:
      return std::make_unique<UdpSink>(address, MakeFrameEncoder(address, names));
    case DeviceKind::kStdin:
    case DeviceKind::kFile:
      break;
  }
  throw UserError({.place = Shown(address.text), .problem = "is no sink of commands"});
}

}  // namespace gauntlet::sim
