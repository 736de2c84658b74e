#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace gauntlet::sim {

/// `whole` with the changes that an input of a fuzzer says, four bytes each: what, where (two
/// bytes, the lower one first) and a value. A file with a structure stays readable for the most
/// part, so that the changes meet what is behind its first bytes.
inline std::string EditedCopy(std::string whole, const std::uint8_t* data, std::size_t size) {
  for (; size >= 4 && !whole.empty(); data += 4, size -= 4) {
    const std::size_t at = (data[1] | data[2] << 8) % whole.size();
    const std::uint8_t value = data[3];
    switch (data[0] % 5) {
      case 0:
        whole[at] = static_cast<char>(value);
        break;
      case 1:
        whole[at] = static_cast<char>(whole[at] ^ 1 << value % 8);
        break;
      case 2:
        whole.erase(at, value + std::size_t{1});
        break;
      case 3:
        whole.insert(at, 1, static_cast<char>(value));
        break;
      default:
        whole.resize(at + value % 2);  // the end is missing
    }
  }
  return whole;
}

}  // namespace gauntlet::sim
