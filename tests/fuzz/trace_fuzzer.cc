// What the helper process that reads `trace.h5` sends: the program itself reads no HDF5, and
// believes nothing of what comes.
#include <algorithm>
#include <cstdlib>

#include "sim/base/error.h"
#include "sim/trial/trace_reader.h"
#include "sim/trial/trace_signals.h"
#include "tests/fuzz/edited_copy.h"

namespace gauntlet::sim {
namespace {

constexpr std::uintmax_t kFileBytes = 100'000;

/// A good one: two channels, two joints, three ticks, a labelled part, a gap, two controllers.
std::string Whole() {
  std::string bytes;
  TraceSender sender(
      [&bytes](std::span<const char> more) { bytes.append(more.data(), more.size()); });
  const std::vector<float> values = {0.0F, 0.5F, 1.0F, 1.5F, 2.0F, 2.5F};
  const std::vector<int> integers = {0, 1, 2, 3, 4, 5};
  const auto send = [&](const auto& matrix) {
    sender.Size(3, 2);
    sender.Values(matrix);
  };
  sender.Text("made_up");
  sender.Number(7);
  sender.Number(1000.0);
  sender.Texts({"index_mcp", "index_pip"});
  sender.Texts({"index_mcp", "index_pip"});
  for (int i = 0; i < 3; ++i) send(std::span(values));
  const auto send_stretch = [&sender](const std::vector<int>& ticks, const char* name,
                                      const char* channel) {
    sender.Size(1, 2);
    sender.Values(std::span<const int>(ticks));
    sender.Text(name);
    sender.Text(channel);
  };
  send_stretch({0, 2}, "fast", "all");
  send_stretch({1, 3}, "gap", "index_pip");
  sender.Number(2);
  for (const char* name : {"raw", "kalman"}) {
    sender.Text(name);
    const Trace none;
    ForEachSignal(none, [&]<class Scalar>(const TraceSignal<Scalar>& signal, const auto&) {
      if (signal.columns == TraceColumns::kGrip || signal.columns == TraceColumns::kPose ||
          signal.columns == TraceColumns::kPalm || signal.columns == TraceColumns::kDigits) {
        sender.Size(0, 0);
      } else if constexpr (std::is_same_v<Scalar, double>) {
        send(std::span(values));
      } else {
        send(std::span(integers));
      }
    });
    sender.Text("ok");
  }
  return bytes;
}

struct EndOfInput {};

void Read(const std::string& bytes) {
  std::string_view rest = bytes;
  const auto receive = [&rest](std::span<char> to) {
    if (to.size() > rest.size()) throw EndOfInput();
    std::copy_n(rest.begin(), to.size(), to.begin());
    rest.remove_prefix(to.size());
  };
  try {
    const TraceFile file = ReceiveTrace(receive, kFileBytes);
    const Eigen::Index ticks = file.true_angle_rad.rows();
    if (!file.true_angle_rad.allFinite() || !file.reference_angle_rad.allFinite()) std::abort();
    for (const MaskedStretch& stretch : file.masked) {
      if (stretch.channel >= std::ssize(file.channel_names) || stretch.end > ticks) std::abort();
    }
    for (const Trace& trace : file.traces) {
      if (!trace.hand_angle_rad.allFinite() || trace.hand_angle_rad.rows() > ticks) std::abort();
      if (trace.hand_angle_rad.cols() != std::ssize(file.joint_names)) std::abort();
      if (trace.filtered_angle_rad.cols() != std::ssize(file.channel_names)) std::abort();
    }
  } catch (const UserError&) {
  } catch (const EndOfInput&) {
  }
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string whole = gauntlet::sim::Whole();
  gauntlet::sim::Read(gauntlet::sim::EditedCopy(whole, data, size));
  return 0;
}
