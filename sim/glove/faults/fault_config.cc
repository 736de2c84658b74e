#include "sim/glove/faults/fault_config.h"

namespace gauntlet::sim {

FaultOccurrence& FaultConfig::when() {
  return std::visit([](auto& fault) -> FaultOccurrence& { return fault.when; }, settings);
}

const FaultOccurrence& FaultConfig::when() const {
  return std::visit([](const auto& fault) -> const FaultOccurrence& { return fault.when; },
                    settings);
}

FaultNature FaultConfig::nature() const {
  return std::visit([](const auto& fault) { return fault.kNature; }, settings);
}

FaultSettings::FaultSettings() = default;
FaultSettings::FaultSettings(const FaultSettings& other) = default;
FaultSettings::FaultSettings(FaultSettings&& other) noexcept = default;
FaultSettings& FaultSettings::operator=(const FaultSettings& other) = default;
FaultSettings& FaultSettings::operator=(FaultSettings&& other) noexcept = default;
FaultSettings::~FaultSettings() = default;

void FaultConfig::Visit(controller::SettingsVisitor& visitor) {
  controller::ChooseKind(visitor, {"kind", "what goes wrong"}, settings);
  when().Visit(visitor);
  controller::VisitChosen(visitor, settings);
}

std::span<const FaultKind> FaultKinds() { return controller::AllKinds<FaultConfig>(); }

}  // namespace gauntlet::sim
