// How long one Step() of the whole controller takes, each of 10 million measured by itself: the
// histogram and the worst. See docs/evidence/benchmarks.md; run it as a real-time process, or the
// scheduler is measured.
//
// No core is idle for long: the kernel's timer comes every few milliseconds, and on a virtual
// machine its host's as well. They come at fixed times of a period, so a loop that only reads the
// clock finds these first, without a controller, and the steps are taken between them.

#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <bitset>
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
  clock_gettime(CLOCK_MONOTONIC, &now);
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

/// The parts of a period of 20 ms (in which timers of 50, 100, 250 and 1000 Hz all repeat) at which
/// nothing interrupts a process on this core.
class QuietTimes {
 public:
  /// Watches the clock until a while comes in which a third of the period is quiet; if none does,
  /// the least noisy try of ten has to do.
  QuietTimes() {
    for (int attempt = 0; attempt < 10 && Share() < 1.0 / 3.0; ++attempt) {
      const Parts seen = Watch();
      if (Count(seen) > Count(quiet_)) quiet_ = seen;
    }
    if (Share() == 0.0) quiet_.set();  // nothing to choose from
  }

  double Share() const { return Count(quiet_) / double{kParts}; }

  /// Sleeps until the next quiet time begins, and returns when it ends.
  std::int64_t AwaitNs() const {
    std::int64_t begin = NowNs() / kPartNs + 2;
    while (!IsQuiet(begin)) ++begin;
    std::int64_t end = begin + 1;
    while (IsQuiet(end) && end < begin + kParts) ++end;
    const std::int64_t at_ns = begin * kPartNs;
    const timespec at{.tv_sec = at_ns / 1'000'000'000, .tv_nsec = at_ns % 1'000'000'000};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
    return end * kPartNs;
  }

 private:
  static constexpr std::int64_t kPartNs = 100'000;
  static constexpr int kParts = 200;
  using Parts = std::bitset<kParts>;

  static int Count(const Parts& parts) { return static_cast<int>(parts.count()); }

  /// Quiet is what was interrupted at most once in 0.9 s (which is as long as the kernel lets a
  /// real-time process be), and has two such parts on either side.
  static Parts Watch() {
    std::array<int, kParts> interruptions{};
    const std::int64_t end_ns = NowNs() + 900'000'000;
    for (std::int64_t last_ns = NowNs(); last_ns < end_ns;) {
      const std::int64_t now_ns = NowNs();
      if (now_ns - last_ns > 5'000) {
        for (auto part = last_ns / kPartNs; part <= now_ns / kPartNs; ++part) {
          ++interruptions[static_cast<std::size_t>(part % kParts)];
        }
      }
      last_ns = now_ns;
    }
    Parts quiet;
    quiet.set();
    for (int part = 0; part < kParts; ++part) {
      if (interruptions[static_cast<std::size_t>(part)] < 2) continue;
      for (int near = part - 2; near <= part + 2; ++near) {
        quiet.reset(static_cast<std::size_t>((near + kParts) % kParts));
      }
    }
    return quiet;
  }

  bool IsQuiet(std::int64_t part) const { return quiet_[static_cast<std::size_t>(part % kParts)]; }

  Parts quiet_;
};

/// Times work(k) for each k, with one reading of the clock in it, in quiet times only. `least_ns`
/// keeps the least time of each k over several calls: what interrupts still add comes at other
/// steps in the next call.
template <class Work>
Histogram Measure(std::vector<std::uint16_t>& least_ns, Work work) {
  const QuietTimes quiet;  // anew for each pass: they drift
  std::printf("%.0f %% of the time is quiet\n", 100.0 * quiet.Share());
  Histogram histogram;
  const auto steps = static_cast<long>(least_ns.size());
  std::int64_t quiet_until_ns = 0;
  for (long k = 0; k < steps; ++k) {
    std::int64_t before_ns = NowNs();
    if (before_ns >= quiet_until_ns) {
      quiet_until_ns = quiet.AwaitNs();
      before_ns = NowNs();
    }
    work(k);
    const std::int64_t taken_ns = NowNs() - before_ns;
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
  std::printf("  more than 10 us %10lld\n  more than 50 us %10lld\n",
              static_cast<long long>(histogram.bins[1000]),
              static_cast<long long>(histogram.above_50_us));
}

/// The first Step(), those after Reset() and Swap(), and one at an event, of a controller that
/// plans commands with the adaptive prediction: with what they use in the caches, and not.
void PrintStarts() {
  constexpr int kChannels = 18;
  constexpr int kRepeats = 200;
  const gc::TestSignal input = gc::GloveCounts(4096, kChannels);
  std::vector<char> cache(64 << 20);  // more than all caches
  std::int64_t sum = 0;
  std::printf("\nplanned with adaptive prediction, us: median and worst of %d\n", kRepeats);
  for (const int commands : {6, 16}) {
    gc::ControllerConfig config;
    config.prediction.settings = gc::AdaptivePredictionConfig{};
    config.model_predictive = {.kind = gc::ModelPredictiveKind::kSecondOrder, .steps = commands};
    const gc::GloveCalibration glove = gc::PlainGlove(kChannels);
    const gc::TendonTransmission hand = gc::CoupledHand(kChannels);
    for (const bool cold : {false, true}) {
      std::array<std::vector<double>, 4> taken_us;
      const auto measure = [&](std::size_t what, auto work) {
        if (cold) {
          for (std::size_t i = 0; i < cache.size(); i += 64) sum += ++cache[i];
        }
        const std::int64_t before_ns = NowNs();
        work();
        taken_us[what].push_back(1e-3 * static_cast<double>(NowNs() - before_ns));
      };
      for (int repeat = 0; repeat < kRepeats; ++repeat) {
        gc::Controller controller(config, glove, hand);
        int k = 0;
        const auto step = [&] {
          sum += controller.Step({.counts = gc::RowOf(input, k++)}).motor_counts[0];
        };
        measure(0, step);
        for (int i = 0; i < 19; ++i) step();
        measure(1, step);  // at an event
        controller.Reset();
        measure(2, step);
        gc::Controller next = controller.Prepare(config);
        for (int i = 0; i < 19; ++i) step();
        measure(3, [&] {
          controller.Swap(next);
          step();
        });
      }
      const char* names[] = {"first", "event", "after Reset()", "Swap() and Step()"};
      for (std::size_t what = 0; what < taken_us.size(); ++what) {
        std::ranges::sort(taken_us[what]);
        std::printf("%2d commands, %s, %-18s %7.1f %7.1f\n", commands, cold ? "cold" : "hot ",
                    names[what], taken_us[what][kRepeats / 2], taken_us[what].back());
      }
    }
  }
  std::printf("(sum %lld)\n", static_cast<long long>(sum));
}

}  // namespace

int main(int argc, char** argv) {
  const long steps = argc > 1 ? std::atol(argv[1]) : 10'000'000;
  constexpr int kChannels = 18;
  gc::ControllerConfig config;
  config.filters = {{gc::KalmanConfig{}}};
  gc::Controller controller(config, gc::PlainGlove(kChannels), gc::CoupledHand(kChannels));
  const gc::TestSignal input = gc::GloveCounts(4096, kChannels);
  mlockall(MCL_CURRENT | MCL_FUTURE);
  PrintStarts();

  std::int64_t sum_counts = 0;  // so that the work cannot be left out
  std::vector<std::uint16_t> least_ns(static_cast<std::size_t>(steps), 65535);
  std::printf("%ld steps of 18 channels, Kalman, with one reading of the clock each\n", steps);
  constexpr int kPasses = 10;
  for (int pass = 0; pass < kPasses; ++pass) {
    controller.Reset();  // so that every pass does the same
    const Histogram histogram = Measure(least_ns, [&](long k) {
      sum_counts += controller.Step({.counts = gc::RowOf(input, k % 4096)}).motor_counts[0];
    });
    if (pass == 0) Print(histogram, steps);
    std::printf("pass %d: worst %.1f us\n", pass + 1, histogram.worst_ns * 1e-3);
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
  std::printf("worst %.1f us\n", nothing.worst_ns * 1e-3);
  return 0;
}
