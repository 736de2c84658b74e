#include "sim/show/pages/curve_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

/// Far beyond any angle in steps, far below where doubles stop counting in ones.
constexpr double kLargestSteps = 1e15;

void AppendGroupsOfSevenBits(std::uint64_t number, std::vector<std::uint8_t>& out) {
  while (number >= 0x80) {
    out.push_back(static_cast<std::uint8_t>(number | 0x80));
    number >>= 7;
  }
  out.push_back(static_cast<std::uint8_t>(number));
}

std::string Base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char kLetters[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out((bytes.size() + 2) / 3 * 4, '=');
  char* letter = out.data();
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16 |
                                (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8 : 0U) |
                                (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0U);
    letter[0] = kLetters[group >> 18];
    letter[1] = kLetters[group >> 12 & 63];
    if (left > 1) letter[2] = kLetters[group >> 6 & 63];
    if (left > 2) letter[3] = kLetters[group & 63];
    letter += 4;
  }
  return out;
}

/// Smallest and largest finite value of a bucket, in the order of time; NaN where there is none.
struct Extremes {
  double first = controller::kNaN;
  double second = first;

  explicit Extremes(std::span<const double> bucket) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double lowest = kInfinity;
    double highest = -kInfinity;
    for (const double value : bucket) {  // what is no number is neither smaller nor larger
      const double finite = std::abs(value) < kInfinity ? value : controller::kNaN;
      lowest = finite < lowest ? finite : lowest;
      highest = finite > highest ? finite : highest;
    }
    if (lowest > highest) return;
    unsigned low_first = 1;  // of those seen, from the end on; a branch would be guessed wrong
    for (std::size_t i = bucket.size(); i-- > 0;) {
      low_first = unsigned{bucket[i] == lowest} | (low_first & unsigned{bucket[i] != highest});
    }
    first = low_first ? lowest : highest;
    second = low_first ? highest : lowest;
  }
};

}  // namespace

int SamplesPerBucket(std::int64_t samples, std::int64_t curves) {
  const std::int64_t values = samples * curves;
  if (values <= kCurvePoints) return 1;
  return (2 * values + kCurvePoints - 1) / kCurvePoints;
}

std::vector<double> KeepPeaks(std::span<const double> values, int samples_per_bucket) {
  if (samples_per_bucket <= 1) return {values.begin(), values.end()};
  const std::size_t size = samples_per_bucket;
  std::vector<double> points(2 * ((values.size() + size - 1) / size));
  double* point = points.data();
  for (std::size_t begin = 0; begin < values.size(); begin += size, point += 2) {
    const Extremes of_bucket(values.subspan(begin, std::min(size, values.size() - begin)));
    point[0] = of_bucket.first;
    point[1] = of_bucket.second;
  }
  return points;
}

std::string EncodeCurve(std::span<const double> values, double step) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(values.size() * 2);
  std::int64_t last = 0;
  for (const double value : values) {
    const double steps = value / step;
    if (!std::isfinite(steps)) {
      bytes.push_back(0);
      continue;
    }
    const double bounded = std::clamp(steps, -kLargestSteps, kLargestSteps);
    const auto now = static_cast<std::int64_t>(bounded + std::copysign(0.5, bounded));
    const std::int64_t change = now - last;
    last = now;
    const auto doubled = static_cast<std::uint64_t>(change) << 1;
    AppendGroupsOfSevenBits((change < 0 ? ~doubled : doubled) + 1, bytes);
  }
  return Base64(bytes);
}

}  // namespace gauntlet::sim
