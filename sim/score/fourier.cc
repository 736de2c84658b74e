#include "sim/score/fourier.h"

#include <limits>
#include <unsupported/Eigen/FFT>

#include "controller/assert.h"

namespace gauntlet::sim {

struct Fourier::Plans : Eigen::FFT<double> {
  Plans() { SetFlag(HalfSpectrum); }
};

Fourier::Fourier() : plans_(std::make_unique<Plans>()) {}
Fourier::~Fourier() = default;

// A single value is its own transform; Eigen reads beyond its memory there.

void Fourier::Forward(Values& values) {
  if (values.size() < 2) return;
  other_.resize(values.size());
  plans_->fwd(other_.data(), values.data(), std::ssize(values));
  values.swap(other_);
}

void Fourier::Inverse(Values& values) {
  if (values.size() < 2) return;
  other_.resize(values.size());
  plans_->inv(other_.data(), values.data(), std::ssize(values));
  values.swap(other_);
}

void Fourier::Forward(const std::vector<double>& values, Values& lower_half) {
  lower_half.assign(values.size() / 2 + 1, values.empty() ? 0.0 : values[0]);
  if (values.size() < 2) return;
  plans_->fwd(lower_half.data(), values.data(), std::ssize(values));
}

void Fourier::Inverse(const Values& lower_half, std::vector<double>& values) {
  GAUNTLET_ASSERT(lower_half.size() > values.size() / 2);
  if (values.size() < 2) return values.assign(values.size(), lower_half[0].real());
  plans_->inv(values.data(), lower_half.data(), std::ssize(values));
}

int FastTransformSize(int size) {
  long long best = std::numeric_limits<int>::max();
  for (long long fives = 1; fives < best; fives *= 5) {
    for (long long threes = fives; threes < best; threes *= 3) {
      long long candidate = threes;
      while (candidate < size) candidate *= 4;
      if (candidate < best) best = candidate;
    }
  }
  return static_cast<int>(best);
}

}  // namespace gauntlet::sim
