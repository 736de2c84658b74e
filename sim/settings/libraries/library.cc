#include "sim/settings/libraries/library.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/base/nearest_name.h"
#include "sim/base/text.h"

namespace gauntlet::sim {

std::span<const Library> Libraries() {
  static const std::vector<Library> kLibraries = {
      OneEuroOfPypi(),  OneEuroOfNpm(),    MediaPipe(),      DexRetargeting(),
      OpenTeleVision(), WujiRetargeting(), ScipySignal(),    FilterPy(),
      LeRobot(),        PlainC(),          PlainJavaScript()};
  return kLibraries;
}

const Library& FindLibrary(const std::string& name) {
  const auto found = std::ranges::find(Libraries(), name, &Library::name);
  if (found != Libraries().end()) return *found;
  std::vector<std::string> names;
  for (const Library& library : Libraries()) names.emplace_back(library.name);
  throw controller::SettingError("like", fmt::format("is {}, which is no known library{}",
                                                     Shown(name), Suggestion(name, names)));
}

bool HasFilter(const Library& library, const PlainFilter& filter) {
  return std::ranges::find(library.kinds, controller::KindName(filter.settings)) !=
             library.kinds.end() &&
         !library.lines(filter).empty();
}

std::string LineNumber(double value) { return fmt::format("{:.12g}", value); }

}  // namespace gauntlet::sim
