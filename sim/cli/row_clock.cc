#include "sim/cli/row_clock.h"

#include <cmath>

#include "controller/calibration/robust_statistics.h"
#include "controller/number.h"

namespace gauntlet::sim {
namespace {

bool IsNear(double interval_s, double usual_s) {
  return interval_s > 0.5 * usual_s && interval_s < 1.5 * usual_s;
}

}  // namespace

bool RowClock::Add(double time) {
  if (!std::isfinite(time) || time <= last_) return false;
  if (rows_++ > 0) Count((time - last_) * scale_s_);
  last_ = time;
  return true;
}

void RowClock::Count(double interval_s) {
  if (usual_s_ == 0.0) {
    first_intervals_s_.push_back(interval_s);
    if (rows_ < kRowsForRate) return;
    usual_s_ = controller::MedianOf(first_intervals_s_);
    for (const double first_s : first_intervals_s_) {
      if (!IsNear(first_s, usual_s_)) continue;
      sum_s_ += first_s;
      ++counted_;
    }
  } else if (IsNear(interval_s, usual_s_)) {
    sum_s_ += interval_s;
    ++counted_;
  }
}

double RowClock::RateHz() const {
  if (counted_ > 0.0) return counted_ / sum_s_;
  if (first_intervals_s_.empty()) return controller::kNaN;
  const double usual_s = controller::MedianOf(first_intervals_s_);
  double sum_s = 0.0;
  double counted = 0.0;
  for (const double interval_s : first_intervals_s_) {
    if (!IsNear(interval_s, usual_s)) continue;
    sum_s += interval_s;
    ++counted;
  }
  return counted / sum_s;
}

}  // namespace gauntlet::sim
