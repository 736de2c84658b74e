#pragma once

#include <string>

namespace gauntlet {

/// The project's root: where tests find scenarios, models and recordings.
std::string SourceDir();

}  // namespace gauntlet
