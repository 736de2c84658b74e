#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "controller/kinds.h"
#include "controller/settings.h"
#include "sim/glove/faults/fault.h"
#include "sim/glove/faults/kinds_of_faults.h"

namespace gauntlet::sim {

/// Every kind of fault that there is. To add one: a struct with its kNature, its occurrence `when`,
/// its own settings and its Apply(), and one entry here.
class FaultSettings
    : public std::variant<SpikeFault, NoiseBurstFault, GainChangeFault, TimeJitterFault,
                          SaturatedFault, StuckFault, DisconnectedFault, DropoutFault,
                          DuplicatedFrameFault, LateFrameFault, OffsetJumpFault> {
 public:
  using variant::variant;
  FaultSettings();
  FaultSettings(const FaultSettings& other);
  FaultSettings(FaultSettings&& other) noexcept;
  FaultSettings& operator=(const FaultSettings& other);
  FaultSettings& operator=(FaultSettings&& other) noexcept;
  ~FaultSettings();
};

/// Something that goes wrong with the glove, again and again: `kind`, when and where, then the
/// settings of that kind.
struct FaultConfig {
  FaultSettings settings;

  std::string_view kind() const { return controller::KindName(settings); }
  FaultOccurrence& when();
  const FaultOccurrence& when() const;
  FaultNature nature() const;
  void Visit(controller::SettingsVisitor& visitor);
};

/// All kinds, in the order of every list.
using FaultKind = controller::Kind<FaultConfig>;
std::span<const FaultKind> FaultKinds();

}  // namespace gauntlet::sim
