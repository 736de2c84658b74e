#include "sim/recordings/channel_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/base/channels.h"
#include "sim/tables/missing.h"

namespace gauntlet::sim {

ChannelValues::ChannelValues(std::vector<Parts> channels) : channels_(std::move(channels)) {
  for (const Parts& parts : channels_) {
    std::vector<State>& states = states_.emplace_back(parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (parts[i].envelope_ms > 0.0) states[i].envelope.emplace(parts[i].envelope_ms);
    }
  }
}

bool ChannelValues::needs_time() const {
  return std::ranges::any_of(channels_, [](const Parts& parts) {
    return std::ranges::any_of(parts, [](const Part& part) { return part.envelope_ms > 0.0; });
  });
}

double ChannelValues::Unwrapped(double value, double wraps_at, State& state) {
  if (wraps_at == 0.0 || std::isnan(value)) return value;
  const double step = value - state.before;
  const double turned = state.turned;
  if (step > 0.5 * wraps_at) state.turned -= wraps_at;
  if (step < -0.5 * wraps_at) state.turned += wraps_at;
  if (state.turned != turned) ++state.jumps;
  state.before = value;
  return value + state.turned;
}

double ChannelValues::Next(std::size_t channel, double time_s, std::span<const double> row) {
  double sum = -0.0;
  for (std::size_t i = 0; i < channels_[channel].size(); ++i) {
    const Part& part = channels_[channel][i];
    State& state = states_[channel][i];
    double value = part.column < row.size() ? row[part.column] : kMissing;
    value = Unwrapped(value, part.wraps_at, state);
    if (state.envelope) {
      const double step_s = time_s - state.time_s;
      const bool is_in_order = step_s > 0.0 || step_s <= -kClockRestart_s;
      value = is_in_order ? state.envelope->Step(time_s, value) : kMissing;
      if (is_in_order && std::isfinite(value)) state.time_s = time_s;
    }
    sum += part.factor * value + part.offset;
  }
  return sum;
}

std::vector<std::string> EnvelopesOf(const ColumnMap& map) {
  std::vector<std::string> sentences;
  for (const ColumnMapping& mapping : map.channels) {
    if (mapping.envelope_ms == 0.0) continue;
    sentences.push_back(fmt::format(
        "{} is the envelope of column {}: mean absolute value over {:g} ms, which lags by {:g} ms",
        KnownChannels()[mapping.channel].name, mapping.column + 1, mapping.envelope_ms,
        0.5 * mapping.envelope_ms));
  }
  return sentences;
}

}  // namespace gauntlet::sim
