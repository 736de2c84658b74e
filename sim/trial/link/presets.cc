#include "sim/trial/link/presets.h"

#include <array>

namespace gauntlet::sim {
namespace {

TransportConfig Batches(double batch_ms, double delay_ms) {
  TransportConfig transport;
  transport.delay = {ConstantDelay{.delay_ms = delay_ms}};
  transport.batch_ms = batch_ms;
  return transport;
}

}  // namespace

std::span<const LinkPreset> LinkPresets() {
  static const std::array<LinkPreset, 6> kPresets = {
      {{.name = "none", .summary = "nothing but what is set", .source = "", .transport = {}},
       {.name = "usb_ftdi",
        .summary = "USB serial adapter, latency timer at its default of 16 ms",
        .source =
            "8 bytes there and back in 15.5 ms, 62 messages per second (arduino-robust-serial "
            "#6); 1 ms for the bytes themselves: an assumption",
        .transport = Batches(16.0, 1.0)},
       {.name = "bluetooth",
        .summary = "Bluetooth Low Energy, connection interval of 45 ms; the radio repeats what is "
                   "lost",
        .source = "a 20 ms sensor arrives as 2 to 3 samples every 45 ms (microbit-dal #300)",
        .transport = Batches(45.0, 1.0)},
       {.name = "wifi",
        .summary = "shared WiFi: p50 13.3 ms, p99 47 ms, 2 % of the frames lost in bursts of 5",
        .source = "2048 pings of an ESP32 beside its router (thexyzlab ESP32 log 01), taken as one "
                  "way: pessimistic; losses: an assumption",
        .transport = {.delay = {LogNormalDelay{.p50_ms = 13.3, .p99_ms = 47.0}},
                      .loss = {GilbertElliottLoss{.begin_percent = 0.4, .mean_frames = 5.0}}}},
       {.name = "dynamixel_bus",
        .summary = "17 servos on a Dynamixel bus of 3 Mbaud, one sync write per command frame",
        .source =
            "sync write in 0.30 ms (orcahand/orca_core, latency-optimization.md); 14 + 17 x 5 "
            "bytes take 0.33 ms",
        .transport = {.delay = {ConstantDelay{.delay_ms = 0.33}}, .loss = {}, .frame_ms = 0.33}},
       {.name = "ethercat",
        .summary = "EtherCAT, cycle of 1 ms",
        .source = "cycle jitter 3.6 to 6.3 us (OST infoportal): below a tick",
        .transport = Batches(1.0, 0.0)}}};
  return kPresets;
}

}  // namespace gauntlet::sim
