#include "sim/glove/noise/noise_config.h"

#include <array>
#include <string_view>

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 2> kKindNames = {"none", "box_muller"};

}  // namespace

double NoiseConfig::VarianceCounts2(int channel) const {
  const auto index = static_cast<std::size_t>(channel);
  if (variance_counts2.empty()) return variance_scale * kPaperVarianceCounts2[index];
  if (variance_counts2.size() == 1) return variance_scale * variance_counts2[0];
  return variance_scale * variance_counts2.at(index);
}

void NoiseConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::VisitEnum(visitor, {.key = "kind", .help = "generator of white Gaussian noise"},
                        kKindNames, kind);
  if (kind == WhiteNoiseKind::kNone) return;
  visitor.Numbers(
      {.key = "variance_counts2",
       .help = "one number or 18, in counts of a 10-bit converter; empty: the paper's R",
       .min = 0,
       .max = 1e6},
      variance_counts2);
  visitor.Number({.key = "variance_scale", .help = "factor on all variances", .min = 0, .max = 1e6},
                 variance_scale);
}

}  // namespace gauntlet::sim
