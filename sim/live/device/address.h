#pragma once

#include <string>
#include <string_view>

namespace gauntlet::sim {

/// The place that frames come from or go to.
enum class DeviceKind { kStdin, kStdout, kNone, kFile, kUdp, kOsc, kSerial };

/// The form of frames as bytes. docs/reference/live-formats.md has example bytes of each.
enum class FrameFormat {
  kDetect,  // from the first bytes; what is written is CSV then
  kCsv,
  kLabels,
  kAlpha,
  kJson,
  kBinary,
  kCyberglove,        // asked for each frame
  kCybergloveStream,  // asked once
  kOsc,
};

enum class DeviceRole { kSource, kSink };

/// A parsed address:
///
///     stdin  stdout  none
///     file:PATH                          a recording of any format
///     udp:HOST:PORT                      a source listens there, a sink sends there
///     osc:PORT[/ADDRESS]                 a source: messages of this OSC address; `*` at its end
///     osc:HOST:PORT[/ADDRESS]            a sink: messages to this OSC address
///     serial:/dev/ttyUSB0[@115200]       8 data bits, no parity, 1 stop bit
///
/// Behind udp and serial, words may follow after commas: a format (csv, labels, alpha, json,
/// binary, cyberglove, cyberglove_stream), and for serial `dtr` or `nodtr`, which set that line.
struct DeviceAddress {
  DeviceKind kind = DeviceKind::kNone;
  FrameFormat format = FrameFormat::kDetect;
  std::string path = {};         // of a file or device
  std::string host = {};         // name or number
  int port = 0;                  // from 1
  std::string osc_address = {};  // with its first slash; empty: not given
  int baud = 115200;
  enum class Dtr { kAsFound, kOn, kOff } dtr = Dtr::kAsFound;
  std::string text = {};  // as it was given, for messages
};

/// Errors: UserError `TEXT: problem`, which says what is possible in this role.
DeviceAddress ParseDeviceAddress(std::string_view text, DeviceRole role);

/// Words of formats, in the order of FrameFormat. Errors: UserError that lists them.
FrameFormat ParseFrameFormat(std::string_view word);
std::string_view WordOf(FrameFormat format);

}  // namespace gauntlet::sim
