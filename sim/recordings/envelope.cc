#include "sim/recordings/envelope.h"

#include <cmath>
#include <numbers>

#include "sim/tables/missing.h"

namespace gauntlet::sim {

double Envelope::Step(double time_s, double value) {
  constexpr double kCutoff_hz = 10.0;
  if (!std::isfinite(value) || !std::isfinite(time_s)) return kMissing;
  const double step_s = time_s - before_s_;
  if (recent_.empty() || !(step_s > 0.0) || step_s > window_s_) {
    recent_.clear();
    filtered_ = 0.0;
  } else {
    const double share = 1.0 / (1.0 + 2.0 * std::numbers::pi * kCutoff_hz * step_s);
    filtered_ = share * (filtered_ + value - before_);
  }
  before_s_ = time_s;
  before_ = value;
  recent_.push_back({time_s, std::abs(filtered_)});
  constexpr double kRounding_s = 1e-9;
  while (recent_.front().time_s <= time_s - window_s_ + kRounding_s) recent_.pop_front();
  double sum = 0.0;
  for (const Rectified& one : recent_) sum += one.value;
  return sum / static_cast<double>(recent_.size());
}

}  // namespace gauntlet::sim
