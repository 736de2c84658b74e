#pragma once

#include <string>

namespace gauntlet::controller {

/// The key that Controller's constructor names, as the text of a robot has it.
std::string KeyInText(const std::string& key);

}  // namespace gauntlet::controller
