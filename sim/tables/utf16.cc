#include <utf8.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include "sim/tables/csv_reader.h"

namespace gauntlet::sim {
namespace {

constexpr std::uint32_t kReplacement = 0xFFFD;

class Utf16Decoder {
 public:
  explicit Utf16Decoder(CsvReader::Source source) : source_(std::move(source)) {}

  std::size_t Read(char* buffer, std::size_t size) {
    while (place_ == text_.size()) {
      if (!Decode()) return 0;
    }
    const std::size_t count = std::min(size, text_.size() - place_);
    std::copy_n(text_.data() + place_, count, buffer);
    place_ += count;
    return count;
  }

 private:
  /// The next block; false at the end.
  bool Decode() {
    text_.clear();
    place_ = 0;
    const std::size_t got = source_(bytes_.data() + kept_, bytes_.size() - kept_);
    if (got == 0) return false;
    const std::size_t size = kept_ + got;
    for (std::size_t i = 0; i + 1 < size; i += 2) AddUnit(Unit(i));
    kept_ = size % 2;
    bytes_[0] = bytes_[size - 1];
    return true;
  }
  std::uint32_t Unit(std::size_t at) const {
    const auto first = static_cast<unsigned char>(bytes_[at]);
    const auto second = static_cast<unsigned char>(bytes_[at + 1]);
    return big_endian_ ? first << 8U | second : second << 8U | first;
  }
  void AddUnit(std::uint32_t unit) {
    if (is_first_) {
      is_first_ = false;
      big_endian_ = unit == 0xFFFE;  // the mark, read the wrong way round
      if (big_endian_ || unit == 0xFEFF) return;
    }
    const bool is_low = unit >= 0xDC00 && unit < 0xE000;
    if (high_ != 0) {
      Append(is_low ? 0x10000 + ((high_ - 0xD800) << 10) + (unit - 0xDC00) : kReplacement);
      high_ = 0;
      if (is_low) return;
    }
    if (unit >= 0xD800 && unit < 0xDC00) {
      high_ = unit;
    } else {
      Append(is_low ? kReplacement : unit);
    }
  }
  void Append(std::uint32_t character) { utf8::append(character, std::back_inserter(text_)); }

  CsvReader::Source source_;
  std::array<char, 65536> bytes_;
  std::size_t kept_ = 0;  // a byte whose other half is to come
  std::string text_;
  std::size_t place_ = 0;
  bool is_first_ = true;
  bool big_endian_ = false;
  std::uint32_t high_ = 0;  // first half of a pair
};

}  // namespace

CsvReader::Source Utf8Of(CsvReader::Source utf16) {
  const auto decoder = std::make_shared<Utf16Decoder>(std::move(utf16));
  return [decoder](char* buffer, std::size_t size) { return decoder->Read(buffer, size); };
}

}  // namespace gauntlet::sim
