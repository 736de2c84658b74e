#include "sim/glove/noise/box_muller.h"

namespace gauntlet::sim {

void AddBoxMuller(RandomStream& random, double standard_deviation, std::span<double> signal) {
  std::size_t i = 0;
  for (; i + 1 < signal.size(); i += 2) {
    const NormalPair pair = BoxMuller(random);
    signal[i] += standard_deviation * pair.first;
    signal[i + 1] += standard_deviation * pair.second;
  }
  if (i < signal.size()) signal[i] += standard_deviation * BoxMuller(random).first;
}

}  // namespace gauntlet::sim
