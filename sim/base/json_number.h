#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace gauntlet::sim {

/// A number as JSON can hold it: null where it is not finite.
inline nlohmann::ordered_json NumberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace gauntlet::sim
