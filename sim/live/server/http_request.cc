#include "sim/live/server/http_request.h"

#include <algorithm>
#include <charconv>

namespace gauntlet::sim {
namespace {

constexpr std::string_view kLineEnd = "\r\n";

/// The text before the first `end`, which is removed from `rest` with it; all of `rest` without
/// one.
std::string_view TakeUntil(std::string_view end, std::string_view& rest) {
  const std::size_t size = std::min(rest.find(end), rest.size());
  const std::string_view taken = rest.substr(0, size);
  rest.remove_prefix(std::min(size + end.size(), rest.size()));
  return taken;
}

bool IsLetterOrDigit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/// A token of RFC 9110.
bool IsToken(std::string_view text) {
  static constexpr std::string_view kOther = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return IsLetterOrDigit(c) || kOther.find(c) != std::string_view::npos;
  });
}

/// Letters that can be seen; where `is_field`, blanks, tabs and bytes beyond ASCII, too.
bool IsText(std::string_view text, bool is_field) {
  return std::ranges::all_of(text, [is_field](char c) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_seen = byte > ' ' && byte < 0x7F;
    return is_seen || (is_field && (c == ' ' || c == '\t' || byte >= 0x80));
  });
}

bool IsSameName(std::string_view name, std::string_view small_letters) {
  return std::ranges::equal(name, small_letters, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

std::string_view WithoutBlanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

std::optional<std::size_t> WholeNumber(std::string_view digits) {
  std::size_t number = 0;
  const char* const end = digits.data() + digits.size();
  const auto [read, error] = std::from_chars(digits.data(), end, number);
  if (error != std::errc() || read != end) return std::nullopt;
  return number;
}

bool ReadRequestLine(std::string_view line, HttpHead& head) {
  head.method = TakeUntil(" ", line);
  std::string_view target = TakeUntil(" ", line);
  if (!IsToken(head.method) || !target.starts_with('/') || !IsText(target, false)) return false;
  head.path = TakeUntil("?", target);
  head.query = target;
  return line == "HTTP/1.1";
}

}  // namespace

std::size_t HttpHeadSize(std::string_view bytes) {
  constexpr std::string_view kEnd = "\r\n\r\n";
  const std::size_t end = bytes.find(kEnd);
  return end == std::string_view::npos ? 0 : end + kEnd.size();
}

std::optional<HttpHead> ReadHttpHead(std::string_view head) {
  HttpHead read;
  if (!ReadRequestLine(TakeUntil(kLineEnd, head), read)) return std::nullopt;
  std::optional<std::string_view> host;
  std::optional<std::string_view> length;
  while (!head.empty()) {
    std::string_view value = TakeUntil(kLineEnd, head);
    if (value.empty()) break;
    const bool has_value = value.find(':') != std::string_view::npos;
    const std::string_view name = TakeUntil(":", value);
    if (!has_value || !IsToken(name) || !IsText(value, true)) return std::nullopt;
    if (IsSameName(name, "transfer-encoding") || IsSameName(name, "expect")) return std::nullopt;
    std::optional<std::string_view>* const field = IsSameName(name, "host")     ? &host
                                                   : IsSameName(name, "origin") ? &read.origin
                                                   : IsSameName(name, "content-length") ? &length
                                                                                        : nullptr;
    if (field == nullptr) continue;
    if (*field) return std::nullopt;
    *field = WithoutBlanks(value);
  }
  if (!host) return std::nullopt;
  read.host = *host;
  if (length) {
    const std::optional<std::size_t> bytes = WholeNumber(*length);
    if (!bytes) return std::nullopt;
    read.body_bytes = *bytes;
  }
  return read;
}

std::string_view QueryValue(std::string_view query, std::string_view name) {
  std::optional<std::string_view> found;
  while (!query.empty()) {
    std::string_view value = TakeUntil("&", query);
    if (TakeUntil("=", value) != name) continue;
    if (found) return {};
    found = value;
  }
  return found.value_or(std::string_view());
}

}  // namespace gauntlet::sim
