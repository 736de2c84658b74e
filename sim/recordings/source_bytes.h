#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "sim/recordings/text_lines.h"

namespace gauntlet::sim {

/// The bytes of a source up to its end, or the first `most` of them.
inline std::string BytesOf(const TextLines::Source& source, std::size_t most = SIZE_MAX) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::string bytes;
  for (std::size_t got = 1; got > 0 && bytes.size() < most;) {
    const std::size_t size = bytes.size();
    bytes.resize(std::min(size + kBlock, most));
    got = source(bytes.data() + size, bytes.size() - size);
    bytes.resize(size + got);
  }
  return bytes;
}

}  // namespace gauntlet::sim
