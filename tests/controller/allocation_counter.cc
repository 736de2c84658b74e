#include "tests/controller/allocation_counter.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

// Every operator new ends in malloc or aligned_alloc here; Eigen calls malloc itself. So those are
// counted, by standing before the C library's.

namespace {
std::atomic<long> allocations{0};
}  // namespace

// Sanitizers have their own allocators, which must not be mixed with the C library's.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
void free(void* memory) {
  if (memory != nullptr) ++allocations;
  __libc_free(memory);
}
}
#endif

namespace gauntlet::controller {

long AllocationCount() { return allocations.load(); }

}  // namespace gauntlet::controller
