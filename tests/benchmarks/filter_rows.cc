// Time of a filter over the samples of the paper, which tests/benchmarks/python_filter.py compares
// the Python module with. Usage: filter_rows KIND. Prints the medians of 20 [ms]: the filter alone,
// row by row; and with missing values held, as the program and the module have it.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <string_view>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "sim/trial/held_filter.h"

int main(int argc, char** argv) {
  namespace controller = gauntlet::controller;
  constexpr std::size_t kSamples = 94096;
  constexpr std::size_t kChannels = 18;
  constexpr std::size_t kRuns = 20;
  constexpr double kRateHz = 1000.0;
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
    const auto median_ms = [](const auto& work) {
      std::vector<double> times_ms;
      for (std::size_t run = 0; run < kRuns; ++run) {
        const auto begin = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::milli> time =
            std::chrono::steady_clock::now() - begin;
        times_ms.push_back(time.count());
      }
      std::ranges::sort(times_ms);
      return times_ms[kRuns / 2];
    };
    const double alone_ms = median_ms([&] {
      const auto filter = controller::MakeFilter(known.defaults, kChannels, kRateHz);
      for (std::size_t at = 0; at < input.size(); at += kChannels) {
        filter->Step(std::span(input).subspan(at, kChannels),
                     std::span(output).subspan(at, kChannels));
      }
    });
    const double held_ms = median_ms([&] {
      gauntlet::sim::HeldFilter filter(known.defaults, kChannels, kRateHz);
      filter.StepRows(input, output);
    });
    std::printf("%.3f %.3f\n", alone_ms, held_ms);
    return 0;
  }
  std::fprintf(stderr, "filter_rows: no kind %s\n", argc > 1 ? argv[1] : "");
  return 2;
}
