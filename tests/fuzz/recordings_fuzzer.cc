// Recordings of gloves.
#include "tests/recordings/recording_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::ReadFuzzedRecording(data, size);
  return 0;
}
