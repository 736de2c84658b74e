#include "tests/device/pseudo_terminal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace gauntlet::sim {

PseudoTerminal::PseudoTerminal(std::filesystem::path link) : link_(std::move(link)) { Plug(); }

void PseudoTerminal::Plug() {
  near_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  std::array<char, 64> name{};
  ASSERT_EQ(grantpt(near_), 0);
  ASSERT_EQ(unlockpt(near_), 0);
  ASSERT_EQ(ptsname_r(near_, name.data(), name.size()), 0);
  termios raw{};
  tcgetattr(near_, &raw);
  cfmakeraw(&raw);
  tcsetattr(near_, TCSANOW, &raw);
  std::filesystem::remove(link_);
  std::filesystem::create_symlink(name.data(), link_);
}

void PseudoTerminal::Unplug() {
  if (near_ < 0) return;
  std::filesystem::remove(link_);
  close(near_);
  near_ = -1;
}

void PseudoTerminal::Write(std::string_view bytes) const {
  ASSERT_EQ(write(near_, bytes.data(), bytes.size()), std::ssize(bytes));
}

std::string PseudoTerminal::Read(int timeout_ms, std::size_t least) const {
  std::string got;
  pollfd ready{.fd = near_, .events = POLLIN, .revents = 0};
  while (got.size() < least && poll(&ready, 1, timeout_ms) > 0) {
    std::array<char, 4096> buffer;
    const ssize_t size = read(near_, buffer.data(), buffer.size());
    if (size <= 0) break;
    got.append(buffer.data(), static_cast<std::size_t>(size));
  }
  return got;
}

}  // namespace gauntlet::sim
