#include <fmt/format.h>

#include <cmath>

#include "sim/settings/libraries/library.h"

namespace gauntlet::sim {
namespace {

using controller::ExponentialConfig;

std::string DexRetargetingLines(const PlainFilter& filter) {
  return fmt::format("retargeting:\n  low_pass_alpha: {}\n",
                     LineNumber(std::get<ExponentialConfig>(filter.settings).alpha));
}

class DexRetargetingLike final : public LikeSettings {
 public:
  void Visit(controller::SettingsVisitor& visitor) override {
    visitor.Number({.key = "low_pass_alpha",
                    .help = "weight of the new sample; 1 is no filter",
                    .min = 1e-9,
                    .max = 1,
                    .required = true},
                   alpha_);
    visitor.Number({.key = "rate_hz",
                    .help = "samples per second of the program that has it; 0: as the glove",
                    .min = 0,
                    .max = 1e6},
                   rate_hz_);
  }
  /// Keeps the decay in time: (1 - alpha)^(rate_hz_ / rate_hz) is left after a sample.
  controller::FilterSettings At(double rate_hz) const override {
    if (rate_hz_ == 0.0 || rate_hz_ == rate_hz) return ExponentialConfig{.alpha = alpha_};
    return ExponentialConfig{.alpha = -std::expm1(std::log1p(-alpha_) * rate_hz_ / rate_hz)};
  }

 private:
  double alpha_ = 0.1;
  double rate_hz_ = 0.0;
};

}  // namespace

Library DexRetargeting() {
  return {.name = "dex-retargeting",
          .package = "dex-retargeting 0.5.0 (PyPI)",
          .comment = "#",
          .kinds = {ExponentialConfig::kKind},
          .differences =
              {"It filters the angles of the robot's joints behind the retargeting, not those of "
               "the glove.",
               "It has no rate: another rate of frames needs another value.",
               "A value above 1 or below 0 means no filter, and 0 one that never moves."},
          .lines = DexRetargetingLines,
          .like = MakeLike<DexRetargetingLike>};
}

}  // namespace gauntlet::sim
