#include "sim/score/fourier.h"

#include <limits>

namespace gauntlet::sim {

namespace {

/// Twiddle factors of longer transforms are made again each time: they are as large as the values,
/// and each direction has its own.
constexpr std::size_t kLongestKept = std::size_t{1} << 20;

}  // namespace

void Fourier::Forward(Values& values) {
  result_.resize(values.size());
  transform_.fwd(result_.data(), values.data(), static_cast<Eigen::Index>(values.size()));
  values.swap(result_);
  ForgetLong(values.size());
}

void Fourier::Inverse(Values& values) {
  result_.resize(values.size());
  transform_.inv(result_.data(), values.data(), static_cast<Eigen::Index>(values.size()));
  values.swap(result_);
  ForgetLong(values.size());
}

void Fourier::Forward(const std::vector<double>& values, Values& lower_half) {
  lower_half.resize(values.size() / 2 + 1);
  transform_.fwd(lower_half.data(), values.data(), static_cast<Eigen::Index>(values.size()));
  ForgetLong(values.size());
}

void Fourier::Inverse(Values lower_half, std::vector<double>& values) {
  transform_.inv(values.data(), lower_half.data(), static_cast<Eigen::Index>(values.size()));
  ForgetLong(values.size());
}

void Fourier::ForgetLong(std::size_t size) {
  if (size <= kLongestKept) return;
  transform_.impl().clear();
  Values().swap(result_);
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
