#include <fmt/format.h>

#include <string>

#include "controller/filters/process_noise.h"
#include "sim/settings/libraries/library.h"

namespace gauntlet::sim {
namespace {

std::string FilterPyBody(const controller::AlphaBetaConfig& config, const PlainFilter& filter) {
  return fmt::format(R"(from filterpy.gh import GHFilter

def smooth(samples):
    gh = GHFilter(x=samples[0], dx=0.0, dt=1 / {}, g={}, h={})  # one for each channel
    return [gh.update(sample)[0] for sample in samples]
)",
                     LineNumber(filter.rate_hz), LineNumber(config.alpha), LineNumber(config.beta));
}

std::string FilterPyBody(const controller::AlphaBetaGammaConfig& config,
                         const PlainFilter& filter) {
  return fmt::format(R"(from filterpy.gh import GHKFilter

def smooth(samples):  # one for each channel
    ghk = GHKFilter(x=samples[0], dx=0.0, ddx=0.0, dt=1 / {}, g={}, h={}, k={})
    return [ghk.update(sample)[0] for sample in samples]
)",
                     LineNumber(filter.rate_hz), LineNumber(config.alpha), LineNumber(config.beta),
                     LineNumber(config.gamma));
}

std::string FilterPyBody(const controller::KalmanConfig& config, const PlainFilter& filter) {
  const controller::KalmanNoise& noise = config.noise;
  if (config.start != controller::Start::kFirst || config.acceleration_window > 0 ||
      noise.r.size() != 1 || noise.q.size() != 1) {
    return "";
  }
  const auto f = controller::FactorsOf(noise.process_noise, config.states, 1.0 / filter.rate_hz);
  const bool two = config.states == 2;
  const auto number = [](double value) { return LineNumber(value); };
  const std::string covariance =
      two ? fmt::format("[[{}, {}], [{}, {}]]", number(f.q11), number(f.q12), number(f.q12),
                        number(f.q22))
          : fmt::format("[[{}, {}, {}], [{}, {}, {}], [{}, {}, {}]]", number(f.q11), number(f.q12),
                        number(f.q13), number(f.q12), number(f.q22), number(f.q23), number(f.q13),
                        number(f.q23), number(f.q33));
  return fmt::format(
      R"(import numpy as np
from filterpy.kalman import KalmanFilter

def smooth(samples):
    kalman = KalmanFilter(dim_x={0}, dim_z=1)  # one for each channel; its speed is per sample
    kalman.x = np.array([samples[0]] + [0.0] * {1})
    kalman.F = np.array({2})
    kalman.H = np.array([{3}])
    kalman.P = {4} * np.eye({0})
    kalman.R = np.array([[{5}]])
    kalman.Q = {6} * np.array({7})
    filtered = [samples[0]]
    for sample in samples[1:]:
        kalman.predict()
        kalman.update(sample)
        filtered.append(kalman.x[0])
    return filtered
)",
      config.states, config.states - 1,
      two ? "[[1.0, 1.0], [0.0, 1.0]]" : "[[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]",
      two ? "[1.0, 0.0]" : "[1.0, 0.0, 0.0]", number(filter.start_variance), number(noise.r[0]),
      number(noise.q[0]), covariance);
}
std::string FilterPyBody(const auto& /*config*/, const PlainFilter& /*filter*/) { return ""; }

std::string FilterPyLines(const PlainFilter& filter) {
  return std::visit([&](const auto& config) { return FilterPyBody(config, filter); },
                    filter.settings);
}

}  // namespace

Library FilterPy() {
  return {
      .name = "filterpy",
      .package = "filterpy 2.0.0 (PyPI)",
      .comment = "#",
      .kinds = {controller::AlphaBetaConfig::kKind, controller::AlphaBetaGammaConfig::kKind,
                controller::KalmanConfig::kKind},
      .differences = {"update(None) of the Kalman filter predicts through a missing sample, "
                      "Gauntlet holds the last good one: give that again.",
                      "g, h and k are alpha, beta and gamma; the speed of GHFilter is per second."},
      .lines = FilterPyLines,
      .like = nullptr};
}

}  // namespace gauntlet::sim
