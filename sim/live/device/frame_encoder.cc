#include "sim/live/device/frame_encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "sim/base/csv_line.h"
#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/text.h"
#include "sim/live/device/binary_frames.h"
#include "sim/live/device/device_clock.h"
#include "sim/live/device/osc_packet.h"

namespace gauntlet::sim {
namespace {

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
    object[std::string(kTimeColumn)] = static_cast<double>(frame.time_ns) * 1e-9;
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

}  // namespace

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

}  // namespace gauntlet::sim
