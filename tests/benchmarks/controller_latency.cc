// How long one Step() of the whole controller takes, each of 10 million measured by itself: the
// histogram and the worst. See README.md for the command; run it as a real-time process, or what is
// measured is who else wants the core.

#include <time.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "controller/controller.h"
#include "tests/controller/test_hand.h"
#include "tests/controller/test_signal.h"

namespace {

namespace gc = gauntlet::controller;

std::int64_t NowNs() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC_RAW, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

/// Bins of 10 ns up to 10 us, then one for all above; small, so that it stays in the cache.
struct Histogram {
  std::array<std::int64_t, 1001> bins{};
  std::int64_t above_50_us = 0;
  std::int64_t worst_ns = 0;

  void Add(std::int64_t taken_ns) {
    ++bins[static_cast<std::size_t>(std::min<std::int64_t>(taken_ns / 10, 1000))];
    above_50_us += taken_ns > 50'000;
    worst_ns = std::max(worst_ns, taken_ns);
  }
};

/// Times work(k) for each k, with one reading of the clock in it. `least_ns` keeps the least time
/// of each k over several calls: what interrupts add comes at other steps in the next call.
template <class Work>
Histogram Measure(std::vector<std::uint16_t>& least_ns, Work work) {
  Histogram histogram;
  const auto steps = static_cast<long>(least_ns.size());
  std::int64_t before = 0;
  for (long k = 0; k < steps; ++k) {
    // A rest now and then, as a robot's loop has one: without it the kernel would take the core
    // away from a real-time process for 50 ms of every second.
    if (k % 20'000 == 0) {
      const timespec rest{.tv_sec = 0, .tv_nsec = 2'000'000};
      nanosleep(&rest, nullptr);
    }
    before = NowNs();
    work(k);
    const std::int64_t taken_ns = NowNs() - before;
    histogram.Add(taken_ns);
    std::uint16_t& least = least_ns[static_cast<std::size_t>(k)];
    least = static_cast<std::uint16_t>(std::min<std::int64_t>(least, taken_ns));
  }
  return histogram;
}

void Print(const Histogram& histogram, long steps) {
  std::int64_t seen = 0;
  const double shares[] = {0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999};
  std::size_t next = 0;
  for (std::size_t bin = 0; bin < 1000; ++bin) {
    seen += histogram.bins[bin];
    while (next < std::size(shares) && seen >= shares[next] * steps) {
      std::printf("%9.3f %% below %zu ns\n", 100.0 * shares[next++], 10 * (bin + 1));
    }
  }
  std::printf("histogram, each line twice as long as the one before:\n");
  for (std::size_t low = 0, high = 8; low < 1000;
       low = high, high = std::min<std::size_t>(2 * high, 1000)) {
    std::int64_t count = 0;
    for (std::size_t bin = low; bin < high; ++bin) count += histogram.bins[bin];
    std::printf("%6zu to %5zu ns %10lld\n", 10 * low, 10 * high, static_cast<long long>(count));
  }
  std::printf("  more than 10 us %10lld\n  more than 50 us %10lld\nworst %.1f us\n",
              static_cast<long long>(histogram.bins[1000]),
              static_cast<long long>(histogram.above_50_us), histogram.worst_ns * 1e-3);
}

}  // namespace

int main(int argc, char** argv) {
  const long steps = argc > 1 ? std::atol(argv[1]) : 10'000'000;
  constexpr int kChannels = 18;
  gc::ControllerConfig config;
  config.filters = {{gc::KalmanConfig{}}};
  gc::Controller controller(config, gc::PlainGlove(kChannels), gc::CoupledHand(kChannels));
  const gc::TestSignal input = gc::GloveCounts(4096, kChannels);

  std::int64_t sum_counts = 0;  // so that the work cannot be left out
  std::vector<std::uint16_t> least_ns(static_cast<std::size_t>(steps), 65535);
  std::printf("%ld steps of 18 channels, Kalman, with one reading of the clock each\n", steps);
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    controller.Reset();  // so that every pass does the same
    const Histogram histogram = Measure(least_ns, [&](long k) {
      sum_counts += controller.Step({.counts = gc::RowOf(input, k % 4096)}).motor_counts[0];
    });
    if (pass == 0) {
      Print(histogram, steps);
    } else {
      std::printf("worst of pass %d: %.1f us\n", pass + 1, histogram.worst_ns * 1e-3);
    }
  }
  std::printf("slowest step, each at its least of %d passes: %.2f us (sum %lld)\n", kPasses,
              *std::max_element(least_ns.begin(), least_ns.end()) * 1e-3,
              static_cast<long long>(sum_counts));

  // What the machine does to any program: the same without a controller.
  constexpr std::int64_t kAboutAStepNs = 100;
  const Histogram nothing = Measure(least_ns, [](long) {
    const std::int64_t end = NowNs() + kAboutAStepNs;
    while (NowNs() < end) {
    }
  });
  std::printf("\nthe same, only reading the clock for %lld ns\n",
              static_cast<long long>(kAboutAStepNs));
  Print(nothing, steps);
  return 0;
}
