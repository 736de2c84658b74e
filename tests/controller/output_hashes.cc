// Hashes of the output of filters and predictions for the same counts, one line each, with the last
// output. Equal lines of two builds mean equal bits.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "controller/filters/filter_registry.h"
#include "controller/prediction/predictor.h"
#include "tests/controller/filter_cases.h"
#include "tests/controller/test_signal.h"

namespace {

using gauntlet::controller::Filter;

constexpr int kChannels = 18;
constexpr int kSamples = 5000;
constexpr double kRateHz = 1000.0;

/// FNV-1a over the bytes of a value.
void Add(std::uint64_t& hash, const void* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    hash = (hash ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3;
  }
}

/// Counts of a moving glove without a function of the C library, which may differ in the last bit:
/// triangles between 312 and 712 with noise.
double Counts(int sample, int channel, gauntlet::controller::TestNoise& noise) {
  const int period = 600 + 150 * channel;
  const int phase = (sample + 37 * channel) % period;
  const int up = 2 * phase < period ? 2 * phase : 2 * (period - phase);
  return 312 + 400 * up / period + static_cast<int>(8.0 * noise.Uniform());
}

void Print(const char* what, const std::string& name, Filter* filter, double scale) {
  if (filter == nullptr) return;
  std::uint64_t hash = 0xcbf29ce484222325;
  gauntlet::controller::TestNoise noise(1);
  std::vector<double> values(kChannels);
  for (int k = 0; k < kSamples; ++k) {
    for (int i = 0; i < kChannels; ++i) {
      values[static_cast<std::size_t>(i)] = scale * Counts(k, i, noise);
    }
    filter->Step(values, values);
    Add(hash, values.data(), values.size() * sizeof(double));
  }
  std::printf("%s %s %016" PRIx64 " %.17g\n", what, name.c_str(), hash, values[0]);
}

}  // namespace

int main() {
  namespace controller = gauntlet::controller;
  for (const auto& [name, config] : controller::FilterCases()) {
    Print("filter", name, controller::MakeFilter(config, kChannels, kRateHz).get(), 1.0);
  }
  for (const auto& kind : controller::PredictionKinds()) {
    if (kind.name.starts_with("fitted")) continue;  // have no weights by default
    Print("prediction", std::string(kind.name),
          controller::MakePredictor(kind.defaults, kChannels, kRateHz).get(), 0x1p-10);
  }
}
