#include <fmt/format.h>

#include <cmath>

#include "sim/settings/libraries/library.h"

namespace gauntlet::sim {
namespace {

using controller::ExponentialConfig;

std::string AlphaOf(const PlainFilter& filter) {
  return LineNumber(std::get<ExponentialConfig>(filter.settings).alpha);
}
std::string DexRetargetingLines(const PlainFilter& filter) {
  return fmt::format("retargeting:\n  low_pass_alpha: {}\n", AlphaOf(filter));
}
std::string OpenTeleVisionLines(const PlainFilter& filter) {
  return fmt::format("left:\n  low_pass_alpha: {0}\nright:\n  low_pass_alpha: {0}\n",
                     AlphaOf(filter));
}
std::string WujiLines(const PlainFilter& filter) {
  return fmt::format("retarget:\n  lp_alpha: {}\n", AlphaOf(filter));
}

/// y += alpha (x - y) once for each frame of a loop, whatever its rate.
class LoopLike : public LikeSettings {
 public:
  explicit LoopLike(std::string_view key) : key_(key) {}

  void Visit(controller::SettingsVisitor& visitor) override {
    visitor.Number({.key = key_,
                    .help = "weight of the new sample; 1 is no filter",
                    .min = 1e-9,
                    .max = 1,
                    .required = true},
                   alpha_);
    visitor.Number({.key = "loop_hz",
                    .help = "frames per second of the loop that has it; 0: as the glove",
                    .min = 0,
                    .max = 1e6},
                   loop_hz_);
  }
  /// Keeps the decay in time: (1 - alpha)^(loop_hz_ / rate_hz) is left after a sample.
  controller::FilterSettings At(double rate_hz) const override {
    if (loop_hz_ == 0.0 || loop_hz_ == rate_hz) return ExponentialConfig{.alpha = alpha_};
    return ExponentialConfig{.alpha = -std::expm1(std::log1p(-alpha_) * loop_hz_ / rate_hz)};
  }
  bool DependsOnRate() const override { return loop_hz_ != 0.0; }

 private:
  std::string_view key_;
  double alpha_ = 0.1;
  double loop_hz_ = 0.0;
};

class LowPassAlphaLike final : public LoopLike {
 public:
  LowPassAlphaLike() : LoopLike("low_pass_alpha") {}
};
class LpAlphaLike final : public LoopLike {
 public:
  LpAlphaLike() : LoopLike("lp_alpha") {}
};

constexpr std::string_view kBehindRetargeting =
    "It filters the angles of the robot's joints behind the retargeting, not those of the glove.";
constexpr std::string_view kNoRate = "It has no rate: another rate of frames needs another value.";

}  // namespace

Library DexRetargeting() {
  return {.name = "dex-retargeting",
          .package = "dex-retargeting 0.5.0 (PyPI)",
          .comment = "#",
          .kinds = {ExponentialConfig::kKind},
          .differences = {kBehindRetargeting, kNoRate,
                          "A value above 1 or below 0 means no filter, and 0 one that never "
                          "moves."},
          .lines = DexRetargetingLines,
          .like = MakeLike<LowPassAlphaLike>,
          .like_kind = ExponentialConfig::kKind};
}

Library OpenTeleVision() {
  return {.name = "open-television",
          .package = "Open-TeleVision of 2024-09-26 (GitHub)",
          .comment = "#",
          .kinds = {ExponentialConfig::kKind},
          .differences = {"The file is teleop/inspire_hand.yml, the filter that of the "
                          "dex_retargeting 0.1.1 that it installs.",
                          kBehindRetargeting, kNoRate},
          .lines = OpenTeleVisionLines,
          .like = MakeLike<LowPassAlphaLike>,
          .like_kind = ExponentialConfig::kKind};
}

Library WujiRetargeting() {
  return {.name = "wuji-retargeting",
          .package = "wuji-retargeting 2026.6.27 (GitHub)",
          .comment = "#",
          .kinds = {ExponentialConfig::kKind},
          .differences = {kBehindRetargeting, kNoRate,
                          "Input of a Vision Pro is smoothed once more, over five frames, before "
                          "the retargeting."},
          .lines = WujiLines,
          .like = MakeLike<LpAlphaLike>,
          .like_kind = ExponentialConfig::kKind};
}

}  // namespace gauntlet::sim
