#pragma once

#include <array>
#include <string>
#include <string_view>

#include "sim/settings/libraries/library.h"

namespace gauntlet::sim {

/// Settings of a library's 1 euro filter, whose keys are its own.
class OneEuroLike : public LikeSettings {
 public:
  explicit OneEuroLike(controller::OneEuroConfig::SpeedFrom speed_from)
      : config_{.speed_from = speed_from} {}

  controller::FilterSettings At(double /*rate_hz*/) const override { return config_; }
  std::string unit() const override { return std::string(kUnits[unit_]); }
  std::string_view DependsOnUnit() const override {
    return config_.beta == 0.0 ? "" : "beta is in Hz/(unit/s)";
  }

 protected:
  void VisitValues(controller::SettingsVisitor& visitor, std::string_view min_cutoff,
                   std::string_view derivative_cutoff) {
    visitor.Number({min_cutoff, "cutoff frequency at rest", 1e-6, 1e6}, config_.min_cutoff_hz);
    visitor.Number({"beta", "how fast the cutoff rises with the speed [Hz / (unit / s)]", 0, 1e9},
                   config_.beta);
    visitor.Number({derivative_cutoff, "cutoff frequency of the speed's own low pass", 1e-6, 1e6},
                   config_.derivative_cutoff_hz);
  }
  void VisitUnit(controller::SettingsVisitor& visitor) {
    visitor.Choice({"unit", "of the signal that beta is for"}, kUnits, unit_);
  }

 private:
  // m: coordinates of keypoints, which a stream can have.
  static constexpr std::array<std::string_view, 5> kUnits = {"", "deg", "rad", "counts", "m"};

  controller::OneEuroConfig config_;
  std::size_t unit_ = 0;
};

}  // namespace gauntlet::sim
