// What a Cortex-M4F starts with: the vectors, and its floating-point unit switched on.
#include <cstdint>

extern "C" {
extern std::uint32_t __stack;  // NOLINT: of the linker script
void _start();                 // NOLINT: of the C library

void Reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFU << 20U;
  _start();
}

__attribute__((section(".vectors"), used))
const void* const kVectors[] = {&__stack, reinterpret_cast<const void*>(&Reset)};
}
