#include "sim/glove/noise/coloured_noise.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "controller/assert.h"
#include "sim/base/normal_pair.h"

namespace gauntlet::sim {
namespace {

constexpr double kLowestHz = 0.1;
constexpr double kStagesPerDecade = 2.0;

/// A chain of first-order stages: y(k) = x(k) - zero x(k-1) + pole y(k-1).
class PinkFilter {
 public:
  explicit PinkFilter(double rate_hz) {
    GAUNTLET_ASSERT(rate_hz > 0.0);
    const double decades = std::log10(0.25 * rate_hz / kLowestHz);
    const int stages = static_cast<int>(std::ceil(decades * kStagesPerDecade));
    for (int k = 0; k < stages; ++k) {
      const double pole_hz = kLowestHz * std::pow(10.0, k / kStagesPerDecade);
      const double zero_hz = pole_hz * std::pow(10.0, 0.5 / kStagesPerDecade);
      stages_.push_back({.pole = std::exp(-2.0 * std::numbers::pi * pole_hz / rate_hz),
                         .zero = std::exp(-2.0 * std::numbers::pi * zero_hz / rate_hz)});
    }
  }
  double Step(double x) {
    for (Stage& stage : stages_) {
      const double y = x - stage.zero * stage.x + stage.pole * stage.y;
      stage.x = x;
      stage.y = y;
      x = y;
    }
    return x;
  }
  void Reset() {
    for (Stage& stage : stages_) stage.x = stage.y = 0.0;
  }

 private:
  struct Stage {
    double pole, zero;
    double x = 0.0, y = 0.0;
  };
  std::vector<Stage> stages_;
};

}  // namespace

void AddPinkNoise(RandomStream& random, double standard_deviation, double rate_hz,
                  std::span<double> signal) {
  PinkFilter filter(rate_hz);
  // Five time constants of the slowest stage: all that its impulse response holds.
  const int settling = static_cast<int>(5.0 * rate_hz / (2.0 * std::numbers::pi * kLowestHz));
  double energy = 0.0;
  for (int i = 0; i < settling; ++i) {
    const double response = filter.Step(i == 0 ? 1.0 : 0.0);
    energy += response * response;
  }
  filter.Reset();
  for (int i = 0; i < settling; ++i) filter.Step(BoxMuller(random).first);
  const double scale = standard_deviation / std::sqrt(energy);
  for (std::size_t i = 0; i < signal.size(); i += 2) {
    const NormalPair pair = BoxMuller(random);
    signal[i] += scale * filter.Step(pair.first);
    if (i + 1 < signal.size()) signal[i + 1] += scale * filter.Step(pair.second);
  }
}

void AddMainsHum(RandomStream& random, double amplitude, double mains_hz, double rate_hz,
                 std::span<double> signal) {
  const double phase = random.Uniform(0.0, 2.0 * std::numbers::pi);
  for (std::size_t i = 0; i < signal.size(); ++i) {
    signal[i] += amplitude * std::sin(phase + 2.0 * std::numbers::pi * mains_hz *
                                                  static_cast<double>(i) / rate_hz);
  }
}

}  // namespace gauntlet::sim
