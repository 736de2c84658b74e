#include "sim/base/process_limits.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <vector>

namespace gauntlet::sim {
namespace {

/// Address space of this process in bytes; 0 if the system does not report it.
std::size_t AddressSpaceBytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // sanitizers reserve terabytes of address space
#else
constexpr bool kSanitized = false;
#endif

}  // namespace

void LimitResource(int resource, rlim_t most) {
  rlimit limit = {};
  getrlimit(resource, &limit);
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = limit.rlim_max;
  setrlimit(resource, &limit);
}

void LimitMemory(std::size_t more_bytes) {
  if (kSanitized) return;
  if (const std::size_t now = AddressSpaceBytes(); now > 0) {
    LimitResource(RLIMIT_AS, now + more_bytes);
  }
}

void KeepOnly(std::initializer_list<int> descriptors) {
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    nowhere < 0 ? close(stream) : dup2(nowhere, stream);
  }
  std::vector<int> kept = descriptors;
  std::ranges::sort(kept);
  unsigned next = STDERR_FILENO + 1;
  for (const int descriptor : kept) {
    const auto number = static_cast<unsigned>(descriptor);
    if (number > next) close_range(next, number - 1, 0);
    next = number + 1;
  }
  close_range(next, ~0U, 0);
}

void DropRights() {
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  prctl(PR_SET_DUMPABLE, 0);
  LimitResource(RLIMIT_CORE, 0);
  LimitResource(RLIMIT_FSIZE, 0);
}

}  // namespace gauntlet::sim
