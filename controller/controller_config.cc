#include "controller/controller_config.h"

#include <array>
#include <string_view>

namespace gauntlet::controller {

void ControllerConfig::Visit(SettingsVisitor& visitor) {
  VisitList(visitor,
            {.key = "filter",
             .help = "one filter, or a list of filters that are applied in this order; a filter "
                     "is its kind, or a group with the kind and its settings"},
            filters);
  static constexpr std::array<std::string_view, 2> kOn = {"counts", "angle"};
  VisitEnum(visitor,
            {.key = "filter_on",
             .help = "counts: filter the converter's counts, then linearise (the paper); angle: "
                     "linearise first"},
            kOn, filter_on);
  static constexpr std::array<std::string_view, 2> kAt = {"sample", "event"};
  VisitEnum(visitor,
            {.key = "filter_at",
             .help = "sample: the filter steps at every sample; event: once per command frame, on "
                     "the newest sample"},
            kAt, filter_at);
  visitor.Flag({.key = "coupling_compensation",
                .help = "undo the coupling of cables that cross several joints"},
               coupling_compensation);
  VisitGroup(visitor, {.key = "linearisation", .help = "from counts to bending angles"},
             linearisation);
  VisitGroup(visitor, {.key = "prediction", .help = "look ahead to make up for the delay"},
             prediction);
  VisitGroup(visitor, {.key = "motor", .help = "how commands become whole motor counts"}, motor);
  VisitGroup(visitor, {.key = "untrusted", .help = "which samples are not trusted"}, untrusted);
}

}  // namespace gauntlet::controller
