#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace gauntlet::sim {

/// Tells contents apart, the same on every machine: FNV-1a, 64 bits. Not against attackers.
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

/// The same purpose where there is much: XXH64 with seed 0, some ten times as fast.
/// Source: Collet, xxHash fast digest algorithm, 0.1.1 (doc/xxhash_spec.md).
class FastHash {
 public:
  void Add(std::string_view bytes);
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void Add(std::span<const Number> numbers) {
    Add(std::string_view(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()));
  }

  std::uint64_t value() const;
  /// 16 hexadecimal digits.
  std::string Text() const;

 private:
  static constexpr std::size_t kStripe = 32;

  std::uint64_t lanes_[4] = {0x60EA27EEADC0B5D6u, 0xC2B2AE3D27D4EB4Fu, 0u, 0x61C8864E7A143579u};
  std::uint64_t bytes_ = 0;
  char rest_[kStripe] = {};  // what has not filled a stripe
};

/// Of a whole file: 16 hexadecimal digits. Errors: RunError with the path and the system's reason;
/// Cancelled.
std::string HashOfFile(const std::filesystem::path& file);
/// The same as FastHash.
std::string FastHashOfFile(const std::filesystem::path& file);

}  // namespace gauntlet::sim
