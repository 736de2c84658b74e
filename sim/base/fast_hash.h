#pragma once

#define XXH_INLINE_ALL  // the whole library is in its header, so that its state can be a member
#include <xxhash.h>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace gauntlet::sim {

/// A hash with the purpose of Hash for large data, about ten times as fast: XXH64 with seed 0.
class FastHash {
 public:
  FastHash() { XXH64_reset(&state_, 0); }
  void Add(std::string_view bytes) { XXH64_update(&state_, bytes.data(), bytes.size()); }
  template <class Number>
  requires std::is_arithmetic_v<Number>
  void Add(std::span<const Number> numbers) {
    XXH64_update(&state_, numbers.data(), numbers.size_bytes());
  }

  /// 16 hexadecimal digits.
  std::string Text() const;

 private:
  XXH64_state_t state_;
};

/// Hash of a whole file: 16 hexadecimal digits. Errors: as of ReadBlocks().
std::string FastHashOfFile(const std::filesystem::path& file);

}  // namespace gauntlet::sim
