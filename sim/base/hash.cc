#include "sim/base/hash.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/stop.h"

namespace gauntlet::sim {
namespace {

// The algorithm's own names.
constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87u;
constexpr std::uint64_t kPrime2 = 0xC2B2AE3D27D4EB4Fu;
constexpr std::uint64_t kPrime3 = 0x165667B19E3779F9u;
constexpr std::uint64_t kPrime4 = 0x85EBCA77C2B2AE63u;
constexpr std::uint64_t kPrime5 = 0x27D4EB2F165667C5u;

/// As it lies in memory: of the machines that Gauntlet runs on, the least byte first.
template <class Word>
Word Read(const char* place) {
  Word word;
  std::memcpy(&word, place, sizeof word);
  return word;
}

std::uint64_t Round(std::uint64_t lane, std::uint64_t word) {
  return std::rotl(lane + word * kPrime2, 31) * kPrime1;
}

/// Hands all bytes of a file to `add`, a block at a time. Errors: as HashOfFile().
template <class Add>
void ReadBlocks(const std::filesystem::path& file, const Add& add) {
  constexpr std::size_t kBlock = 1 << 18;  // stays in a core's cache
  std::vector<char> block(kBlock);
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  ssize_t count = descriptor < 0 ? -1 : 1;
  while (count > 0 && !StopAsked()) {
    count = read(descriptor, block.data(), block.size());
    if (count < 0 && errno == EINTR)
      count = 1;
    else if (count > 0)
      add(std::string_view(block.data(), count));
  }
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  ThrowIfStopped();
  if (count < 0) {
    throw RunError(fmt::format("{}: cannot read: {}", file.string(), std::strerror(error)));
  }
}

}  // namespace

std::string Hash::Text() const { return fmt::format("{:016x}", value_); }

void FastHash::Add(std::string_view bytes) {
  const auto take_stripe = [this](const char* stripe) {
    for (int i = 0; i < 4; ++i) lanes_[i] = Round(lanes_[i], Read<std::uint64_t>(stripe + 8 * i));
  };
  const std::size_t waiting = bytes_ % kStripe;
  bytes_ += bytes.size();
  if (waiting > 0) {
    const std::size_t more = std::min(kStripe - waiting, bytes.size());
    std::copy_n(bytes.data(), more, rest_ + waiting);
    bytes.remove_prefix(more);
    if (waiting + more < kStripe) return;
    take_stripe(rest_);
  }
  for (; bytes.size() >= kStripe; bytes.remove_prefix(kStripe)) take_stripe(bytes.data());
  std::ranges::copy(bytes, rest_);
}

std::uint64_t FastHash::value() const {
  std::uint64_t value = kPrime5;
  if (bytes_ >= kStripe) {
    value = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) +
            std::rotl(lanes_[3], 18);
    for (const std::uint64_t lane : lanes_) value = (value ^ Round(0, lane)) * kPrime1 + kPrime4;
  }
  value += bytes_;
  const char* place = rest_;
  std::size_t left = bytes_ % kStripe;
  for (; left >= 8; left -= 8, place += 8) {
    value ^= Round(0, Read<std::uint64_t>(place));
    value = std::rotl(value, 27) * kPrime1 + kPrime4;
  }
  if (left >= 4) {
    value ^= Read<std::uint32_t>(place) * kPrime1;
    value = std::rotl(value, 23) * kPrime2 + kPrime3;
    left -= 4, place += 4;
  }
  for (; left > 0; --left, ++place) {
    value ^= Read<unsigned char>(place) * kPrime5;
    value = std::rotl(value, 11) * kPrime1;
  }
  value = (value ^ (value >> 33)) * kPrime2;
  value = (value ^ (value >> 29)) * kPrime3;
  return value ^ (value >> 32);
}

std::string FastHash::Text() const { return fmt::format("{:016x}", value()); }

std::string HashOfFile(const std::filesystem::path& file) {
  Hash hash;
  ReadBlocks(file, [&hash](std::string_view bytes) { hash.Add(bytes); });
  return hash.Text();
}

std::string FastHashOfFile(const std::filesystem::path& file) {
  FastHash hash;
  ReadBlocks(file, [&hash](std::string_view bytes) { hash.Add(bytes); });
  return hash.Text();
}

}  // namespace gauntlet::sim
