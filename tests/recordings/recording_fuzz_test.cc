#include "tests/recordings/recording_fuzz.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/base/random.h"

namespace gauntlet::sim {
namespace {

/// Files that contain what real ones do; the fuzzer starts from them.
const std::vector<std::string>& Seeds() {
  static const std::vector<std::string> kSeeds = {
      "time_s,index_mcp,index_pip\n0,1,2\n0.01,3,4\n0.02,5,6\n",
      "time_ms;index_mcp_counts;label\r\n0;512,5;V\r\n10;35512,6;H\r\n10;1;R\r\n5;nan;\r\n",
      "\xEF\xBB\xBF# by hand\n\nindex_mcp_rad\tlittle_pip_share\n0.1\t0.5\n\n0.2\t1e999\n",
      "time_us index_mcp\n 0  1 \n 1000 inf\n 700000 -inf\n 3 +4\n",
      "\"time\",'index_mcp'\n100,1\n99,2\n0,3\n0.1,4,5\n7\n",
      "index_mcp,time_s\n1,2,3\n4,5,6\n",
      "HIERARCHY ROOT h{JOINT th1{JOINT th2{CHANNELS 1 yrotation JOINT th3{}}}"
      "JOINT if1{JOINT if2{CHANNELS 1 Xrotation JOINT if3{}}}JOINT mf1{"
      "JOINT mf2{CHANNELS 1 Xrotation JOINT mf3{}}}JOINT rf1{"
      "JOINT rf2{CHANNELS 1 Xrotation JOINT rf3{}}}JOINT lf1{"
      "JOINT lf2{CHANNELS 1 Xrotation JOINT lf3{}}}}\nMOTION\nFrames: 6\nFrame Time: 0.1\n"
      "0 7 14 21 28\n4 11 18 25 32\n14 21 28 35 42\n30 37 44 51 58\n52 59 6 13 20\n"
      "20 27 34 41 48\n"};
  return kSeeds;
}

void Read(const std::string& input) {
  ReadFuzzedRecording(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

/// Copies, cuts, repeats and replaces pieces.
std::string Mutated(RandomStream& random) {
  const auto& seeds = Seeds();
  std::string text = seeds[random.Index(seeds.size())];
  const std::string alphabet = "0123456789.,;\t \n\r+-eE'\"#naif_\xEF\xBB\xBF\x01\xFF";
  for (auto changes = 1 + random.Index(8); changes > 0; --changes) {
    const std::size_t at = random.Index(text.size() + 1);
    switch (random.Index(4)) {
      case 0:
        text.insert(at, 1, alphabet[random.Index(alphabet.size())]);
        break;
      case 1:
        text.erase(at, 1 + random.Index(6));
        break;
      case 2:
        if (at < text.size()) text[at] = static_cast<char>(random.Bits() & 0xFF);
        break;
      default:
        const std::string& other = seeds[random.Index(seeds.size())];
        text.insert(at, other.substr(random.Index(other.size()), random.Index(20)));
    }
  }
  return static_cast<char>(random.Bits() & 0xFF) + text;
}

TEST(RecordingFuzz, NoMutationOfRealFilesBreaksTheReader) {
  RandomStream random(1, "fuzz");
  for (int i = 0; i < 30000; ++i) Read(Mutated(random));
}

TEST(RecordingFuzz, NoRandomBytesBreakTheReader) {
  RandomStream random(2, "fuzz");
  for (int i = 0; i < 10000; ++i) {
    std::string bytes(random.Index(200), '\0');
    for (char& byte : bytes) byte = static_cast<char>(random.Bits() & 0xFF);
    Read(bytes);
  }
}

}  // namespace
}  // namespace gauntlet::sim
