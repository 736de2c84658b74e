#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/live/device/frame_decoder.h"
#include "sim/live/device/osc_packet.h"

namespace gauntlet::sim {

/// Frames of OSC packets.
///
/// With an address, such as `/glove/right`, each of its messages is a frame. With `*` at its end,
/// such as `/glove/*`, the messages that begin so are parts of a frame: those of one bundle, or
/// those up to the next one of the same address. A part that is lost has missing values. Without an
/// address the same holds for all messages of bundles; messages that are no bundles must then have
/// one address for the first 200 ms.
///
/// The parts of frames are those of the first two frames that agree; later messages of other
/// addresses are passed over. Columns are called as the address below what all have in common,
/// numbered from 1 if it has several numbers: `/glove/thumb` and `/glove/index` give `thumb`,
/// `index`.
class OscFrames : public FrameDecoder {
 public:
  explicit OscFrames(const std::string& address);

  void Decode(std::string_view bytes, std::int64_t arrival_ns,
              const FrameReceiver& receive) override;
  void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) override;
  void Restart() override;
  FrameFormat format() const override { return FrameFormat::kOsc; }

 private:
  struct Part {
    std::string address;
    std::size_t count = 0;
    std::size_t column = 0;  // the first of `count`
    bool is_filled = false;

    bool operator==(const Part& other) const {
      return address == other.address && count == other.count;
    }
  };
  struct Arrived {
    OscPacket packet;
    std::int64_t arrival_ns = 0;
  };

  bool IsWanted(const OscMessage& message) const;
  /// Errors: UserError that lists two addresses.
  void RefuseSeveral(const OscPacket& packet);
  void Learn(const OscPacket& packet, std::int64_t arrival_ns, const FrameReceiver& receive);
  /// A frame of the packets so far ends: true if it has the parts of the one before it.
  bool EndLearned();
  void FixParts();
  void Fill(const OscPacket& packet, std::int64_t arrival_ns, const FrameReceiver& receive);
  void EmitFilled(std::int64_t arrival_ns, const FrameReceiver& receive);

  std::string prefix_;
  bool is_exact_;
  std::string packet_;
  std::vector<Part> parts_;  // in their order; empty: not known
  std::vector<Part> learned_;
  std::vector<Part> learned_before_;
  std::vector<Arrived> waiting_;  // until the parts are known
  std::string only_address_;      // of messages that are no bundles, if none was asked for
  std::vector<double> values_;
  std::int64_t last_arrival_ns_ = 0;
  std::optional<std::int64_t> time_ns_;
};

}  // namespace gauntlet::sim
