#include "sim/report/curve_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16 |
                                (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8 : 0U) |
                                (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0U);
    out += kLetters[group >> 18];
    out += kLetters[group >> 12 & 63];
    out += left > 1 ? kLetters[group >> 6 & 63] : '=';
    out += left > 2 ? kLetters[group & 63] : '=';
  }
  return out;
}

/// Smallest and largest finite value of a bucket, in the order of time.
std::pair<double, double> Extremes(std::span<const double> bucket) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::size_t low = bucket.size();
  std::size_t high = bucket.size();
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (std::size_t i = 0; i < bucket.size(); ++i) {
    const double value = bucket[i];
    if (value < lowest && std::isfinite(value)) {
      low = i;
      lowest = value;
    }
    if (value > highest && std::isfinite(value)) {
      high = i;
      highest = value;
    }
  }
  if (low == bucket.size()) return {kNone, kNone};
  return {bucket[std::min(low, high)], bucket[std::max(low, high)]};
}

}  // namespace

int SamplesPerBucket(std::int64_t samples, std::int64_t curves) {
  const std::int64_t values = samples * curves;
  if (values <= kCurvePoints) return 1;
  return (2 * values + kCurvePoints - 1) / kCurvePoints;
}

std::vector<double> KeepPeaks(std::span<const double> values, int samples_per_bucket) {
  if (samples_per_bucket <= 1) return {values.begin(), values.end()};
  const std::size_t size = samples_per_bucket;
  std::vector<double> points;
  points.reserve(2 * (values.size() / size + 1));
  for (std::size_t begin = 0; begin < values.size(); begin += size) {
    const auto [first, second] =
        Extremes(values.subspan(begin, std::min(size, values.size() - begin)));
    points.push_back(first);
    points.push_back(second);
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
    const std::int64_t now = std::llround(std::clamp(steps, -kLargestSteps, kLargestSteps));
    const std::int64_t change = now - last;
    last = now;
    const auto doubled = static_cast<std::uint64_t>(change) << 1;
    AppendGroupsOfSevenBits((change < 0 ? ~doubled : doubled) + 1, bytes);
  }
  return Base64(bytes);
}

}  // namespace gauntlet::sim
