#include "sim/base/hash.h"

#include <fmt/format.h>

namespace gauntlet::sim {

std::string Hash::Text() const { return fmt::format("{:016x}", value_); }

}  // namespace gauntlet::sim
