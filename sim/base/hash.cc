#include "sim/base/hash.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "sim/base/descriptor.h"
#include "sim/base/error.h"
#include "sim/base/stop.h"

namespace gauntlet::sim {
std::string Hash::Text() const { return fmt::format("{:016x}", value_); }

void ReadBlocks(const std::filesystem::path& file,
                const std::function<void(std::string_view bytes)>& add) {
  constexpr std::size_t kBlock = 1 << 18;  // stays in a core's cache
  std::vector<char> block(kBlock);
  const Descriptor source(open(file.c_str(), O_RDONLY | O_CLOEXEC));
  ssize_t count = source.is_open() ? 1 : -1;
  while (count > 0 && !StopAsked()) {
    count = read(source.get(), block.data(), block.size());
    if (count < 0 && errno == EINTR)
      count = 1;
    else if (count > 0)
      add(std::string_view(block.data(), count));
  }
  ThrowIfStopped();
  if (count < 0) {
    throw RunError(fmt::format("{}: cannot read: {}", file.string(), std::strerror(errno)));
  }
}

std::string HashOfFile(const std::filesystem::path& file) {
  Hash hash;
  ReadBlocks(file, [&hash](std::string_view bytes) { hash.Add(bytes); });
  return hash.Text();
}

}  // namespace gauntlet::sim
