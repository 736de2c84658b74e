#include "controller/prediction/motion_path.h"

#include <algorithm>

#include "controller/assert.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// A value for each channel, behind each other for so many rows, each larger by `more`.
std::vector<double> Rows(std::string_view key, const std::vector<double>& values, int channel_count,
                         int rows, double more) {
  const Eigen::ArrayXd of_each = PerChannel(key, values, channel_count);
  std::vector<double> all;
  for (int row = 1; row <= rows; ++row) {
    for (const double value : of_each) all.push_back(value + row * more);
  }
  return all;
}

/// Prediction with these settings for rows that look one, two, .. events farther ahead.
template <class Settings>
std::unique_ptr<Filter> MakeLater(Settings settings, int channel_count, double rate_hz, int rows,
                                  double event_period_ms) {
  constexpr bool kIsFitted = requires { settings.weights; };
  if constexpr (requires { settings.horizon_ms; } && !kIsFitted) {
    settings.horizon_ms =
        Rows("horizon_ms", settings.horizon_ms, channel_count, rows, event_period_ms);
    const double farthest_ms = std::ranges::max(settings.horizon_ms);
    if (farthest_ms > kMostHorizon_ms) {
      throw SettingError("horizon_ms", "and what model_predictive plans beyond it are " +
                                           NumberText(farthest_ms) + ", must be at most " +
                                           NumberText(kMostHorizon_ms));
    }
    if constexpr (requires { settings.r_deg2; }) {
      settings.r_deg2 = Rows("r_deg2", settings.r_deg2, channel_count, rows, 0.0);
    }
    const int all = rows * channel_count;
    if constexpr (requires { MakePredictor(settings, all, rate_hz, rows); }) {
      return MakePredictor(settings, all, rate_hz, rows);
    } else {
      return MakePredictor(settings, all, rate_hz);
    }
  } else {
    throw SettingError(
        "kind", "is " + std::string(Settings::kKind) +
                    ", must be none or one whose horizon_ms may be changed, for model_predictive");
  }
}

}  // namespace

MotionPath::MotionPath(const PredictionConfig& config, int channel_count, double rate_hz, int rows,
                       double event_period_ms)
    : channel_count_(channel_count),
      row_count_(rows),
      rows_rad_(static_cast<std::size_t>(std::ptrdiff_t{rows} * channel_count)) {
  if (rows < 2 || std::holds_alternative<NoPredictionConfig>(config.settings)) return;
  later_ = std::visit(
      [&](const auto& settings) {
        return MakeLater(settings, channel_count, rate_hz, rows - 1, event_period_ms);
      },
      config.settings);
  later_input_rad_.resize(rows_rad_.size() - static_cast<std::size_t>(channel_count));
}

void MotionPath::RepeatInput(std::span<const double> angle_rad) noexcept {
  for (auto to = later_input_rad_.begin(); to != later_input_rad_.end();) {
    to = std::copy(angle_rad.begin(), angle_rad.end(), to);
  }
}

void MotionPath::Step(std::span<const double> angle_rad, std::span<const double> now_rad) noexcept {
  GAUNTLET_ASSERT(std::ssize(angle_rad) == channel_count_ && std::ssize(now_rad) == channel_count_);
  if (row_count_ == 0) return;
  auto later = std::copy(now_rad.begin(), now_rad.end(), rows_rad_.begin());
  if (later_) {
    RepeatInput(angle_rad);
    later_->Step(later_input_rad_, {later, rows_rad_.end()});
    return;
  }
  while (later != rows_rad_.end()) later = std::copy(now_rad.begin(), now_rad.end(), later);
}

void MotionPath::Hold(int channel, double angle_rad) noexcept {
  GAUNTLET_ASSERT(0 <= channel && channel < channel_count_);
  for (int row = 0; row < row_count_; ++row) {
    rows_rad_.data()[std::ptrdiff_t{row} * channel_count_ + channel] = angle_rad;
  }
}

void MotionPath::Reset() noexcept {
  if (later_) later_->Reset();
}

void MotionPath::ResetChannel(int channel) noexcept {
  if (!later_) return;
  for (int at = channel; at < later_->channel_count(); at += channel_count_) {
    later_->ResetChannel(at);
  }
}

void MotionPath::SwapMemory(MotionPath& from, bool same_step,
                            std::span<const double> angle_rad) noexcept {
  if (!later_ || (same_step && from.later_ && later_->SwapMemory(*from.later_))) return;
  RepeatInput(angle_rad);
  later_->StartAt(later_input_rad_);
}

}  // namespace gauntlet::controller
