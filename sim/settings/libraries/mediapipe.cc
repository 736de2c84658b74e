#include <fmt/format.h>

#include "sim/settings/libraries/library.h"
#include "sim/settings/libraries/one_euro_like.h"

namespace gauntlet::sim {
namespace {

using controller::OneEuroConfig;

std::string MediaPipeLines(const PlainFilter& filter) {
  const auto& config = std::get<OneEuroConfig>(filter.settings);
  if (config.speed_from != OneEuroConfig::SpeedFrom::kRaw) return "";
  return fmt::format(R"(one_euro_filter {{
  frequency: {}
  min_cutoff: {}
  beta: {}
  derivate_cutoff: {}
  disable_value_scaling: true
}}
)",
                     LineNumber(filter.rate_hz), LineNumber(config.min_cutoff_hz),
                     LineNumber(config.beta), LineNumber(config.derivative_cutoff_hz));
}

class MediaPipeLike final : public OneEuroLike {
 public:
  MediaPipeLike() : OneEuroLike(OneEuroConfig::SpeedFrom::kRaw) {}

  void Visit(controller::SettingsVisitor& visitor) override {
    visitor.Number({.key = "frequency",
                    .help = "rate of the first step alone: then the times of the samples decide",
                    .min = 0,
                    .open_range = true},
                   frequency_hz_);
    VisitValues(visitor, "min_cutoff", "derivate_cutoff");
    visitor.Flag({"disable_value_scaling", "beta is not divided by the size of the hand"},
                 no_scaling_);
    VisitUnit(visitor);
  }
  controller::FilterSettings At(double rate_hz) const override {
    if (!no_scaling_) {
      throw controller::SettingError(
          "disable_value_scaling",
          "must be true: else MediaPipe divides the speed by the size of the hand in the image, "
          "which a signal of angles does not have");
    }
    return OneEuroLike::At(rate_hz);
  }

 private:
  double frequency_hz_ = 30.0;
  bool no_scaling_ = false;
};

}  // namespace

Library MediaPipe() {
  return {
      .name = "mediapipe",
      .package = "mediapipe 0.10.21 (PyPI)",
      .comment = "#",
      .kinds = {OneEuroConfig::kKind},
      .fixed = "speed_from: raw",
      .differences =
          {"These are options of a LandmarksSmoothingCalculator.",
           "It smooths coordinates of landmarks, in float. beta here is for the unit above: for "
           "other coordinates it is another number; gauntlet filter smooths them (unit: m).",
           "The intervals are those of the packets' timestamps in whole us."},
      .lines = MediaPipeLines,
      .like = MakeLike<MediaPipeLike>,
      .like_kind = OneEuroConfig::kKind};
}

}  // namespace gauntlet::sim
