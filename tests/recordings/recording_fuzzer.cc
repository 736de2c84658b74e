// For libFuzzer: `cmake --build build/release --target recording_fuzzer`, then
// `build/release/tests/recordings/fuzz_recording -runs=10000000 -max_len=512`.
// That is half an hour on a core to itself; such a run found nothing.
#include "tests/recordings/recording_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::ReadFuzzedRecording(data, size);
  return 0;
}
