#pragma once

#include <sys/resource.h>

#include <cstddef>
#include <initializer_list>

namespace gauntlet::sim {

/// Lowers a limit of this process (RLIMIT_..), for good.
void LimitResource(int resource, rlim_t most);

/// Limits the memory of this process to `more_bytes` in addition to what it has. Without effect
/// under a sanitizer, and where the system does not report the memory.
void LimitMemory(std::size_t more_bytes);

/// For a child process: leads the standard streams to /dev/null and closes every descriptor but
/// these, which keep their numbers. They must be above those of the standard streams.
void KeepOnly(std::initializer_list<int> descriptors);

/// For a child process: it gains no rights, writes no file and no core, and other processes of the
/// user cannot read its memory.
void DropRights();

}  // namespace gauntlet::sim
