#include "sim/base/limited_text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "sim/base/descriptor.h"
#include "sim/base/error.h"

namespace gauntlet::sim {
namespace {

/// Puts the text in place. Returns the problem; empty: none.
std::string ReadLimited(const std::filesystem::path& file, std::size_t most_bytes,
                        std::string& text) {
  const auto reason = [] { return fmt::format("cannot be read: {}", std::strerror(errno)); };
  // Without O_NONBLOCK a pipe at this place would block.
  const Descriptor open_file{open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  struct stat status = {};
  if (!open_file.is_open() || fstat(open_file.get(), &status) != 0) return reason();
  if (!S_ISREG(status.st_mode)) return "must be a regular file";
  const auto too_large = [most_bytes] {
    return fmt::format("has more than {} MB, the limit of such a file", most_bytes / 1'000'000);
  };
  if (static_cast<std::uint64_t>(status.st_size) > most_bytes) return too_large();
  // The size is a hint only: the file may grow, and files of the system have none.
  constexpr std::size_t kBlock = std::size_t{1} << 14;
  for (std::size_t size = 0;;) {
    text.resize(std::max(size + kBlock, static_cast<std::size_t>(status.st_size) + 1));
    const ssize_t got = read(open_file.get(), text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return reason();
    size += static_cast<std::size_t>(got);
    if (size > most_bytes) return too_large();
    if (got > 0) continue;
    text.resize(size);
    return "";
  }
}

}  // namespace

std::optional<std::string> LimitedTextIfAny(const std::filesystem::path& file,
                                            std::size_t most_bytes) {
  std::string text;
  if (!ReadLimited(file, most_bytes, text).empty()) return std::nullopt;
  return text;
}

std::string LimitedText(const std::filesystem::path& file, std::size_t most_bytes) {
  std::string text;
  std::string problem = ReadLimited(file, most_bytes, text);
  if (problem.empty()) return text;
  throw UserError({.place = file.empty() ? "''" : file.string(), .problem = std::move(problem)});
}

}  // namespace gauntlet::sim
