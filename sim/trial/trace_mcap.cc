#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "sim/base/output_file.h"
#include "sim/tables/mcap_writer.h"
#include "sim/trial/trace_file.h"
#include "sim/trial/trace_signals.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kHeaderParts =
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";
constexpr std::string_view kJointState =
    "std_msgs/Header header\n"
    "string[] name\n"
    "float64[] position\n"
    "float64[] velocity\n"
    "float64[] effort\n";
constexpr std::string_view kSignal =
    "std_msgs/Header header\n"
    "string[] name\n"
    "float64[] value\n";

/// How the values of a signal stand in its messages.
enum class Place { kPosition, kVelocity, kValue };

Place PlaceOf(std::string_view unit) {
  if (unit == "rad") return Place::kPosition;
  return unit == "rad/s" ? Place::kVelocity : Place::kValue;
}

/// A signal as a topic: its rows become messages.
struct SignalTopic {
  std::uint16_t topic = 0;
  std::vector<std::string> names;
  Place place = Place::kPosition;
  int ticks_per_row = 1;
  Eigen::Index rows = 0;
  std::function<double(Eigen::Index row, Eigen::Index column)> value;
};

template <class Matrix>
SignalTopic TopicOf(const std::string& name, std::string_view unit,
                    const std::vector<std::string>& columns, const Matrix& matrix,
                    int ticks_per_row, McapWriter& writer) {
  const Place place = PlaceOf(unit);
  const bool is_value = place == Place::kValue;
  const std::string definition =
      std::string(is_value ? kSignal : kJointState) + std::string(kHeaderParts);
  return {.topic = writer.AddTopic(
              name, is_value ? "gauntlet/msg/Signal" : "sensor_msgs/msg/JointState", definition),
          .names = columns,
          .place = place,
          .ticks_per_row = ticks_per_row,
          .rows = matrix.rows(),
          .value = [&matrix](Eigen::Index row, Eigen::Index column) {
            return static_cast<double>(matrix(row, column));
          }};
}

void AddRow(const SignalTopic& signal, Eigen::Index row, std::int64_t time_ns, McapWriter& writer) {
  std::vector<double> values;
  for (std::size_t c = 0; c < signal.names.size(); ++c) {
    values.push_back(signal.value(row, static_cast<Eigen::Index>(c)));
  }
  CdrWriter message;
  message.Time(time_ns);
  message.Text("");
  message.Texts(signal.names);
  if (signal.place == Place::kVelocity) message.Numbers({});
  message.Numbers(values);
  if (signal.place == Place::kPosition) message.Numbers({});
  if (signal.place != Place::kValue) message.Numbers({});
  writer.AddMessage(signal.topic, time_ns, message.message());
}

}  // namespace

void WriteTraceMcap(const std::filesystem::path& target, const GloveSignal& glove,
                    const Signal& reference_rad, const HandModel& hand,
                    std::span<const Trace> traces) {
  OutputFile file(target);
  McapWriter writer([&file](std::string_view bytes) { file.Write(bytes); });
  const TraceColumnNames names(glove.channel_names, hand);
  std::vector<SignalTopic> signals;
  signals.push_back(TopicOf("/wearer/true_angle_rad", "rad", glove.channel_names,
                            glove.true_angle_rad, 1, writer));
  signals.push_back(TopicOf("/glove/counts", "counts", glove.channel_names, glove.counts,
                            glove.ticks_per_sample, writer));
  signals.push_back(TopicOf("/reference_angle_rad", "rad", names.Of(TraceColumns::kJoints),
                            reference_rad, 1, writer));
  for (const Trace& trace : traces) {
    ForEachSignal(trace, [&](const auto& signal, const auto& matrix) {
      if (matrix.cols() == 0) return;
      signals.push_back(TopicOf(fmt::format("/{}/{}", trace.controller_name, signal.name),
                                signal.unit, names.Of(signal.columns), matrix, 1, writer));
    });
  }
  const Eigen::Index ticks = glove.true_angle_rad.rows();
  for (Eigen::Index k = 0; k < ticks; ++k) {
    const std::int64_t time_ns = std::llround(1e9 * static_cast<double>(k) / glove.tick_rate_hz);
    for (const SignalTopic& signal : signals) {
      const Eigen::Index row = k / signal.ticks_per_row;
      if (k % signal.ticks_per_row == 0 && row < signal.rows) {
        AddRow(signal, row, time_ns, writer);
      }
    }
    constexpr Eigen::Index kTicksPerTrim = 1000;
    if (k % kTicksPerTrim == 0) TrimSignals();
  }
  writer.Finish();
  file.Commit();
}

}  // namespace gauntlet::sim
