#include "sim/glove/motions/sequence.h"

#include <algorithm>
#include <string>
#include <utility>

#include "controller/assert.h"
#include "sim/base/channels.h"
#include "sim/glove/motions/motion_config.h"

namespace gauntlet::sim {
namespace {

/// Angle of one channel and its derivatives at one moment.
struct State {
  double angle, velocity, acceleration;
};

/// From three samples in a row, the one in question first; `step_s` is negative backward in time.
State StateFrom(double y0, double y1, double y2, double step_s) {
  return {y0, (-3.0 * y0 + 4.0 * y1 - y2) / (2.0 * step_s),
          (y0 - 2.0 * y1 + y2) / (step_s * step_s)};
}

State StartState(const Signal& angle_rad, Eigen::Index c, double step_s) {
  if (angle_rad.rows() < 3) return {angle_rad(0, c), 0.0, 0.0};
  return StateFrom(angle_rad(0, c), angle_rad(1, c), angle_rad(2, c), step_s);
}

/// State of the motion one sample after its end.
State StateAfter(const Signal& angle_rad, Eigen::Index c, double step_s) {
  const Eigen::Index n = angle_rad.rows();
  if (n < 3) return {angle_rad(n - 1, c), 0.0, 0.0};
  const State end =
      StateFrom(angle_rad(n - 1, c), angle_rad(n - 2, c), angle_rad(n - 3, c), -step_s);
  return {end.angle + step_s * (end.velocity + 0.5 * step_s * end.acceleration),
          end.velocity + step_s * end.acceleration, end.acceleration};
}

/// The polynomial that starts with a given state and ends after `duration_s` with all zero.
class Correction {
 public:
  Correction(const State& start, double duration_s) : duration_s_(duration_s) {
    const double p0 = start.angle;
    const double p1 = start.velocity * duration_s;
    const double p2 = 0.5 * start.acceleration * duration_s * duration_s;
    coefficients_[0] = p0;
    coefficients_[1] = p1;
    coefficients_[2] = p2;
    coefficients_[3] = -10.0 * p0 - 6.0 * p1 - 3.0 * p2;
    coefficients_[4] = 15.0 * p0 + 8.0 * p1 + 3.0 * p2;
    coefficients_[5] = -6.0 * p0 - 3.0 * p1 - p2;
  }
  double At(double t) const {
    const double u = t / duration_s_;
    double value = 0.0;
    for (int k = 5; k >= 0; --k) value = value * u + coefficients_[k];
    return value;
  }

 private:
  double duration_s_;
  double coefficients_[6];
};

/// `below` under `above`.
Signal Stacked(const Signal& above, const Signal& below) {
  Signal result(above.rows() + below.rows(), above.cols());
  for (Eigen::Index c = 0; c < result.cols(); ++c) {
    result.col(c) << above.col(c), below.col(c);
    TrimSignals();
  }
  return result;
}

}  // namespace

void SequenceConfig::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"blend_s", "time in which each part takes over from the one before", 0.02, 5},
                 blend_s);
  controller::VisitList(visitor, {"parts", "motions, each with kind and settings"}, parts);
}

Motion MakeMotion(const SequenceConfig& config, const MotionContext& context) {
  if (config.parts.empty()) {
    throw controller::SettingError("parts", "is empty, must hold at least one motion");
  }
  Motion motion;
  for (std::size_t part = 0; part < config.parts.size(); ++part) {
    MotionContext inner = context;
    inner.part = context.part * 1000 + part + 1;  // unlike any part of another sequence
    if (part > 0) {
      const Eigen::RowVectorXd last = motion.angle_rad.row(motion.angle_rad.rows() - 1);
      inner.start_rad.assign(last.begin(), last.end());
    }
    Motion next = controller::WithinSetting("parts[" + std::to_string(part) + "]", [&] {
      Motion made = SynthesiseMotion(config.parts[part], inner);
      if (made.measured_rad.size() > 0) {
        throw controller::SettingError("use", "is measured, must be truth inside a sequence");
      }
      return made;
    });
    if (part == 0) {
      motion = std::move(next);
    } else {
      AppendMotion(std::move(next), config.blend_s, context.rate_hz, motion);
    }
    context.SampleCount(static_cast<double>(motion.angle_rad.rows()) / context.rate_hz);
  }
  return motion;
}

void AppendMotion(Motion next, double blend_s, double rate_hz, Motion& motion) {
  GAUNTLET_ASSERT(rate_hz > 0.0 && next.angle_rad.cols() == motion.angle_rad.cols());
  GAUNTLET_ASSERT(next.angle_rad.rows() > 0 && motion.angle_rad.rows() > 0);
  const double step_s = 1.0 / rate_hz;
  const Eigen::Index blend =
      std::min(static_cast<Eigen::Index>(blend_s * rate_hz), next.angle_rad.rows());
  for (Eigen::Index c = 0; c < next.angle_rad.cols(); ++c) {
    const State before = StateAfter(motion.angle_rad, c, step_s);
    const State after = StartState(next.angle_rad, c, step_s);
    const Correction correction({before.angle - after.angle, before.velocity - after.velocity,
                                 before.acceleration - after.acceleration},
                                static_cast<double>(blend) * step_s);
    const Channel& joint = KnownChannels()[static_cast<std::size_t>(c)];
    for (Eigen::Index i = 0; i < blend; ++i) {
      // A fast end of the part before could carry the joint beyond its stop.
      next.angle_rad(i, c) =
          std::clamp(next.angle_rad(i, c) + correction.At(static_cast<double>(i) * step_s),
                     joint.min_deg * kRadPerDeg, joint.max_deg * kRadPerDeg);
    }
    TrimSignals();
  }
  const int offset = static_cast<int>(motion.angle_rad.rows());
  for (const Segment& segment : next.segments) {
    motion.segments.push_back({segment.label, segment.begin + offset, segment.end + offset});
  }
  for (MaskedStretch stretch : next.masked) {
    stretch.begin += offset;
    stretch.end += offset;
    motion.masked.push_back(stretch);
  }
  motion.angle_rad = Stacked(motion.angle_rad, next.angle_rad);
  motion.remarks.insert(motion.remarks.end(), next.remarks.begin(), next.remarks.end());
}

}  // namespace gauntlet::sim
