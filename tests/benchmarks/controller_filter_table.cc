// Prints the table of all filters that is in docs/evidence/controller.md.

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr double kRateHz = 1000.0;
constexpr double kNoiseCounts = 4.0;
constexpr double kAmplitudeCounts = 200.0;

struct Row {
  std::string settings;
  FilterConfig config;
};

/// Best of several runs over the same samples, by processor time.
double NsPerSample(const FilterConfig& config) {
  const int samples = config.kind() == "kalman_dense" ? 500 : 20000;
  const TestSignal input = GloveCounts(samples, kChannels);
  TestSignal output(samples, kChannels);
  const auto filter = MakeFilter(config, kChannels, kRateHz);
  double best = 1e300;
  for (int run = 0; run < 15; ++run) {
    timespec begin{};
    timespec end{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
    for (int k = 0; k < samples; ++k) filter->Step(RowOf(input, k), RowOf(output, k));
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
    const double ns = (end.tv_sec - begin.tv_sec) * 1e9 + (end.tv_nsec - begin.tv_nsec);
    best = std::min(best, ns / samples);
  }
  return best;
}

/// Answer of the first channel to a sine, as a complex gain; about three periods to settle, at
/// least two seconds.
std::complex<double> GainAt(const FilterConfig& config, double frequency_hz) {
  const auto filter = MakeFilter(config, kChannels, kRateHz);
  const int measured_periods = std::max(2, static_cast<int>(std::lround(0.5 * frequency_hz)));
  const int measured = static_cast<int>(std::lround(measured_periods * kRateHz / frequency_hz));
  const int settling = static_cast<int>(std::max(2.0, 3.0 / frequency_hz) * kRateHz);
  std::vector<double> values(kChannels);
  std::complex<double> sum = 0.0;
  for (int k = 0; k < settling + measured; ++k) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * k / kRateHz;
    std::fill(values.begin(), values.end(), 512.0 + kAmplitudeCounts * std::sin(phase));
    filter->Step(values, values);
    if (k >= settling) sum += (values[0] - 512.0) * std::polar(1.0, -phase);
  }
  // sin = (e^jp - e^-jp) / 2j: the projection is gain / 2j.
  return sum * std::complex<double>(0.0, 2.0) / (measured * kAmplitudeCounts);
}

/// The lowest frequency with a gain of -3 dB; NaN if there is none below 0.45 of the rate.
double ThreeDecibelHz(const FilterConfig& config) {
  const double limit = std::sqrt(0.5);
  double low = 0.05;
  for (double high = 0.0625; high < 0.45 * kRateHz; high *= 1.25) {
    if (std::abs(GainAt(config, high)) < limit) {
      for (int i = 0; i < 8; ++i) {
        const double middle = std::sqrt(low * high);
        (std::abs(GainAt(config, middle)) < limit ? high : low) = middle;
      }
      return std::sqrt(low * high);
    }
    low = high;
  }
  return std::nan("");
}

double NoiseGain(const FilterConfig& config) {
  const auto filter = MakeFilter(config, kChannels, kRateHz);
  TestNoise noise(1);
  std::vector<double> values(kChannels);
  double sum = 0.0;
  int count = 0;
  const int samples = config.kind() == "kalman_dense" ? 6000 : 30000;
  for (int k = 0; k < samples; ++k) {
    for (double& value : values) value = 512.0 + kNoiseCounts * noise.Normal();
    filter->Step(values, values);
    if (k < samples / 3) continue;
    for (const double value : values) sum += (value - 512.0) * (value - 512.0);
    count += kChannels;
  }
  return std::sqrt(sum / count) / kNoiseCounts;
}

double BytesPerChannel(const FilterConfig& config) {
  const auto in_use = [] { return static_cast<double>(mallinfo2().uordblks); };
  const double before = in_use();
  const auto filter = MakeFilter(config, kChannels, kRateHz);
  return (in_use() - before) / kChannels;
}

std::vector<Row> Rows() {
  const KalmanNoise paper = {.r = {15.0}};
  const KalmanNoise tuned = {.r = {15.0}, .q = {1e-4}};
  return {
      {"", {NoFilterConfig{}}},
      {"window 20", {MovingAverageConfig{}}},
      {"window 21", {MedianConfig{}}},
      {"window 11", {HampelConfig{}}},
      {"alpha 0.1", {ExponentialConfig{}}},
      {"order 2, 5 Hz", {ButterworthConfig{}}},
      {"order 8, 5 Hz", {ButterworthConfig{.order = 8}}},
      {"window 41, order 1", {SavitzkyGolayConfig{}}},
      {"1 Hz, beta 0", {OneEuroConfig{}}},
      {"1 Hz, beta 0.01", {OneEuroConfig{.beta = 0.01}}},
      {"alpha 0.1, beta 0.0053", {AlphaBetaConfig{}}},
      {"poles 0.95", {AlphaBetaGammaConfig{}}},
      {"r 15, Q = I", {KalmanConfig{.noise = paper}}},
      {"r 15, Q = 1e-4 I", {KalmanConfig{.noise = tuned}}},
      {"r 15, Q = 1e-8 I, 3 states",
       {KalmanConfig{.noise = {.r = {15.0}, .q = {1e-8}}, .states = 3}}},
      {"r 15, Q = 1e-4 I", {KalmanSteadyConfig{.noise = tuned}}},
      {"from r 15, Q = 1e-4 I", {KalmanAdaptiveConfig{.noise = tuned}}},
      {"r 15, Q = 1e-4 I", {KalmanDenseConfig{.r = {15.0}, .q = {1e-4}}}},
      {"r 15, Q = 1e-4 I, lag 10", {FixedLagConfig{.noise = tuned}}},
  };
}

void Print() {
  std::printf(
      "| filter | settings | ns per sample | delay at 1 Hz, ms | noise gain | -3 dB, Hz | "
      "bytes per channel |\n|---|---|---|---|---|---|---|\n");
  for (const Row& row : Rows()) {
    const double delay_s = -std::arg(GainAt(row.config, 1.0)) / (2.0 * std::numbers::pi);
    const double delay_ms = std::round(delay_s * 1e4) / 10.0;  // to 0.1 ms, without a minus zero
    const double three_db = ThreeDecibelHz(row.config);
    std::printf("| `%s` | %s | %.3g | %.1f | %.3f | ", std::string(row.config.kind()).c_str(),
                row.settings.c_str(), NsPerSample(row.config), delay_ms + 0.0,
                NoiseGain(row.config));
    std::printf(std::isnan(three_db) ? "none" : "%.3g", three_db);
    std::printf(" | %.0f |\n", BytesPerChannel(row.config));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace gauntlet::controller

int main() { gauntlet::controller::Print(); }
