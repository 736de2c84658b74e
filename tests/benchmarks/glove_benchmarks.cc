#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/normal_pair.h"
#include "sim/base/random.h"
#include "sim/glove/glove.h"
#include "sim/glove/noise/galton_board.h"
#include "sim/recordings/recording_reader.h"
#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {
namespace {

// The paper's amount of data.
constexpr int kSamples = 94096;
constexpr int kChannels = 18;

/// Aim: 94,096 x 18 values with sensor model and Box-Muller noise in under 60 ms on one core.
void BM_SynthesisePaperSignal(benchmark::State& state) {
  GloveConfig config;
  config.motion.settings = RandomMotionConfig{.duration_s = 94.096};
  if (state.range(0) == 1) config.noise.kind = WhiteNoiseKind::kGalton;
  if (state.range(0) == 2) config.noise.kind = WhiteNoiseKind::kNone;
  for (auto _ : state) benchmark::DoNotOptimize(SynthesiseGlove(config, 1));
  state.SetItemsProcessed(state.iterations() * kSamples * kChannels);
}
BENCHMARK(BM_SynthesisePaperSignal)
    ->ArgName("galton1_none2")
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond);

void BM_BoxMuller(benchmark::State& state) {
  std::vector<double> signal(kSamples);
  RandomStream random(1, "benchmark");
  for (auto _ : state) AddBoxMuller(random, 1.0, signal);
  state.SetItemsProcessed(state.iterations() * kSamples);
}
BENCHMARK(BM_BoxMuller);

void BM_Galton(benchmark::State& state) {
  std::vector<double> signal(kSamples);
  RandomStream random(1, "benchmark");
  for (auto _ : state) AddGalton(random, 64, 4, 1.0, signal);
  state.SetItemsProcessed(state.iterations() * kSamples);
}
BENCHMARK(BM_Galton);

/// The same amount as a table of angles [deg].
std::string TableOfAngles() {
  std::string text = "time_s";
  for (const Channel& channel : GloveChannels()) text += fmt::format(",{}_deg", channel.name);
  text += '\n';
  RandomStream random(1, "benchmark");
  for (int i = 0; i < kSamples; ++i) {
    text += fmt::format("{:.3f}", i * 1e-3);
    for (const Channel& channel : GloveChannels()) {
      text += fmt::format(",{:.3f}", random.Uniform(channel.min_deg, channel.max_deg));
    }
    text += '\n';
  }
  return text;
}

/// Text to numbers. Aim: at least 150 MB/s.
void BM_ReadCsv(benchmark::State& state) {
  const std::string text = TableOfAngles();
  std::vector<double> row(kChannels + 1);
  for (auto _ : state) {
    CsvReader reader("memory", TextSource(text), ProblemHandling::kStrict);
    while (reader.NextRow(row)) benchmark::DoNotOptimize(row.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(BM_ReadCsv)->Unit(benchmark::kMillisecond);

/// Text to joint angles with all checks. The aim is the same.
void BM_ReadRecording(benchmark::State& state) {
  const std::string text = TableOfAngles();
  std::vector<double> angle_rad(kChannels);
  double time_s = 0.0;
  for (auto _ : state) {
    RecordingReader reader("memory", TextSource(text), {});
    while (reader.NextRow(time_s, angle_rad)) benchmark::DoNotOptimize(angle_rad.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(BM_ReadRecording)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gauntlet::sim
