#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "sim/base/error.h"
#include "sim/tables/text_lines.h"

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

/// The bytes of a text that its format needs whole. Errors: UserError with `name` as its place for
/// more than 512 MB.
inline std::string WholeTextOf(const TextLines::Source& source, const std::string& name) {
  constexpr std::size_t kMost = 512'000'000;
  std::string bytes = BytesOf(source, kMost + 1);
  if (bytes.size() > kMost) {
    throw UserError({.place = name,
                     .problem = "has more than 512 MB, the limit of a text that is read whole; "
                                "cut it into parts"});
  }
  return bytes;
}

/// `head`, then the bytes of `rest`, if there is one.
inline TextLines::Source WithHead(std::string head, TextLines::Source rest) {
  return [head = std::move(head), given = std::size_t{0}, rest = std::move(rest)](
             char* buffer, std::size_t size) mutable {
    if (given == head.size()) return rest ? rest(buffer, size) : 0;
    const std::size_t count = head.copy(buffer, size, given);
    given += count;
    return count;
  };
}

}  // namespace gauntlet::sim
