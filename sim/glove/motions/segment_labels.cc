#include "sim/glove/motions/segment_labels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gauntlet::sim {
namespace {

constexpr double kRestRadS = 2.0 * kRadPerDeg;
constexpr double kFastRadS = 40.0 * kRadPerDeg;
constexpr double kShortestRestS = 0.1;
constexpr double kOnsetS = 0.2;
constexpr double kReversalS = 0.1;
// Speeds are taken over this time, so that the last bit of a recording is no movement.
constexpr double kSpeedStepS = 0.01;

enum Label : std::uint8_t { kSlow, kFast, kReversal, kOnset, kRest };
constexpr const char* kLabelNames[] = {"slow", "fast", "reversal", "onset", "rest"};

/// Change of one channel around sample i, per second.
double SpeedAt(const Signal& angle_rad, Eigen::Index i, Eigen::Index c, Eigen::Index half,
               double rate_hz) {
  const Eigen::Index before = std::max<Eigen::Index>(i - half, 0);
  const Eigen::Index after = std::min(i + half, angle_rad.rows() - 1);
  return (angle_rad(after, c) - angle_rad(before, c)) * rate_hz /
         static_cast<double>(std::max<Eigen::Index>(after - before, 1));
}

/// Root mean square over the channels that move at all of their speeds [rad/s], sample by sample.
Eigen::VectorXd HandSpeed(const Signal& angle_rad, const Eigen::RowVectorXd& ranges,
                          Eigen::Index half, double rate_hz) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(angle_rad.rows());
  double moving = 0.0;
  for (Eigen::Index c = 0; c < angle_rad.cols(); ++c) {
    if (ranges[c] == 0.0) continue;
    moving += 1.0;
    for (Eigen::Index i = 0; i < angle_rad.rows(); ++i) {
      const double speed = SpeedAt(angle_rad, i, c, half, rate_hz);
      squares[i] += speed * speed;
    }
  }
  return (squares / moving).cwiseSqrt();
}

void Paint(std::vector<Label>& labels, std::int64_t begin, std::int64_t end, Label label) {
  const auto size = static_cast<std::int64_t>(labels.size());
  for (std::int64_t i = std::max<std::int64_t>(begin, 0); i < std::min(end, size); ++i) {
    auto& place = labels[static_cast<std::size_t>(i)];
    place = std::max(place, label);
  }
}

}  // namespace

std::vector<MotionSegment> LabelBySpeed(const Signal& angle_rad, double rate_hz) {
  const Eigen::Index samples = angle_rad.rows();
  const Eigen::RowVectorXd ranges = angle_rad.colwise().maxCoeff() - angle_rad.colwise().minCoeff();
  Eigen::Index leader = 0;
  if (ranges.maxCoeff(&leader) == 0.0) return {{"rest", 0, static_cast<int>(samples)}};
  const auto half = std::max<Eigen::Index>(1, std::lround(0.5 * kSpeedStepS * rate_hz));

  const Eigen::VectorXd speed = HandSpeed(angle_rad, ranges, half, rate_hz);
  const auto at = [rate_hz](double seconds) { return std::lround(seconds * rate_hz); };
  std::vector<Label> labels(static_cast<std::size_t>(samples), kSlow);
  double before = 0.0;
  for (Eigen::Index i = 0; i < samples; ++i) {
    labels[static_cast<std::size_t>(i)] = speed[i] < kFastRadS ? kSlow : kFast;
    const double leading = SpeedAt(angle_rad, i, leader, half, rate_hz);
    if (leading * before < 0.0) {
      Paint(labels, i - at(kReversalS), i + at(kReversalS), kReversal);
    }
    if (leading != 0.0) before = leading;
  }
  for (Eigen::Index begin = 0; begin < samples;) {
    Eigen::Index end = begin;
    while (end < samples && speed[end] < kRestRadS) ++end;
    if (end - begin >= at(kShortestRestS)) {
      Paint(labels, begin, end, kRest);
      Paint(labels, end, end + at(kOnsetS), kOnset);
    }
    begin = std::max(end, begin + 1);
  }

  std::vector<MotionSegment> segments;
  for (int i = 0; i < static_cast<int>(samples); ++i) {
    const char* name = kLabelNames[labels[static_cast<std::size_t>(i)]];
    if (segments.empty() || segments.back().label != name) segments.push_back({name, i, i});
    segments.back().end = i + 1;
  }
  return segments;
}

}  // namespace gauntlet::sim
