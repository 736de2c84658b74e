#include "sim/glove/noise/noise_config.h"

#include <Eigen/Cholesky>
#include <array>
#include <string>
#include <string_view>

#include "sim/base/channels.h"

namespace gauntlet::sim {
namespace {

constexpr std::array<std::string_view, 3> kKindNames = {"none", "box_muller", "galton"};

void VisitGalton(controller::SettingsVisitor& visitor, NoiseConfig& config) {
  visitor.Integer({"galton_rows", "rows of pins", 1, 4096}, config.galton_rows);
  visitor.Integer({"galton_balls", "balls whose mean place makes one value", 1, 64},
                  config.galton_balls);
}

}  // namespace

double NoiseConfig::VarianceCounts2(int channel) const {
  const auto index = static_cast<std::size_t>(channel);
  if (!covariance_counts2.empty()) {
    const std::size_t place = PlaceInList(index, covariance_channels());
    return variance_scale * covariance_counts2.at(place * (covariance_channels() + 1));
  }
  if (variance_counts2.empty()) {
    return variance_scale *
           kPaperVarianceCounts2[PlaceInList(index, std::size(kPaperVarianceCounts2))];
  }
  return variance_scale * variance_counts2.at(PlaceInList(index, variance_counts2.size()));
}

std::size_t NoiseConfig::covariance_channels() const {
  const std::size_t defaults = GloveChannels().size();
  return covariance_counts2.size() == defaults * defaults ? defaults : KnownChannels().size();
}

void NoiseConfig::Check() const {
  const std::size_t channels = covariance_channels();
  if (!variance_counts2.empty()) {
    CheckListOfChannels("noise.variance_counts2", variance_counts2.size());
  }
  if (covariance_counts2.empty()) return;
  const std::string key = "noise.covariance_counts2";
  if (covariance_counts2.size() != channels * channels) {
    throw controller::SettingError(key,
                                   "has " + std::to_string(covariance_counts2.size()) +
                                       " values, must have 324 (18 rows of 18), or 484 with the "
                                       "end joints");
  }
  const Eigen::Map<const Eigen::MatrixXd> matrix(covariance_counts2.data(),
                                                 static_cast<Eigen::Index>(channels),
                                                 static_cast<Eigen::Index>(channels));
  if (matrix != matrix.transpose()) throw controller::SettingError(key, "is not symmetric");
  if (Eigen::LLT<Eigen::MatrixXd>(matrix).info() != Eigen::Success) {
    throw controller::SettingError(key, "is not positive definite");
  }
}

void NoiseConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::VisitEnum(visitor, {"kind", "generator of white Gaussian noise"}, kKindNames, kind);
  if (kind != WhiteNoiseKind::kNone) {
    visitor.Numbers({"variance_counts2",
                     "one number, or 18 or 22 in the order of the channels, in counts of a 10-bit "
                     "converter; empty: the paper's R",
                     0, 1e6},
                    variance_counts2);
    visitor.Numbers(
        {"covariance_counts2",
         "18 rows of 18, or 22 of 22, in one list, if channels are correlated; else empty", -1e6,
         1e6},
        covariance_counts2);
    visitor.Number({"variance_scale", "factor on all variances", 0, 1e6}, variance_scale);
  }
  if (kind == WhiteNoiseKind::kGalton) VisitGalton(visitor, *this);
  visitor.Number({"pink_variance_counts2", "variance of 1/f noise in each channel", 0, 1e6},
                 pink_variance_counts2);
  visitor.Number({"mains_amplitude_counts", "amplitude of mains hum", 0, 1000},
                 mains_amplitude_counts);
  visitor.Number({"mains_hz", "mains frequency", 10, 400}, mains_hz);
}

}  // namespace gauntlet::sim
