// Filters beside the loops that an engineer would write for them: 18 channels of noise at 1 kHz, ns
// per step, the least of passes in turns, by processor time. docs/evidence/benchmarks.md has the
// numbers.

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "tests/controller/test_signal.h"

namespace gauntlet::controller {
namespace {

constexpr int kChannels = 18;
constexpr int kSamples = 4096;
constexpr int kPasses = 12;

using Step = std::function<void(const double* input, double* output)>;

/// The mean of `window` samples as a running sum.
Step MovingAverageByHand(int window) {
  return [window, sums = std::vector<double>(kChannels),
          ring = std::vector<double>(std::size_t(window) * kChannels),
          next = 0](const double* input, double* output) mutable {
    double* place = &ring[std::size_t(next) * kChannels];
    for (int i = 0; i < kChannels; ++i) {
      sums[i] += input[i] - place[i];
      place[i] = input[i];
      output[i] = sums[i] / window;
    }
    if (++next == window) next = 0;
  };
}

double Smoothing(double cutoff_hz) {
  const double turns = 2.0 * std::numbers::pi * cutoff_hz / 1000.0;
  return turns / (turns + 1.0);
}

/// As the paper of One Euro writes it.
Step OneEuroByHand(const OneEuroConfig& config) {
  return [config, y = std::vector<double>(kChannels, 500.0),
          speed = std::vector<double>(kChannels)](const double* input, double* output) mutable {
    const double speed_weight = Smoothing(config.derivative_cutoff_hz);
    for (int i = 0; i < kChannels; ++i) {
      speed[i] += speed_weight * ((input[i] - y[i]) * 1000.0 - speed[i]);
      const double cutoff_hz = config.min_cutoff_hz + config.beta * std::abs(speed[i]);
      y[i] += Smoothing(cutoff_hz) * (input[i] - y[i]);
      output[i] = y[i];
    }
  };
}

/// A sorted array per channel, with one memmove per step.
Step MedianByHand(int window) {
  struct Channel {
    std::vector<double> ring, sorted;
  };
  constexpr double kEmpty = std::numeric_limits<double>::infinity();
  return [channels = std::vector<Channel>(kChannels, {std::vector<double>(window, kEmpty),
                                                      std::vector<double>(window, kEmpty)}),
          next = 0](const double* input, double* output) mutable {
    for (int i = 0; i < kChannels; ++i) {
      auto& [ring, sorted] = channels[i];
      const auto leaving = std::lower_bound(sorted.begin(), sorted.end(), ring[next]);
      const auto place = std::upper_bound(sorted.begin(), sorted.end(), input[i]);
      if (place > leaving) {
        std::copy(leaving + 1, place, leaving);
        *(place - 1) = input[i];
      } else {
        std::copy_backward(place, leaving, leaving + 1);
        *place = input[i];
      }
      ring[next] = input[i];
      output[i] = sorted[sorted.size() / 2];
    }
    if (++next == std::ssize(channels[0].ring)) next = 0;
  };
}

double NsPerStep(const Step& step, const std::vector<double>& input) {
  std::vector<double> output(kChannels);
  timespec begin{};
  timespec end{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &begin);
  for (int k = 0; k < kSamples; ++k) step(&input[std::size_t(k) * kChannels], output.data());
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &end);
  return ((end.tv_sec - begin.tv_sec) * 1e9 + (end.tv_nsec - begin.tv_nsec)) / kSamples;
}

void PrintRow(const std::string& name, const FilterConfig& config, const Step& by_hand) {
  TestNoise noise(1);
  std::vector<double> input;
  for (int k = 0; k < kSamples * kChannels; ++k) input.push_back(500.0 + 4.0 * noise.Normal());
  const auto filter = MakeFilter(config, kChannels, 1000.0);
  const Step library = [&](const double* in, double* out) {
    filter->Step({in, kChannels}, {out, kChannels});
  };
  double ours = 1e300;
  double theirs = 1e300;
  for (int pass = 0; pass < kPasses; ++pass) {  // the first three fill the longest window
    const double our_ns = NsPerStep(library, input);
    const double their_ns = NsPerStep(by_hand, input);
    if (pass < 3) continue;
    ours = std::min(ours, our_ns);
    theirs = std::min(theirs, their_ns);
  }
  std::printf("| %s | %.4g | %.4g | %.2f |\n", name.c_str(), ours, theirs, ours / theirs);
}

void PrintTable() {
  std::puts("| filter | library | by hand | ratio |\n|---|---|---|---|");
  PrintRow("`moving_average`, window 20", {MovingAverageConfig{.window = 20}},
           MovingAverageByHand(20));
  PrintRow("`one_euro`", {OneEuroConfig{}}, OneEuroByHand({}));
  for (const int window : {21, 101, 129, 501, 2001, 10001}) {
    PrintRow("`median`, window " + std::to_string(window), {MedianConfig{.window = window}},
             MedianByHand(window));
  }
}

}  // namespace
}  // namespace gauntlet::controller

int main() { gauntlet::controller::PrintTable(); }
