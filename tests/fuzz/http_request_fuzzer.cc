// Bytes of a browser, or of a stranger, as the head of a request of the page of a live session.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "sim/live/server/http_request.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gauntlet::sim;  // NOLINT(google-build-using-namespace)
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t head_size = HttpHeadSize(bytes);
  if (head_size > size) std::abort();
  if (head_size == 0) return 0;
  const std::string text = bytes.substr(0, head_size);
  const auto head = ReadHttpHead(text);
  if (!head) return 0;
  const auto is_within = [&](std::string_view part) {
    return part.empty() ||
           (part.data() >= text.data() && part.data() + part.size() <= text.data() + text.size() &&
            part.find_first_of(std::string_view("\r\n\0", 3)) == part.npos);
  };
  if (!is_within(head->method) || !is_within(head->path) || !is_within(head->query)) std::abort();
  if (!is_within(head->host) || !is_within(head->origin.value_or(""))) std::abort();
  if (head->method.empty() || !head->path.starts_with('/')) std::abort();
  // What was read is written and read the same.
  std::string again(head->method);
  again.append(" ").append(head->path).append("?").append(head->query);
  again.append(" HTTP/1.1\r\nHost: ").append(head->host);
  if (head->origin) again.append("\r\nOrigin: ").append(*head->origin);
  again += "\r\nContent-Length: " + std::to_string(head->body_bytes) + "\r\n\r\n";
  const auto second = ReadHttpHead(again);
  if (!second || second->method != head->method || second->path != head->path) std::abort();
  if (second->query != head->query || second->host != head->host) std::abort();
  if (second->origin != head->origin || second->body_bytes != head->body_bytes) std::abort();
  if (QueryValue(second->query, "token") != QueryValue(head->query, "token")) std::abort();
  return 0;
}
