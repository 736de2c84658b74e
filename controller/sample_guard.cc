#include "controller/sample_guard.h"

#include <algorithm>
#include <utility>

namespace gauntlet::controller {

SampleGuard::SampleGuard(std::vector<double> start_counts, double full_scale_counts)
    : start_counts_(std::move(start_counts)),
      trusted_counts_(start_counts_),
      untrusted_samples_(start_counts_.size(), 0),
      seen_(start_counts_.size(), 0),
      full_scale_counts_(full_scale_counts) {}

void SampleGuard::Reset() noexcept {
  std::copy(start_counts_.begin(), start_counts_.end(), trusted_counts_.begin());
  std::fill(untrusted_samples_.begin(), untrusted_samples_.end(), 0);
  std::fill(seen_.begin(), seen_.end(), 0);
}

}  // namespace gauntlet::controller
