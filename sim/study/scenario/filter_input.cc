#include "sim/study/scenario/filter_input.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/signal.h"
#include "sim/glove/glove.h"

namespace gauntlet::sim {
double FilterInput::FactorTo(std::string_view unit) const {
  const double per_rad = unit == "deg" ? kDegPerRad : unit == "counts" ? counts_per_rad : 1.0;
  return per_rad / unit_per_rad;
}

std::vector<std::string> ChannelsOfFilters(const Scenario& scenario) {
  return NominalCalibration(scenario.glove).channel_names;
}

FilterInput InputOf(const Scenario& scenario, const controller::ControllerConfig& config,
                    std::optional<int> channel) {
  const controller::Timing timing = TimingOf(scenario).controller;
  FilterInput input;
  input.rate_hz = config.filter_at == controller::FilterAt::kEvent ? timing.event_rate_hz()
                                                                   : timing.sample_rate_hz();
  const controller::GloveCalibration glove = NominalCalibration(scenario.glove);
  std::vector<double> scales;
  for (std::size_t c = 0; c < glove.channel_names.size(); ++c) {
    if (channel && static_cast<std::size_t>(*channel) != c) continue;
    scales.push_back(std::abs((glove.high_counts[c] - glove.low_counts[c]) /
                              (glove.high_angle_rad[c] - glove.low_angle_rad[c])));
  }
  double sum = 0.0;
  for (const double scale : scales) sum += scale;
  input.counts_per_rad = sum / static_cast<double>(scales.size());
  const auto [least, most] = std::ranges::minmax(scales);
  input.least_counts_per_rad = least;
  input.most_counts_per_rad = most;
  if (config.filter_on == controller::FilterOn::kCounts) input.unit_per_rad = input.counts_per_rad;
  return input;
}

}  // namespace gauntlet::sim
