#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace gauntlet::sim {

/// A hash that distinguishes contents and is the same on every machine: FNV-1a, 64 bits. No
/// protection against attackers.
/// Source: Fowler, Noll, Vo, draft-eastlake-fnv.
class Hash {
 public:
  void Add(std::string_view bytes) {
    for (const char byte : bytes) {
      value_ = (value_ ^ static_cast<unsigned char>(byte)) * 0x100000001B3u;
    }
  }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void Add(std::span<const Number> numbers) {
    Add(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
  }

  std::uint64_t value() const { return value_; }
  /// 16 hexadecimal digits.
  std::string Text() const;

 private:
  std::uint64_t value_ = 0xCBF29CE484222325u;
};

/// Passes all bytes of a file to `add`, block by block. Errors: RunError with the path and the
/// system's reason; Cancelled.
void ReadBlocks(const std::filesystem::path& file,
                const std::function<void(std::string_view bytes)>& add);

/// Hash of a whole file: 16 hexadecimal digits. Errors: as of ReadBlocks().
std::string HashOfFile(const std::filesystem::path& file);

}  // namespace gauntlet::sim
