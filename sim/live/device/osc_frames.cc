#include "sim/live/device/osc_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/text.h"
#include "sim/live/device/device_clock.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {
namespace {

constexpr std::size_t kLargestOscPacket = 65536;
constexpr std::size_t kMostParts = 1000;
constexpr std::size_t kMostColumns = 1024;

/// Length of the beginning that all addresses have in common, up to a slash. The last word of each
/// stays.
template <class Parts>
std::size_t CommonBeginning(const Parts& parts) {
  const std::string& first = parts.front().address;
  std::size_t common = first.size();
  for (const auto& part : parts) {
    const std::size_t same = std::ranges::mismatch(first, part.address).in1 - first.begin();
    common = std::min({common, same, std::max<std::size_t>(part.address.size(), 2) - 2});
  }
  return first.rfind('/', common) + 1;  // 0 without one
}

}  // namespace

OscFrames::OscFrames(const std::string& address)
    : prefix_(address.substr(0, address.find('*'))),
      is_exact_(!address.empty() && !address.ends_with('*')) {}

void OscFrames::Restart() { packet_.clear(); }

void OscFrames::Decode(std::string_view bytes, std::int64_t /*arrival_ns*/,
                       const FrameReceiver& /*receive*/) {
  packet_.append(bytes.substr(0, kLargestOscPacket - packet_.size()));
}

bool OscFrames::IsWanted(const OscMessage& message) const {
  if (message.numbers.empty() || message.numbers.size() > kMostColumns) return false;
  return is_exact_ ? message.address == prefix_ : message.address.starts_with(prefix_);
}

void OscFrames::EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) {
  std::optional<OscPacket> packet = ReadOscPacket(std::exchange(packet_, {}));
  if (!packet) {
    CountGarbage("a packet is no OSC");
    return;
  }
  std::erase_if(packet->messages, [this](const OscMessage& message) { return !IsWanted(message); });
  if (packet->messages.empty()) {
    problem_ = prefix_.empty() ? "no message has a number"
                               : fmt::format("no message of {} has a number", Shown(prefix_));
    return;
  }
  if (parts_.empty()) {
    Learn(*packet, arrival_ns, receive);
  } else {
    Fill(*packet, arrival_ns, receive);
  }
}

// --- Parts ---------------------------------------------------------------------------------------

bool OscFrames::EndLearned() {
  const bool agrees = learned_ == learned_before_;
  learned_before_ = std::exchange(learned_, {});
  return agrees;
}

/// Messages alone of several addresses, of which none was asked for: they may be frames of several
/// devices.
void OscFrames::RefuseSeveral(const OscPacket& packet) {
  if (!prefix_.empty() || packet.is_bundle) return;
  const std::string& address = packet.messages.front().address;
  if (only_address_.empty()) only_address_ = address;
  if (only_address_ == address) return;
  throw UserError(fmt::format(
      "OSC messages of several addresses arrive ({}, {}): name one behind the port, as osc:9000{}, "
      "or all that begin alike, as osc:9000/*",
      Shown(only_address_), Shown(address), Shown(only_address_)));
}

void OscFrames::Learn(const OscPacket& packet, std::int64_t arrival_ns,
                      const FrameReceiver& receive) {
  if (waiting_.size() == kMostParts) waiting_.erase(waiting_.begin());
  waiting_.push_back({packet, arrival_ns});
  RefuseSeveral(packet);
  bool is_known = false;
  for (const OscMessage& message : packet.messages) {
    const Part part{.address = message.address, .count = message.numbers.size()};
    const auto same = std::ranges::find(learned_, part.address, &Part::address);
    if (same != learned_.end()) is_known = EndLearned() || is_known;
    learned_.push_back(part);
  }
  if (packet.is_bundle && !learned_.empty()) is_known = EndLearned() || is_known;
  problem_ = "no two frames in a row have the same addresses";
  constexpr std::int64_t kTimeForOthers_ns = kNanosecondsPerSecond / 5;
  const bool may_have_others =
      !only_address_.empty() && arrival_ns - waiting_.front().arrival_ns < kTimeForOthers_ns;
  if (!is_known || may_have_others) return;
  problem_.clear();
  FixParts();
  for (const Arrived& arrived : std::exchange(waiting_, {})) {
    Fill(arrived.packet, arrived.arrival_ns, receive);
  }
}

void OscFrames::FixParts() {
  parts_ = learned_before_;
  const std::size_t common = CommonBeginning(parts_);
  std::vector<std::string> names;
  for (Part& part : parts_) {
    part.column = names.size();
    std::string name = part.address.substr(common);
    std::ranges::replace(name, '/', '_');
    for (std::size_t i = 1; i <= part.count; ++i) {
      names.push_back(part.count == 1 ? name : fmt::format("{}_{}", name, i));
    }
  }
  columns_.count = names.size();
  NameColumns(std::move(names));
  values_.assign(columns_.count, kMissing);
}

// --- Frames --------------------------------------------------------------------------------------

void OscFrames::Fill(const OscPacket& packet, std::int64_t arrival_ns,
                     const FrameReceiver& receive) {
  for (const OscMessage& message : packet.messages) {
    const auto part = std::ranges::find(parts_, message.address, &Part::address);
    if (part == parts_.end()) continue;
    if (part->count != message.numbers.size()) {
      CountGarbage(fmt::format("a message has {} numbers, the first one {}", message.numbers.size(),
                               part->count));
      continue;
    }
    // A part that comes again before all were there: a frame that lost some.
    if (part->is_filled) EmitFilled(last_arrival_ns_, receive);
    std::ranges::copy(message.numbers, values_.begin() + static_cast<std::ptrdiff_t>(part->column));
    part->is_filled = true;
    last_arrival_ns_ = arrival_ns;
    time_ns_ = packet.time_ns;
    if (std::ranges::all_of(parts_, &Part::is_filled)) EmitFilled(arrival_ns, receive);
  }
  const bool ends = packet.is_bundle && std::ranges::any_of(parts_, &Part::is_filled);
  if (ends) EmitFilled(arrival_ns, receive);
}

void OscFrames::EmitFilled(std::int64_t arrival_ns, const FrameReceiver& receive) {
  for (Part& part : parts_) part.is_filled = false;
  DeviceFrame frame{.arrival_ns = arrival_ns, .sender_time_ns = time_ns_};
  Emit(frame, values_, receive);
  std::ranges::fill(values_, kMissing);
}

}  // namespace gauntlet::sim
