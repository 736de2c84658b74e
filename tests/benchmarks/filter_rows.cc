// Time of a filter alone over the samples of the paper, row by row: what
// tests/benchmarks/python_filter.py compares the Python module with. Usage: filter_rows KIND.
// Prints the median of 20 in ms.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <string_view>
#include <vector>

#include "controller/filters/filter_registry.h"

int main(int argc, char** argv) {
  namespace controller = gauntlet::controller;
  constexpr std::size_t kSamples = 94096;
  constexpr std::size_t kChannels = 18;
  constexpr std::size_t kRuns = 20;
  const std::string_view kind = argc > 1 ? argv[1] : "kalman";
  for (const auto& known : controller::FilterKinds()) {
    if (known.name != kind) continue;
    std::vector<double> input(kSamples * kChannels);
    unsigned state = 1;
    for (double& value : input) {
      state = state * 1664525U + 1013904223U;
      value = 400.0 + static_cast<double>(state >> 24);
    }
    std::vector<double> output(input.size());
    std::vector<double> times_ms;
    for (std::size_t run = 0; run < kRuns; ++run) {
      const auto begin = std::chrono::steady_clock::now();
      const auto filter = controller::MakeFilter(known.defaults, kChannels, 1000.0);
      for (std::size_t at = 0; at < input.size(); at += kChannels) {
        filter->Step(std::span(input).subspan(at, kChannels),
                     std::span(output).subspan(at, kChannels));
      }
      const std::chrono::duration<double, std::milli> time =
          std::chrono::steady_clock::now() - begin;
      times_ms.push_back(time.count());
    }
    std::ranges::sort(times_ms);
    std::printf("%.3f\n", times_ms[kRuns / 2]);
    return 0;
  }
  std::fprintf(stderr, "filter_rows: no kind %s\n", argc > 1 ? argv[1] : "");
  return 2;
}
