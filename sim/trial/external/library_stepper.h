#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "controller/filters/external_filter.h"
#include "sim/trial/external/stepper.h"

namespace gauntlet::sim {

/// The shared library of an external filter. Errors: SettingError `library` or `folder` if it is
/// not there.
std::filesystem::path FindLibrary(const controller::ExternalConfig& config);

/// Loads the shared library of an external filter (controller/c_api/gauntlet_filter.h); its code
/// runs in this process from now on. Returns what makes a filter of it.
/// Errors: SettingError `library` for one that is not there, cannot be loaded or is no filter. Of
/// what is returned: SettingError for facts that the filter refuses.
std::function<std::unique_ptr<Stepper>(const FilterFacts&)> LoadLibrary(
    const controller::ExternalConfig& config);

}  // namespace gauntlet::sim
