#include "sim/trial/held_filter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "controller/assert.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/vectorise.h"
#include "controller/number.h"
#include "controller/settings.h"

namespace gauntlet::sim {
namespace {

constexpr double kLargest = 1e100;

/// Output of a filter for a few samples at some rate, or the reason why there is none.
struct Outcome {
  std::vector<double> values;
  std::string refusal;
  bool operator==(const Outcome&) const = default;
};

Outcome OutcomeAt(double rate_hz, const controller::FilterConfig& config, int channel_count) {
  constexpr int kSamples = 50;
  Outcome outcome;
  try {
    const auto filter = controller::MakeFilter(config, channel_count, rate_hz);
    std::vector<double> values(static_cast<std::size_t>(channel_count));
    for (int k = 0; k < kSamples; ++k) {
      std::ranges::fill(values, k % 10 < 5 ? 0.0 : k);
      filter->Step(values, values);
      outcome.values.insert(outcome.values.end(), values.begin(), values.end());
    }
  } catch (const controller::SettingError& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}

/// Number of values that a filter must not get.
GAUNTLET_VECTORISED std::int64_t CountBad(const double* values, std::size_t count) {
  std::int64_t bad = 0;
  for (std::size_t i = 0; i < count; ++i) bad += std::abs(values[i]) <= kLargest ? 0 : 1;
  return bad;
}

}  // namespace

HeldFilter::HeldFilter(const controller::FilterConfig& config, int channel_count, double rate_hz)
    : filter_(controller::MakeFilter(config, channel_count, rate_hz)),
      values_(static_cast<std::size_t>(channel_count)),
      started_(static_cast<std::size_t>(channel_count)) {}

void HeldFilter::Step(std::span<const double> input, std::span<double> output) {
  GAUNTLET_ASSERT(input.size() == values_.size() && output.size() == values_.size());
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (std::abs(input[i]) <= kLargest) {
      values_[i] = input[i];
      if (!started_[i]) filter_->ResetChannel(static_cast<int>(i));
      started_[i] = true;
    } else {
      ++held_;
    }
  }
  filter_->Step(values_, output);
  if (all_started_) return;
  all_started_ = true;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    if (started_[i]) continue;
    output[i] = controller::kNaN;
    all_started_ = false;
  }
}

void HeldFilter::StepRows(std::span<const double> input, std::span<double> output) {
  GAUNTLET_ASSERT(input.size() == output.size() && input.size() % values_.size() == 0);
  constexpr std::size_t kRows = 32;  // that stay in the fastest memory between check and filter
  const std::size_t width = values_.size();
  for (std::size_t at = 0; at < input.size();) {
    const std::size_t end = std::min(at + kRows * width, input.size());
    if (all_started_ && CountBad(&input[at], end - at) == 0) {
      std::ranges::copy(input.subspan(end - width, width), values_.begin());
      for (; at < end; at += width) {
        filter_->Step(input.subspan(at, width), output.subspan(at, width));
      }
    } else {
      for (; at < end; at += width) Step(input.subspan(at, width), output.subspan(at, width));
    }
  }
}

bool DependsOnRate(const controller::FilterConfig& config, int channel_count) {
  return OutcomeAt(10.0, config, channel_count) != OutcomeAt(10e3, config, channel_count);
}

}  // namespace gauntlet::sim
