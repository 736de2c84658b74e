#include "sim/live/duration_histogram.h"

#include <algorithm>
#include <cmath>

#include "controller/number.h"

namespace gauntlet::sim {
namespace {

constexpr std::int64_t kFineSteps = 50'000;
constexpr std::int64_t kFine_ns = 1'000;
constexpr std::int64_t kCoarse_ns = 1'000'000;
constexpr std::int64_t kFineEnd_ns = kFineSteps * kFine_ns;
constexpr std::int64_t kCoarseSteps = 60'000 - kFineEnd_ns / kCoarse_ns;

std::int64_t LowerEnd_ns(std::int64_t step) {
  return step < kFineSteps ? step * kFine_ns : kFineEnd_ns + (step - kFineSteps) * kCoarse_ns;
}

}  // namespace

DurationHistogram::DurationHistogram()
    : steps_(static_cast<std::size_t>(kFineSteps + kCoarseSteps)) {}

void DurationHistogram::Add(std::int64_t duration_ns) noexcept {
  const std::int64_t duration = std::max<std::int64_t>(0, duration_ns);
  const std::int64_t step = duration < kFineEnd_ns
                                ? duration / kFine_ns
                                : kFineSteps + (duration - kFineEnd_ns) / kCoarse_ns;
  ++steps_[static_cast<std::size_t>(std::min(step, std::ssize(steps_) - 1))];
  ++count_;
  sum_ns_ += duration;
  max_ns_ = std::max(max_ns_, duration);
}

double DurationHistogram::mean_us() const noexcept {
  if (count_ == 0) return controller::kNaN;
  return 1e-3 * static_cast<double>(sum_ns_) / static_cast<double>(count_);
}

double DurationHistogram::max_us() const noexcept {
  return count_ == 0 ? controller::kNaN : 1e-3 * static_cast<double>(max_ns_);
}

double DurationHistogram::Quantile_us(double share) const noexcept {
  if (count_ == 0) return controller::kNaN;
  const double wanted = std::max(1.0, std::ceil(share * static_cast<double>(count_)));
  std::int64_t seen = 0;
  for (std::int64_t step = 0; step < std::ssize(steps_); ++step) {
    seen += steps_[static_cast<std::size_t>(step)];
    if (static_cast<double>(seen) < wanted) continue;
    const bool is_last = step + 1 == std::ssize(steps_);
    return is_last ? max_us()
                   : 1e-3 * static_cast<double>(std::min(LowerEnd_ns(step + 1), max_ns_));
  }
  return max_us();
}

std::vector<std::pair<double, std::int64_t>> DurationHistogram::Steps() const {
  std::vector<std::pair<double, std::int64_t>> steps;
  for (std::int64_t step = 0; step < std::ssize(steps_); ++step) {
    const std::int64_t count = steps_[static_cast<std::size_t>(step)];
    if (count > 0) steps.emplace_back(1e-3 * static_cast<double>(LowerEnd_ns(step)), count);
  }
  return steps;
}

}  // namespace gauntlet::sim
