#include "sim/live/device/address.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "controller/number.h"
#include "sim/base/error.h"
#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 9> kFormats = {
    "detect", "csv", "labels", "alpha", "json", "binary", "cyberglove", "cyberglove_stream", "osc"};
constexpr int kLargestPort = 65535;

const char* Forms(DeviceRole role) {
  return role == DeviceRole::kSource
             ? "stdin, file:PATH, udp:HOST:PORT, osc:PORT/ADDRESS or serial:/dev/NAME@BAUD"
             : "stdout, none, udp:HOST:PORT, osc:HOST:PORT/ADDRESS or serial:/dev/NAME@BAUD";
}

[[noreturn]] void Fail(const DeviceAddress& address, const std::string& problem) {
  throw UserError({.place = Shown(address.text), .problem = problem});
}

std::optional<FrameFormat> FormatNamed(std::string_view word) {
  const auto found = std::ranges::find(kFormats, word);
  if (found == kFormats.end()) return std::nullopt;
  return static_cast<FrameFormat>(found - kFormats.begin());
}

/// Takes the words behind commas.
std::string_view ParseWords(std::string_view text, DeviceAddress& address) {
  const std::size_t comma = text.find(',');
  std::string_view words = comma == std::string_view::npos ? "" : text.substr(comma + 1);
  for (; comma != std::string_view::npos;) {
    const std::string_view word = words.substr(0, words.find(','));
    const bool is_serial = address.kind == DeviceKind::kSerial;
    if (const auto format = FormatNamed(word)) {
      address.format = *format;
    } else if (is_serial && (word == "dtr" || word == "nodtr")) {
      address.dtr = word == "dtr" ? DeviceAddress::Dtr::kOn : DeviceAddress::Dtr::kOff;
    } else {
      std::vector<std::string> known(kFormats.begin(), kFormats.end());
      if (is_serial) known.insert(known.end(), {"dtr", "nodtr"});
      Fail(address,
           fmt::format("{} is not a word of this address{}", Shown(word), Suggestion(word, known)));
    }
    if (word.size() == words.size()) break;
    words.remove_prefix(word.size() + 1);
  }
  return text.substr(0, comma);
}

int PortIn(std::string_view text, const DeviceAddress& address) {
  const auto port = controller::ParseWholeNumber(text, 1, kLargestPort);
  if (!port) {
    Fail(address, fmt::format("the port is {}, must be 1 to {}",
                              text.empty() ? "missing" : Shown(text), kLargestPort));
  }
  return static_cast<int>(*port);
}

/// `HOST:PORT`, `[HOST]:PORT` or, if the host may be missing, `PORT`.
void ParseHostAndPort(std::string_view text, bool needs_host, DeviceAddress& address) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos && needs_host) {
    Fail(address, "has no host: 127.0.0.1 is this machine, as in udp:127.0.0.1:9000");
  }
  if (colon != std::string_view::npos) {
    std::string_view host = text.substr(0, colon);
    if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
    address.host = host;
    text.remove_prefix(colon + 1);
    if (address.host.empty()) Fail(address, "the host is empty: 127.0.0.1 is this machine");
  }
  address.port = PortIn(text, address);
}

void ParseOsc(std::string_view text, DeviceRole role, DeviceAddress& address) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  address.osc_address = text.substr(slash);
  ParseHostAndPort(text.substr(0, slash), role == DeviceRole::kSink, address);
  address.format = FrameFormat::kOsc;
  const std::string_view name = address.osc_address;
  const bool ends_with_star = name.ends_with('*') && role == DeviceRole::kSource;
  const std::string_view plain = name.substr(0, name.size() - (ends_with_star ? 1 : 0));
  if (plain.find_first_of(" #*,?[]{}") != std::string_view::npos) {
    Fail(address, "an OSC address contains none of ' #*,?[]{}'; of a source, * may be its end");
  }
  if (address.host.empty()) address.host = "0.0.0.0";
}

void ParseSerial(std::string_view text, DeviceAddress& address) {
  const std::size_t at = text.rfind('@');
  if (at != std::string_view::npos) {
    const auto baud = controller::ParseWholeNumber(text.substr(at + 1), 1, 10'000'000);
    if (!baud) Fail(address, fmt::format("{} is no baud rate", Shown(text.substr(at + 1))));
    address.baud = static_cast<int>(*baud);
    text = text.substr(0, at);
  }
  if (text.empty()) Fail(address, "has no device, such as serial:/dev/ttyUSB0");
  address.path = text;
}

}  // namespace

FrameFormat ParseFrameFormat(std::string_view word) {
  if (const auto format = FormatNamed(word)) return *format;
  throw UserError(fmt::format("{} is not a format{}", Shown(word),
                              Suggestion(word, {kFormats.begin(), kFormats.end()})));
}

std::string_view WordOf(FrameFormat format) {
  return kFormats.at(static_cast<std::size_t>(format));
}

DeviceAddress ParseDeviceAddress(std::string_view text, DeviceRole role) {
  DeviceAddress address{.text = std::string(text)};
  const bool is_source = role == DeviceRole::kSource;
  const std::size_t colon = text.find(':');
  const std::string_view word = text.substr(0, colon);
  const std::string_view rest = colon == std::string_view::npos ? "" : text.substr(colon + 1);
  const bool has_rest = colon != std::string_view::npos;
  if (is_source && text == "stdin") {
    address.kind = DeviceKind::kStdin;
  } else if (!is_source && text == "stdout") {
    address.kind = DeviceKind::kStdout;
  } else if (!is_source && text == "none") {
    address.kind = DeviceKind::kNone;
  } else if (is_source && word == "file" && has_rest) {
    address.kind = DeviceKind::kFile;
    address.path = rest;
    if (rest.empty()) Fail(address, "has no path");
  } else if (word == "udp" && has_rest) {
    address.kind = DeviceKind::kUdp;
    ParseHostAndPort(ParseWords(rest, address), true, address);
  } else if (word == "osc" && has_rest) {
    address.kind = DeviceKind::kOsc;
    ParseOsc(rest, role, address);
  } else if (word == "serial" && has_rest) {
    address.kind = DeviceKind::kSerial;
    ParseSerial(ParseWords(rest, address), address);
  } else {
    Fail(address, fmt::format("is no {}: {}", is_source ? "source of frames" : "sink of commands",
                              Forms(role)));
  }
  return address;
}

}  // namespace gauntlet::sim
