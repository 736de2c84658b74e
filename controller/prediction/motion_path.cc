#include "controller/prediction/motion_path.h"

#include <algorithm>

#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// The same prediction, so much farther ahead.
PredictionConfig Later(PredictionConfig config, double by_ms) {
  std::vector<double>* const horizon_ms =
      std::visit([](auto& settings) { return HorizonOf(settings); }, config.settings);
  if (horizon_ms == nullptr) {
    throw SettingError("kind", "is " + std::string(config.kind()) +
                                   ", must be none or one with a horizon_ms for model_predictive");
  }
  for (double& value : *horizon_ms) {
    value += by_ms;
    if (value <= kMostHorizon_ms) continue;
    throw SettingError("horizon_ms", "and what model_predictive plans beyond it are " +
                                         NumberText(value) + ", must be at most " +
                                         NumberText(kMostHorizon_ms));
  }
  return config;
}

}  // namespace

MotionPath::MotionPath(const PredictionConfig& config, int channel_count, double rate_hz, int rows,
                       double event_period_ms)
    : channel_count_(channel_count),
      row_count_(rows),
      rows_rad_(static_cast<std::size_t>(std::ptrdiff_t{rows} * channel_count)) {
  if (std::holds_alternative<NoPredictionConfig>(config.settings)) return;
  for (int row = 1; row < rows; ++row) {
    later_.push_back(MakePredictor(Later(config, row * event_period_ms), channel_count, rate_hz));
  }
}

void MotionPath::Step(std::span<const double> angle_rad, std::span<const double> now_rad) noexcept {
  for (int row = 0; row < row_count_; ++row) {
    const std::span<double> path = {
        rows_rad_.data() + static_cast<std::size_t>(row) * now_rad.size(), now_rad.size()};
    if (row == 0 || later_.empty()) {
      std::copy(now_rad.begin(), now_rad.end(), path.begin());
    } else {
      later_[static_cast<std::size_t>(row - 1)]->Step(angle_rad, path);
    }
  }
}

void MotionPath::Hold(int channel, double angle_rad) noexcept {
  for (int row = 0; row < row_count_; ++row) {
    rows_rad_.data()[std::ptrdiff_t{row} * channel_count_ + channel] = angle_rad;
  }
}

void MotionPath::Reset() noexcept {
  for (const auto& predictor : later_) predictor->Reset();
}

void MotionPath::ResetChannel(int channel) noexcept {
  for (const auto& predictor : later_) predictor->ResetChannel(channel);
}

void MotionPath::TakeMemory(MotionPath& from, bool same_step,
                            std::span<const double> angle_rad) noexcept {
  for (std::size_t i = 0; i < later_.size(); ++i) {
    const bool goes_on =
        same_step && i < from.later_.size() && later_[i]->TakeMemory(*from.later_[i]);
    if (!goes_on) later_[i]->StartAt(angle_rad);
  }
}

}  // namespace gauntlet::controller
