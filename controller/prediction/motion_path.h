#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "controller/assert.h"
#include "controller/filters/filter.h"
#include "controller/prediction/prediction_config.h"

namespace gauntlet::controller {

/// Expected angle of each channel at several times: as the prediction says, one event later, two
/// events later, and so on: by one predictor for all later rows, to which each is further channels
/// with a longer horizon. Without a prediction all stay where they are.
///
/// Shapes: rows of one value per channel. Units: rad.
/// Errors: SettingError for a prediction that cannot look so far, or has no horizon to change.
class MotionPath {
 public:
  /// With 0 rows it does nothing.
  MotionPath(const PredictionConfig& config, int channel_count, double rate_hz, int rows,
             double event_period_ms);

  int row_count() const noexcept { return row_count_; }
  std::span<const double> Row(int row) const noexcept {
    GAUNTLET_ASSERT(0 <= row && row < row_count_);
    return {rows_rad_.data() + std::ptrdiff_t{row} * channel_count_,
            static_cast<std::size_t>(channel_count_)};
  }

  /// `now_rad` is what the first row, the prediction itself, has made of `angle_rad`.
  void Step(std::span<const double> angle_rad, std::span<const double> now_rad) noexcept;
  /// The channel stays here.
  void Hold(int channel, double angle_rad) noexcept;
  void Reset() noexcept;
  void ResetChannel(int channel) noexcept;
  /// Goes on where another one stands; one that cannot (see Filter::SwapMemory), or whose steps
  /// were others, starts at these angles.
  void SwapMemory(MotionPath& from, bool same_step, std::span<const double> angle_rad) noexcept;

 private:
  void RepeatInput(std::span<const double> angle_rad) noexcept;

  int channel_count_;
  int row_count_;
  std::unique_ptr<Filter> later_;  // of all rows but the first; may be null
  std::vector<double> rows_rad_;
  std::vector<double> later_input_rad_;  // the same angles for each of them
};

}  // namespace gauntlet::controller
