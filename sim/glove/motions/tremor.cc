#include "sim/glove/motions/tremor.h"

#include <cmath>
#include <complex>
#include <numbers>

#include "controller/assert.h"
#include "sim/base/random.h"
#include "sim/glove/motions/motion.h"
#include "sim/glove/motions/settings_of_motions.h"

namespace gauntlet::sim {
namespace {

constexpr int kSines = 8;
constexpr double kSharedPower = 0.5;  // share that all channels have in common

/// Sum of sines within the band with a mean square of 1.
Eigen::VectorXd NarrowBand(RandomStream& random, const TremorConfig& config, int samples,
                           double rate_hz) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(samples);
  const double amplitude = std::sqrt(2.0 / kSines);
  for (int k = 0; k < kSines; ++k) {
    const double frequency_hz = random.Uniform(config.from_hz, config.to_hz);
    // A rotating pointer; its length drifts by rounding only, 1e-16 a sample.
    std::complex<double> pointer =
        std::polar(amplitude, random.Uniform(0.0, 2.0 * std::numbers::pi));
    const std::complex<double> turn =
        std::polar(1.0, 2.0 * std::numbers::pi * frequency_hz / rate_hz);
    for (int i = 0; i < samples; ++i) {
      sum[i] += pointer.imag();
      pointer = {pointer.real() * turn.real() - pointer.imag() * turn.imag(),
                 pointer.real() * turn.imag() + pointer.imag() * turn.real()};
    }
  }
  return sum;
}

}  // namespace

void TremorConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"rms_deg", "size at each joint; 0 is none", 0, 20}, rms_deg);
  visitor.Number({"from_hz", "lower end of the band", 0.5, 25}, from_hz);
  visitor.Number({"to_hz", "upper end of the band", 0.5, 25}, to_hz);
  VisitChannels(visitor, channels);
  visitor.Flag({"belongs_to_truth", "true: the reference contains the tremor; false: it does not"},
               belongs_to_truth);
}

Signal SynthesiseTremor(const TremorConfig& config, int samples, double rate_hz,
                        std::uint64_t seed) {
  GAUNTLET_ASSERT(samples >= 0 && rate_hz > 0.0);
  if (config.rms_deg == 0.0) return {};
  if (config.to_hz < config.from_hz) {
    throw controller::SettingError("to_hz", "is below from_hz");
  }
  const std::vector<bool> selected = SelectChannels(config.channels);
  RandomStream shared_random(seed, "tremor/shared");
  const Eigen::VectorXd shared =
      std::sqrt(kSharedPower) * NarrowBand(shared_random, config, samples, rate_hz);
  Signal tremor_rad;
  tremor_rad.setZero(samples, static_cast<Eigen::Index>(selected.size()));
  for (std::size_t channel = 0; channel < selected.size(); ++channel) {
    if (!selected[channel]) continue;
    RandomStream random(seed, "tremor/own", channel);
    const double own_share = std::sqrt(1.0 - kSharedPower);
    tremor_rad.col(static_cast<Eigen::Index>(channel)) =
        kRadPerDeg * config.rms_deg *
        (shared + own_share * NarrowBand(random, config, samples, rate_hz));
    TrimSignals();
  }
  return tremor_rad;
}

}  // namespace gauntlet::sim
