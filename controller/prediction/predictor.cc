#include "controller/prediction/predictor.h"

namespace gauntlet::controller {

PredictionSettings::PredictionSettings() = default;
PredictionSettings::PredictionSettings(const PredictionSettings& other) = default;
PredictionSettings::PredictionSettings(PredictionSettings&& other) noexcept = default;
PredictionSettings& PredictionSettings::operator=(const PredictionSettings& other) = default;
PredictionSettings& PredictionSettings::operator=(PredictionSettings&& other) noexcept = default;
PredictionSettings::~PredictionSettings() = default;

void PredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitKind(visitor, {"kind", "how to look ahead"}, settings);
}

std::span<const PredictionKind> PredictionKinds() { return AllKinds<PredictionConfig>(); }

std::unique_ptr<Filter> MakePredictor(const PredictionConfig& config, int channel_count,
                                      double rate_hz) {
  return std::visit(
      [&](const auto& settings) { return MakePredictor(settings, channel_count, rate_hz); },
      config.settings);
}

}  // namespace gauntlet::controller
