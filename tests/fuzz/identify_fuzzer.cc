// `gauntlet identify` of any text: it is refused in one line, or gives finite samples at an even
// rate, to which chains are fitted.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/fit/chain_episodes.h"
#include "sim/tables/file_format.h"

namespace gauntlet::sim {
namespace {

void Read(std::string_view text) {
  if (FormatOfBytes(text) != FileFormat::kText) return;  // `arrays` is for other formats
  static const std::string file =
      "/dev/shm/gauntlet_fuzz_identify_" + std::to_string(getpid()) + ".csv";
  std::ofstream(file, std::ios::binary) << text;
  try {
    ChainEpisodes episodes = LoadChainEpisodes(file);
    for (const ChainLog& log : episodes.logs) {
      if (!log.command_deg.allFinite() || !log.angle_deg.allFinite()) std::abort();
      if (!(log.rate_hz > 0.0) || !std::isfinite(log.rate_hz)) std::abort();
      if (log.command_deg.cols() != std::ssize(log.parts)) std::abort();
    }
    const ChainResult result = IdentifyChain(std::move(episodes));
    if (result.fits.size() != result.log().parts.size()) std::abort();
  } catch (const UserError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
