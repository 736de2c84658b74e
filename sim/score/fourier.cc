#include "sim/score/fourier.h"

#include <Eigen/Core>
#include <limits>
#include <numbers>

#include "controller/assert.h"

namespace gauntlet::sim {
namespace {

/// Roots of longer transforms are made again each time: they are as large as the values.
constexpr std::size_t kMostKept = std::size_t{1} << 20;  // roots of 1: 16 MB

using Value = std::complex<double>;
/// Real and imaginary part: Eigen works on both at once.
using Complex = Eigen::Array2d;
// What works on it is `inline`, without which g++ calls it: half the speed.

inline Complex Load(const Value* place) {
  return Eigen::Map<const Complex>(reinterpret_cast<const double*>(place));
}
inline void Store(const Complex& value, Value* place) {
  Eigen::Map<Complex>(reinterpret_cast<double*>(place)) = value;
}

/// The product with a root, or with its inverse.
template <bool kInverse>
inline Complex Turned(const Complex& value, const Complex& root) {
  constexpr double kSign = kInverse ? -1.0 : 1.0;
  return value * root.x() + value.reverse() * Complex(-kSign * root.y(), kSign * root.y());
}
/// The product with -i, or with i.
template <bool kInverse>
inline Complex QuarterTurned(const Complex& value) {
  return value.reverse() * (kInverse ? Complex(-1.0, 1.0) : Complex(1.0, -1.0));
}

/// exp(-2 pi i k / size), k = 0 .. size - 1. Four quarters are the same but for a turn.
Fourier::Values Roots(std::size_t size) {
  Fourier::Values roots(size);
  const std::size_t own = size % 4 == 0 ? size / 4 : size;
  for (std::size_t k = 0; k < own; ++k) {
    const double angle = -2.0 * std::numbers::pi * static_cast<double>(k);
    roots[k] = std::polar(1.0, angle / static_cast<double>(size));
  }
  for (std::size_t k = own; k < size; ++k)
    roots[k] = {roots[k - own].imag(), -roots[k - own].real()};
  return roots;
}

/// The transform of so few values, in place.
template <std::size_t kRadix, bool kInverse>
inline void TransformFew(Complex* a) {
  const auto turned = [](const Complex& value) { return QuarterTurned<kInverse>(value); };
  if constexpr (kRadix == 2) {
    const Complex difference = a[0] - a[1];
    a[0] += a[1];
    a[1] = difference;
  } else if constexpr (kRadix == 3) {
    constexpr double kSine = 0.5 * std::numbers::sqrt3;
    const Complex sum = a[1] + a[2];
    const Complex middle = a[0] - 0.5 * sum;
    const Complex side = turned(kSine * (a[1] - a[2]));
    a[0] += sum;
    a[1] = middle + side;
    a[2] = middle - side;
  } else if constexpr (kRadix == 4) {
    const Complex even_sum = a[0] + a[2];
    const Complex even_difference = a[0] - a[2];
    const Complex odd_sum = a[1] + a[3];
    const Complex odd_difference = turned(a[1] - a[3]);
    a[0] = even_sum + odd_sum;
    a[1] = even_difference + odd_difference;
    a[2] = even_sum - odd_sum;
    a[3] = even_difference - odd_difference;
  } else {
    static_assert(kRadix == 5);
    constexpr double kCosine1 = 0.30901699437494742410;  // of 72 degrees, and of 144
    constexpr double kCosine2 = -0.80901699437494742410;
    constexpr double kSine1 = 0.95105651629515357212;
    constexpr double kSine2 = 0.58778525229247312917;
    const Complex outer_sum = a[1] + a[4];
    const Complex inner_sum = a[2] + a[3];
    const Complex outer = a[1] - a[4];
    const Complex inner = a[2] - a[3];
    const Complex middle1 = a[0] + kCosine1 * outer_sum + kCosine2 * inner_sum;
    const Complex middle2 = a[0] + kCosine2 * outer_sum + kCosine1 * inner_sum;
    const Complex side1 = turned(kSine1 * outer + kSine2 * inner);
    const Complex side2 = turned(kSine2 * outer - kSine1 * inner);
    a[0] += outer_sum + inner_sum;
    a[1] = middle1 + side1;
    a[2] = middle2 + side2;
    a[3] = middle2 - side2;
    a[4] = middle1 - side1;
  }
}

/// Transforms `radix` values that are `step` from each other to a place where they are `stride`
/// from each other, and turns them.
template <std::size_t kRadix, bool kInverse, bool kTurns>
inline void TransformGroup(const Value* from, std::size_t step, Value* to, std::size_t stride,
                           const Complex* turn) {
  Complex few[kRadix];
  for (std::size_t k = 0; k < kRadix; ++k) few[k] = Load(from + step * k);
  TransformFew<kRadix, kInverse>(few);
  Store(few[0], to);
  for (std::size_t k = 1; k < kRadix; ++k) {
    if constexpr (kTurns) few[k] = Turned<kInverse>(few[k], turn[k]);
    Store(few[k], to + stride * k);
  }
}

/// One pass: `groups` of `radix` values that are `stride` transforms in one another.
template <std::size_t kRadix, bool kInverse>
void RunPass(const Value* from, Value* to, std::size_t groups, std::size_t stride,
             const Value* turns) {
  Complex turn[kRadix];
  const std::size_t step = stride * groups;
  if (groups == 1) {  // the last pass, which turns nothing
    for (std::size_t n = 0; n < stride; ++n) {
      TransformGroup<kRadix, kInverse, false>(from + n, step, to + n, stride, turn);
    }
    return;
  }
  for (std::size_t group = 0; group < groups; ++group) {
    for (std::size_t k = 1; k < kRadix; ++k) turn[k] = Load(turns++);
    for (std::size_t n = 0; n < stride; ++n) {
      TransformGroup<kRadix, kInverse, true>(from + n, step, to + n, stride, turn);
    }
    from += stride;
    to += stride * kRadix;
  }
}

/// Pass of any radix, by the definition.
template <bool kInverse>
void RunPassOfAnyRadix(const Value* from, Value* to, std::size_t groups, std::size_t stride,
                       const Value* turns, const Fourier::Values& roots) {
  const std::size_t radix = roots.size();
  for (std::size_t group = 0; group < groups; ++group) {
    for (std::size_t n = 0; n < stride; ++n) {
      for (std::size_t k = 0; k < radix; ++k) {
        Complex sum = Complex::Zero();
        for (std::size_t j = 0; j < radix; ++j) {
          sum +=
              Turned<kInverse>(Load(from + n + stride * groups * j), Load(&roots[j * k % radix]));
        }
        Store(k == 0 ? sum : Turned<kInverse>(sum, Load(turns + k - 1)), to + n + stride * k);
      }
    }
    turns += radix - 1;
    from += stride;
    to += stride * radix;
  }
}

/// The next factor of a length.
std::size_t RadixOf(std::size_t length) {
  for (const std::size_t radix : {4, 2, 3, 5}) {
    if (length % radix == 0) return radix;
  }
  std::size_t radix = 7;
  while (length % radix != 0) radix += 2;
  return radix;
}

void Scale(double factor, Fourier::Values& values) {
  for (Value& value : values) value *= factor;
}

}  // namespace

const Fourier::Values& Fourier::RootsOf(std::size_t size) {
  Values& roots = roots_[size];
  if (roots.empty()) {
    roots = Roots(size);
    kept_ += size;
  }
  return roots;
}

const Fourier::Plan& Fourier::PlanOf(std::size_t size) {
  const auto [place, is_new] = plans_.try_emplace(size);
  Plan& plan = place->second;
  if (!is_new) return plan;
  const Values roots = Roots(size);
  kept_ += size;
  for (std::size_t length = size; length > 1;) {
    Pass& pass = plan.emplace_back();
    pass.radix = RadixOf(length);
    pass.groups = length / pass.radix;
    for (std::size_t group = 0; group < pass.groups; ++group) {
      for (std::size_t k = 1; k < pass.radix; ++k) {
        pass.turns.push_back(roots[group * k * (size / length)]);
      }
    }
    if (pass.radix > 5) pass.roots = Roots(pass.radix);
    length = pass.groups;
  }
  return plan;
}

/// The first `size` values, without the factor of the inverse.
template <bool kInverse>
void Fourier::Transform(std::size_t size, Values& values) {
  other_.resize(values.size());
  std::size_t stride = 1;
  for (const Pass& pass : PlanOf(size)) {
    const Value* turns = pass.turns.data();
    switch (pass.radix) {
      case 2:
        RunPass<2, kInverse>(values.data(), other_.data(), pass.groups, stride, turns);
        break;
      case 3:
        RunPass<3, kInverse>(values.data(), other_.data(), pass.groups, stride, turns);
        break;
      case 4:
        RunPass<4, kInverse>(values.data(), other_.data(), pass.groups, stride, turns);
        break;
      case 5:
        RunPass<5, kInverse>(values.data(), other_.data(), pass.groups, stride, turns);
        break;
      default:
        RunPassOfAnyRadix<kInverse>(values.data(), other_.data(), pass.groups, stride, turns,
                                    pass.roots);
    }
    values.swap(other_);
    stride *= pass.radix;
  }
}

void Fourier::Forward(Values& values) {
  Transform<false>(values.size(), values);
  ForgetTooMany();
}

void Fourier::Inverse(Values& values) {
  Transform<true>(values.size(), values);
  Scale(1.0 / static_cast<double>(values.size()), values);
  ForgetTooMany();
}

// Of an even number of real values two neighbours are real and imaginary part of one complex value.
// The transform of these falls into that of the even and that of the odd values:
//     E_k = (Z_k + conj Z_-k) / 2,  O_k = (Z_k - conj Z_-k) / 2i,  X_k = E_k + exp(-2 pi i k/N) O_k

void Fourier::Forward(const std::vector<double>& values, Values& lower_half) {
  const std::size_t size = values.size();
  const std::size_t half = size / 2;
  if (size % 2 != 0) {
    lower_half.assign(values.begin(), values.end());
    Forward(lower_half);
    lower_half.resize(half + 1);
    return;
  }
  lower_half.resize(half + 1);
  for (std::size_t n = 0; n < half; ++n) lower_half[n] = {values[2 * n], values[2 * n + 1]};
  Transform<false>(half, lower_half);
  const Values& roots = RootsOf(size);
  const Value first = lower_half[0];
  for (std::size_t k = 1; k <= half - k; ++k) {
    const Complex low = Load(&lower_half[k]);
    const Complex high = Load(&lower_half[half - k]) * Complex(1.0, -1.0);
    const Complex even = 0.5 * (low + high);
    const Complex odd = Turned<false>(QuarterTurned<false>(0.5 * (low - high)), Load(&roots[k]));
    Store(even + odd, &lower_half[k]);
    Store((even - odd) * Complex(1.0, -1.0), &lower_half[half - k]);
  }
  lower_half[0] = first.real() + first.imag();
  lower_half[half] = first.real() - first.imag();
  ForgetTooMany();
}

void Fourier::Inverse(Values lower_half, std::vector<double>& values) {
  GAUNTLET_ASSERT(lower_half.size() > values.size() / 2);
  const std::size_t size = values.size();
  const std::size_t half = size / 2;
  if (size % 2 != 0) {
    lower_half.resize(size);
    for (std::size_t k = 1; k <= half; ++k) lower_half[size - k] = std::conj(lower_half[k]);
    Inverse(lower_half);
    for (std::size_t n = 0; n < size; ++n) values[n] = lower_half[n].real();
    return;
  }
  const Values& roots = RootsOf(size);
  const double first = lower_half[0].real();
  const double last = lower_half[half].real();
  for (std::size_t k = 1; k <= half - k; ++k) {
    const Complex low = Load(&lower_half[k]);
    const Complex high = Load(&lower_half[half - k]) * Complex(1.0, -1.0);
    const Complex even = low + high;
    const Complex odd = QuarterTurned<true>(Turned<true>(low - high, Load(&roots[k])));
    Store(even + odd, &lower_half[k]);
    Store((even - odd) * Complex(1.0, -1.0), &lower_half[half - k]);
  }
  lower_half[0] = {first + last, first - last};
  Transform<true>(half, lower_half);
  const double factor = 1.0 / static_cast<double>(size);
  for (std::size_t n = 0; n < half; ++n) {
    values[2 * n] = factor * lower_half[n].real();
    values[2 * n + 1] = factor * lower_half[n].imag();
  }
  ForgetTooMany();
}

void Fourier::ForgetTooMany() {
  if (kept_ <= kMostKept) return;
  kept_ = 0;
  plans_.clear();
  roots_.clear();
  Values().swap(other_);
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
