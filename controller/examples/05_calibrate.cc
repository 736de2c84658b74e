// From recorded poses to a linearisation and a measurement variance, and into a controller.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "controller/calibration/curve_fit.h"
#include "controller/calibration/noise_estimate.h"
#include "controller/controller.h"

namespace gc = gauntlet::controller;

int main() {
  // Three poses of one second each; in your program: a recording of one channel.
  std::vector<double> counts(3000);
  std::vector<double> angle_deg(3000);
  std::uint32_t state = 7;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const std::size_t pose = k / 1000;
    const double pose_counts[] = {210.0, 520.0, 760.0};
    double noise = -6.0;  // twelve uniform numbers make a nearly normal one of variance 1
    for (int i = 0; i < 12; ++i) noise += (state = 1664525u * state + 1013904223u) / 4294967296.0;
    counts[k] = std::round(pose_counts[pose] + 3.0 * noise);
    angle_deg[k] = 45.0 * static_cast<double>(pose);
  }

  const gc::CurveFit fit = gc::FitTable(counts, angle_deg);
  for (std::size_t i = 0; i < fit.curve.counts.size(); ++i) {
    std::printf("%7.2f counts are %5.1f deg, to %.3f deg\n", fit.curve.counts[i],
                fit.curve.angle_deg[i], fit.half_width_95_deg[i]);
  }
  const auto stretches = gc::FindStillStretches(counts, 1, 1000.0);
  const gc::NoiseEstimate noise = gc::EstimateNoise(counts, 1, stretches);
  std::printf("R = %.2f counts^2, 95 %% from %.2f to %.2f, from %zu stretches\n", noise.variance[0],
              noise.variance_low[0], noise.variance_high[0], stretches.size());

  gc::ControllerConfig config;
  config.linearisation = {.kind = gc::LinearisationKind::kTable, .channels = {fit.curve}};
  config.filters = {{gc::KalmanConfig{.noise = {.r = {noise.variance[0]}, .q = {1e-3}}}}};
  return noise.variance_low[0] < 9.0 && 9.0 < noise.variance_high[0] ? 0 : 1;
}
