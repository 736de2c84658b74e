#include "controller/angle_estimator.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "controller/assert.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/kalman_noise.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {
namespace {

/// The middle of each channel's two known poses.
std::vector<double> MiddleOf(const GloveCalibration& glove) {
  std::vector<double> middle_rad;
  for (std::size_t i = 0; i < glove.low_angle_rad.size(); ++i) {
    middle_rad.push_back(0.5 * (glove.low_angle_rad[i] + glove.high_angle_rad[i]));
  }
  return middle_rad;
}

/// The paper's R and the default limits of a motion are in counts; a filter of angles that is not
/// given others would be far off.
void CheckUnits(const FilterConfig& filter, FilterOn filter_on) {
  if (filter_on == FilterOn::kCounts) return;
  if (const auto* limits = std::get_if<JerkLimitConfig>(&filter.settings)) {
    if (limits->max_jerk_per_s3 != JerkLimitConfig{}.max_jerk_per_s3) return;
    throw SettingError("max_jerk_per_s3",
                       "must be given with filter_on angle, in rad/s^3: the default is in counts");
  }
  const std::vector<double>* r = std::visit(
      [](const auto& settings) { return MeasurementVarianceOf(settings); }, filter.settings);
  if (r == nullptr || !IsDefaultMeasurementVariance(*r)) return;
  throw SettingError("r",
                     "must be given with filter_on angle, in rad^2: the default is the paper's, in "
                     "counts^2");
}

/// How often filters step.
double StepRate(const ControllerConfig& config, const Timing& timing) {
  return config.filter_at == FilterAt::kSample ? timing.sample_rate_hz() : timing.event_rate_hz();
}

}  // namespace

AngleEstimator::AngleEstimator(const RobotConfig& robot, const ControllerConfig& config,
                               int path_rows)
    : filter_on_(config.filter_on),
      step_rate_hz_(StepRate(config, robot.timing)),
      linearisation_(
          MakeLinearisation(config.linearisation, robot.glove, robot.glove.channel_names)),
      path_(WithinSetting("prediction",
                          [&] {
                            return MotionPath(config.prediction, linearisation_->channel_count(),
                                              step_rate_hz_, path_rows,
                                              robot.timing.event_period_ms);
                          })),
      middle_rad_(MiddleOf(robot.glove)),
      active_(robot.glove.channel_names.size(), 1),
      held_rad_(active_.size()),
      filtered_rad_(active_.size()),
      predicted_rad_(active_.size()) {
  GAUNTLET_ASSERT(path_rows >= 0);
  // A chain of thousands, which aliases of YAML make of a few letters, would take all memory.
  constexpr std::size_t kMostFilters = 64;
  if (config.filters.size() > kMostFilters) {
    throw SettingError("filter", "has " + std::to_string(config.filters.size()) +
                                     " filters, must have at most " + std::to_string(kMostFilters));
  }
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    chain_.push_back(WithinSetting("filter[" + std::to_string(i) + "]", [&] {
      CheckUnits(config.filters[i], config.filter_on);
      return MakeFilter(config.filters[i], robot.glove.channel_names, step_rate_hz_);
    }));
  }
  predictor_ = WithinSetting("prediction", [&] {
    return MakePredictor(config.prediction, channel_count(), step_rate_hz_);
  });
}

void AngleEstimator::Filtered(std::span<const double> input, std::span<double> output) noexcept {
  if (chain_.empty() && input.data() != output.data()) {
    std::copy(input.begin(), input.end(), output.begin());
  }
  const std::size_t channels = active_.size();
  for (const auto& filter : chain_) {
    for (std::size_t at = 0; at < output.size(); at += channels) {
      filter->Step(input.subspan(at, channels), output.subspan(at, channels));
    }
    input = output;
  }
}

void AngleEstimator::Step(std::span<const double> counts,
                          std::span<double> predicted_rad) noexcept {
  GAUNTLET_ASSERT(!counts.empty() && counts.size() % active_.size() == 0);
  GAUNTLET_ASSERT(predicted_rad.size() == counts.size());
  GAUNTLET_ASSERT(predicted_rad.data() != counts.data());
  if (filter_on_ == FilterOn::kCounts) {
    Filtered(counts, predicted_rad);
    linearisation_->ToAngles(predicted_rad, predicted_rad);
  } else {
    linearisation_->ToAngles(counts, predicted_rad);
    Filtered(predicted_rad, predicted_rad);
  }
  Finish(predicted_rad);
}

void AngleEstimator::StepLinearised(std::span<const double> counts,
                                    std::span<const double> linearised_rad) noexcept {
  GAUNTLET_ASSERT(counts.size() == active_.size() && linearised_rad.size() == active_.size());
  if (filter_on_ == FilterOn::kCounts) return Step(counts, predicted_rad_);
  Filtered(linearised_rad, predicted_rad_);
  Finish(predicted_rad_);
}

void AngleEstimator::Finish(std::span<double> predicted_rad) noexcept {
  const std::size_t channels = active_.size();
  const std::span<double> last = predicted_rad.last(channels);
  if (predictor_ || path_.row_count() > 0 || inactive_count_ > 0) {
    for (std::size_t at = 0; at < predicted_rad.size(); at += channels) {
      Predict(predicted_rad.subspan(at, channels));
    }
  } else {
    std::copy(last.begin(), last.end(), filtered_rad_.begin());
  }
  if (last.data() != predicted_rad_.data()) {
    std::copy(last.begin(), last.end(), predicted_rad_.begin());
  }
}

void AngleEstimator::Predict(std::span<double> angle_rad) noexcept {
  std::copy(angle_rad.begin(), angle_rad.end(), filtered_rad_.begin());
  if (inactive_count_ > 0) HoldInactiveChannels(angle_rad);  // also for those of other channels
  if (predictor_) predictor_->Step(angle_rad, angle_rad);
  path_.Step(filtered_rad_, angle_rad);
  if (inactive_count_ > 0) HoldInactiveChannels(angle_rad);
}

void AngleEstimator::HoldInactiveChannels(std::span<double> angle_rad) noexcept {
  for (std::size_t i = 0; i < active_.size(); ++i) {
    if (active_[i] == 1) continue;
    angle_rad[i] = held_rad_[i];
    path_.Hold(static_cast<int>(i), held_rad_[i]);
  }
}

void AngleEstimator::StartChannel(int channel) noexcept {
  GAUNTLET_ASSERT(0 <= channel && channel < channel_count());
  for (const auto& filter : chain_) filter->ResetChannel(channel);
  if (predictor_) predictor_->ResetChannel(channel);
  path_.ResetChannel(channel);
}

void AngleEstimator::SetChannelActive(int channel, bool on) noexcept {
  GAUNTLET_ASSERT(0 <= channel && channel < channel_count());
  const auto index = static_cast<std::size_t>(channel);
  if (on == (active_[index] == 1)) return;
  active_[index] = on ? 1 : 0;
  inactive_count_ += on ? -1 : 1;
  held_rad_[index] = predicted_rad_[index];
  if (on) StartChannel(channel);
}

void AngleEstimator::Place(int channel, double angle_rad) noexcept {
  GAUNTLET_ASSERT(0 <= channel && channel < channel_count());
  predicted_rad_[static_cast<std::size_t>(channel)] = angle_rad;
  path_.Hold(channel, angle_rad);
}

void AngleEstimator::MoveTo(const JointMap& joint_map,
                            std::span<const double> joint_angle_rad) noexcept {
  GAUNTLET_ASSERT(joint_map.channel_count() == channel_count());
  std::copy(middle_rad_.begin(), middle_rad_.end(), predicted_rad_.begin());
  joint_map.ToChannels(joint_angle_rad, predicted_rad_);
  std::copy(predicted_rad_.begin(), predicted_rad_.end(), held_rad_.begin());
}

void AngleEstimator::Reset(std::span<const double> counts) noexcept {
  GAUNTLET_ASSERT(counts.size() == active_.size());
  for (const auto& filter : chain_) filter->Reset();
  if (predictor_) predictor_->Reset();
  path_.Reset();
  linearisation_->ToAngles(counts, filtered_rad_);
  std::copy(filtered_rad_.begin(), filtered_rad_.end(), predicted_rad_.begin());
  HoldInactiveChannels(predicted_rad_);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    path_.Hold(static_cast<int>(i), predicted_rad_[i]);
  }
}

void AngleEstimator::SwapMemory(AngleEstimator& before, std::span<const double> counts) noexcept {
  GAUNTLET_ASSERT(before.active_.size() == active_.size());
  GAUNTLET_ASSERT(counts.size() == active_.size());
  const bool same_step = step_rate_hz_ == before.step_rate_hz_;
  const bool same_unit = filter_on_ == before.filter_on_;
  const std::span<const double> here =
      filter_on_ == FilterOn::kCounts ? counts : before.filtered_rad_;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const bool goes_on = same_step && same_unit && i < before.chain_.size() &&
                         chain_[i]->SwapMemory(*before.chain_[i]);
    if (!goes_on) chain_[i]->StartAt(here);
  }
  if (predictor_) {
    const bool goes_on =
        same_step && before.predictor_ && predictor_->SwapMemory(*before.predictor_);
    if (!goes_on) predictor_->StartAt(before.filtered_rad_);
  }
  path_.SwapMemory(before.path_, same_step, before.filtered_rad_);
  for (std::size_t i = 0; i < active_.size(); ++i) {
    path_.Hold(static_cast<int>(i), before.predicted_rad_[i]);
  }
  std::swap(active_, before.active_);
  std::swap(inactive_count_, before.inactive_count_);
  held_rad_.swap(before.held_rad_);
  filtered_rad_.swap(before.filtered_rad_);
  predicted_rad_.swap(before.predicted_rad_);
}

}  // namespace gauntlet::controller
