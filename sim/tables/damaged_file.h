#pragma once

#include <string>

#include "sim/base/error.h"

namespace gauntlet::sim {

/// For readers of bytes, which do not know the name of their file.
[[noreturn]] inline void FailAsDamaged(const std::string& what) {
  throw UserError("is damaged: " + what);
}

}  // namespace gauntlet::sim
