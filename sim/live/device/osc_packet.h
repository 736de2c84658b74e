#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gauntlet::sim {

/// Bytes of Open Sound Control 1.0, big-endian. Source: opensoundcontrol.stanford.edu, spec 1.0.

/// A message: its address and the numbers among its arguments.
struct OscMessage {
  std::string address;
  /// int32, int64, float, double, true (1) and false (0); nil is kMissing. Texts, blobs, times and
  /// other arguments are left out.
  std::vector<double> numbers;
};

struct OscPacket {
  std::vector<OscMessage> messages;  // of a bundle all, those of bundles in it, too
  bool is_bundle = false;
  std::optional<std::int64_t> time_ns = {};  // of the bundle, since 1970-01-01; none: at once
};

/// None if the bytes are no OSC packet, as a whole.
std::optional<OscPacket> ReadOscPacket(std::string_view bytes);

/// A message of numbers: whole ones as int32 where they fit, others as float, kMissing as nil.
std::string OscMessageBytes(std::string_view address, const std::vector<double>& numbers);
/// A bundle of such messages, to be used at once.
std::string OscBundleBytes(const std::vector<OscMessage>& messages);

}  // namespace gauntlet::sim
