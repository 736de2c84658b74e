#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace gauntlet::sim {

/// Head of a request, as views of its bytes.
struct HttpHead {
  std::string_view method = {};
  std::string_view path = {};
  std::string_view query = {};  // without '?'
  std::string_view host = {};
  std::optional<std::string_view> origin = {};
  std::size_t body_bytes = 0;
};

/// Bytes of the head at the begin of `bytes`, with its empty line; 0: not all of it is there.
std::size_t HttpHeadSize(std::string_view bytes);

/// Reads a whole head of HTTP/1.1. Nothing is guessed: none for one that RFC 9112 does not allow,
/// has a body of unknown length, waits for a word before it sends its body, or has two of a field
/// that is looked at.
std::optional<HttpHead> ReadHttpHead(std::string_view head);

/// The value of a parameter of a query, as it is written; empty if it is not there exactly once.
std::string_view QueryValue(std::string_view query, std::string_view name);

}  // namespace gauntlet::sim
