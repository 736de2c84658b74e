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
  if (rows_ <= kRowsForRate) {
    first_intervals_s_.push_back(interval_s);
    usual_s_ = controller::MedianOf(first_intervals_s_);
    sum_s_ = counted_ = 0.0;
    for (const double first_s : first_intervals_s_) CountUsual(first_s);
  } else {
    CountUsual(interval_s);
  }
}

void RowClock::CountUsual(double interval_s) {
  if (!IsNear(interval_s, usual_s_)) return;
  sum_s_ += interval_s;
  ++counted_;
}

double RowClock::RateHz() const { return counted_ > 0.0 ? counted_ / sum_s_ : controller::kNaN; }

}  // namespace gauntlet::sim
