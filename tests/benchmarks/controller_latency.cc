// How long one Step() of the whole controller takes, each of 10 million measured by itself: the
// histogram and the worst. See README.md for the command.

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

}  // namespace

int main(int argc, char** argv) {
  const long steps = argc > 1 ? std::atol(argv[1]) : 10'000'000;
  constexpr int kChannels = 18;
  gc::ControllerConfig config;
  config.filters = {{gc::KalmanConfig{}}};
  gc::Controller controller(config, gc::PlainGlove(kChannels), gc::CoupledHand(kChannels));
  const gc::TestSignal input = gc::GloveCounts(4096, kChannels);

  // Bins of 10 ns up to 10 us, then one for all above; kept small so that it stays in the cache.
  std::array<std::int64_t, 1001> bins{};
  std::int64_t worst_ns = 0;
  std::int64_t sum_counts = 0;  // so that the work cannot be left out
  std::int64_t before = NowNs();
  for (long k = 0; k < steps; ++k) {
    const auto command = controller.Step({.counts = gc::RowOf(input, k % 4096)});
    const std::int64_t after = NowNs();
    const std::int64_t taken = after - before;  // with one reading of the clock
    sum_counts += command.motor_counts[0];
    ++bins[static_cast<std::size_t>(std::min<std::int64_t>(taken / 10, 1000))];
    worst_ns = std::max(worst_ns, taken);
    before = NowNs();
  }

  std::printf("%ld steps of 18 channels, Kalman, with one reading of the clock each\n", steps);
  std::int64_t seen = 0;
  const double shares[] = {0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999};
  std::size_t next = 0;
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    seen += bins[bin];
    while (next < std::size(shares) && seen >= shares[next] * steps) {
      std::printf("%9.3f %% below %s%zu ns\n", 100.0 * shares[next],
                  bin == 1000 ? "(more than) " : "", 10 * (std::min<std::size_t>(bin, 999) + 1));
      ++next;
    }
  }
  std::printf("worst %.3f us (sum %lld)\n", worst_ns * 1e-3, static_cast<long long>(sum_counts));
  std::printf("histogram, each line twice as long as the one before:\n");
  for (std::size_t low = 0, high = 8; low < 1000;
       low = high, high = std::min<std::size_t>(2 * high, 1000)) {
    std::int64_t count = 0;
    for (std::size_t bin = low; bin < high; ++bin) count += bins[bin];
    std::printf("%6zu to %5zu ns %10lld\n", 10 * low, 10 * high, static_cast<long long>(count));
  }
  std::printf("  more than 10 us %10lld\n", static_cast<long long>(bins[1000]));
  return 0;
}
