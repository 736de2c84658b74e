#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace gauntlet::test {

/// Reads what EncodeCurve() writes, from its description and not from its code.
inline std::vector<double> DecodeCurve(const std::string& text, double step) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned> bytes;
  unsigned window = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    window = (window << 6 | static_cast<unsigned>(letters.find(c))) & 0xFFFFFF;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(window >> bits & 0xFF);
  }
  std::vector<double> values;
  std::int64_t last = 0;
  for (std::size_t i = 0; i < bytes.size();) {
    std::int64_t number = 0;
    int shift = 0;
    unsigned byte = 0x80;
    while ((byte & 0x80) != 0) {
      byte = bytes[i++];
      number |= static_cast<std::int64_t>(byte & 0x7F) << shift;
      shift += 7;
    }
    if (number == 0) {
      values.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const std::int64_t doubled = number - 1;
    last += doubled % 2 == 0 ? doubled / 2 : -(doubled + 1) / 2;
    values.push_back(static_cast<double>(last) * step);
  }
  return values;
}

}  // namespace gauntlet::test
