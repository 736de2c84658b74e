// A filter by itself: any kind, any number of channels, in place. Shows what it does to noise.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "controller/filters/filter_registry.h"

namespace gc = gauntlet::controller;

namespace {

/// Something between -1 and 1, the same on every machine.
double Noise() {
  static std::uint32_t state = 1;
  state = 1664525u * state + 1013904223u;
  return state / 2147483648.0 - 1.0;
}

double NoiseLeft(gc::Filter& filter) {
  std::vector<double> values(3);
  double before = 0.0;
  double after = 0.0;
  for (int k = 0; k < 20000; ++k) {
    for (double& value : values) {
      value = Noise();
      before += value * value;
    }
    filter.Step(values, values);
    for (const double value : values) after += value * value;
  }
  return std::sqrt(after / before);
}

}  // namespace

int main() {
  const std::vector<gc::FilterConfig> configs = {
      {gc::NoFilterConfig{}},
      {gc::MovingAverageConfig{.window = 25}},
      {gc::ButterworthConfig{.order = 2, .cutoff_hz = 5.0}},
      {gc::OneEuroConfig{.min_cutoff_hz = 1.0, .beta = 0.01}},
      {gc::KalmanConfig{.noise = {.r = {1.0}, .q = {1e-6}}}}};
  for (const gc::FilterConfig& config : configs) {
    const auto filter = gc::MakeFilter(config, 3, 1000.0);
    const double left = NoiseLeft(*filter);
    std::printf("%-16.*s leaves %5.1f %% of white noise\n", static_cast<int>(config.kind().size()),
                config.kind().data(), 100.0 * left);
    if (!(left <= 1.0)) return 1;
  }
  return 0;
}
