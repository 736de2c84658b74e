#include "sim/base/fast_hash.h"

#include <fmt/format.h>

#include "sim/base/hash.h"

namespace gauntlet::sim {

std::string FastHash::Text() const { return fmt::format("{:016x}", XXH64_digest(&state_)); }

std::string FastHashOfFile(const std::filesystem::path& file) {
  FastHash hash;
  ReadBlocks(file, [&hash](std::string_view bytes) { hash.Add(bytes); });
  return hash.Text();
}

}  // namespace gauntlet::sim
