// How long scoring takes: the paper's recording of 94,096 samples of 18 channels, all metrics.

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/base/random.h"
#include "sim/score/delay.h"
#include "sim/score/fourier.h"
#include "sim/score/jitter.h"
#include "sim/score/latency.h"
#include "sim/score/score.h"
#include "sim/score/wearer.h"

namespace gauntlet::sim {
namespace {

constexpr int kSamples = 94096;
constexpr int kChannels = 18;

/// A wearer who moves all joints at random, a hand that follows 60 ms later with noise, and
/// everything else that a trial records.
struct Recording {
  Signal wearer{kSamples, kChannels};
  Signal hand{kSamples, kChannels};
  IntegerSignal command{kSamples, kChannels};
  Signal speed{kSamples, kChannels};
  Signal tension{kSamples, 2 * kChannels};
  Signal noise_free_hand{kSamples, kChannels};
  Signal noise_free_speed{kSamples, kChannels};
  std::vector<double> stall_tension_n = std::vector<double>(2 * kChannels, 18.0);
  std::vector<double> saturation = std::vector<double>(kChannels, 0.1);

  Recording() {
    for (int c = 0; c < kChannels; ++c) {
      RandomStream random(1, "benchmark", static_cast<std::uint64_t>(c));
      for (int n = 0; n < kSamples; ++n) {
        wearer(n, c) = Angle(n, c);
        noise_free_hand(n, c) = Angle(n - 60, c);
        hand(n, c) = noise_free_hand(n, c) + 0.01 * (random.Uniform() - 0.5);
        noise_free_speed(n, c) = 0.1 * random.Uniform();
        command(n, c) = static_cast<int>(200.0 * Angle(n / 20 * 20, c));
        speed(n, c) = random.Uniform() - 0.5;
        tension(n, 2 * c) = 5.0 * random.Uniform();
        tension(n, 2 * c + 1) = 5.0 * random.Uniform();
      }
    }
  }
  static double Angle(int n, int channel) {
    const double t = 0.001 * n + 7.0 * channel;
    return 0.4 * std::sin(1.9 * t) + 0.3 * std::sin(3.7 * t + 1.0) + 0.2 * std::sin(6.1 * t + 2.0);
  }
};

const Recording& SharedRecording() {
  static const Recording recording;
  return recording;
}

void AllScores(benchmark::State& state) {
  const Recording& recording = SharedRecording();
  std::vector<std::string> joints, cables;
  for (int c = 0; c < kChannels; ++c) joints.push_back("joint_" + std::to_string(c));
  for (Eigen::Index c = 0; c < recording.tension.cols(); ++c) {
    cables.push_back("cable_" + std::to_string(c));
  }
  const ScoreRows rows(joints, joints, cables);
  const ScoreInput input{.reference_angle_rad = &recording.wearer,
                         .hand_angle_rad = &recording.hand,
                         .command_counts = &recording.command,
                         .motor_speed_rad_s = &recording.speed,
                         .tension_n = &recording.tension,
                         .saturation_share = recording.saturation,
                         .noise_free_hand_angle_rad = &recording.noise_free_hand,
                         .noise_free_motor_speed_rad_s = &recording.noise_free_speed,
                         .stall_tension_n = recording.stall_tension_n};
  for (auto _ : state) benchmark::DoNotOptimize(ComputeScores(input, rows).summary.data());
}
BENCHMARK(AllScores)->Unit(benchmark::kMillisecond);

void DelayOf18Channels(benchmark::State& state) {
  const Recording& recording = SharedRecording();
  for (auto _ : state) {
    Fourier fourier;
    for (int c = 0; c < kChannels; ++c) {
      benchmark::DoNotOptimize(DelaySamples({recording.wearer.col(c).data(), kSamples},
                                            {recording.hand.col(c).data(), kSamples}, 1000.0, 0.0,
                                            {{0, kSamples}}, fourier));
    }
  }
}
BENCHMARK(DelayOf18Channels)->Unit(benchmark::kMillisecond);

void TremblingOf18Channels(benchmark::State& state) {
  const Recording& recording = SharedRecording();
  for (auto _ : state) {
    Fourier fourier;
    benchmark::DoNotOptimize(Trembling(recording.hand, 1000.0, 10.0, fourier).values.data());
  }
}
BENCHMARK(TremblingOf18Channels)->Unit(benchmark::kMillisecond);

void WearerOf18Channels(benchmark::State& state) {
  const Recording& recording = SharedRecording();
  for (auto _ : state) {
    for (int c = 0; c < kChannels; ++c) {
      benchmark::DoNotOptimize(
          AnalyseWearer({recording.wearer.col(c).data(), kSamples}, 1000.0, {}).movements.data());
    }
  }
}
BENCHMARK(WearerOf18Channels)->Unit(benchmark::kMillisecond);

void LatencyBudgetOf18Channels(benchmark::State& state) {
  const Recording& recording = SharedRecording();
  const LatencyInput input{.wearer_angle_rad = &recording.wearer,
                           .raw_angle_rad = &recording.hand,
                           .filtered_angle_rad = &recording.hand,
                           .target_angle_rad = &recording.hand,
                           .command_angle_rad = &recording.hand,
                           .hand_angle_rad = &recording.hand};
  for (auto _ : state) benchmark::DoNotOptimize(MeasureLatency(input).total_ms);
}
BENCHMARK(LatencyBudgetOf18Channels)->Unit(benchmark::kMillisecond);

void ComplexTransform(benchmark::State& state) {
  Fourier fourier;
  Fourier::Values values(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    std::ranges::fill(values, 1.0);
    fourier.Forward(values);
    benchmark::DoNotOptimize(values.data());
  }
}
BENCHMARK(ComplexTransform)
    ->Arg(1024)
    ->Arg(8192)
    ->Arg(97200)
    ->Arg(131072)
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace gauntlet::sim

BENCHMARK_MAIN();
