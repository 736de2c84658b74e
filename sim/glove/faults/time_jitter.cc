#include "sim/glove/faults/time_jitter.h"

#include <algorithm>

#include "sim/base/normal_pair.h"

namespace gauntlet::sim {

void TimeJitterFault::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"deviation_ms", "standard deviation of the moment of sampling", 0, 100},
                 deviation_ms);
}

void TimeJitterFault::Apply(FaultStrike& strike) const {
  const double deviation = 1e-3 * deviation_ms * strike.rate_hz;
  const auto reach = static_cast<Eigen::Index>(6.0 * deviation) + 1;  // beyond: twice in 10^9
  const Eigen::Index first = std::max<Eigen::Index>(strike.begin - reach, 0);
  const Eigen::Index last = std::min(strike.end + reach, strike.column.size()) - 1;
  const Eigen::VectorXd exact = strike.column.segment(first, last - first + 1);
  for (Eigen::Index i = strike.begin; i < strike.end; ++i) {
    const double off = deviation * BoxMuller(strike.random).first;
    const double place = std::clamp(static_cast<double>(i - first) + off, 0.0,
                                    static_cast<double>(exact.size() - 1));
    const auto before = static_cast<Eigen::Index>(place);
    const auto after = std::min(before + 1, exact.size() - 1);
    const double share = place - static_cast<double>(before);
    strike.column[i] = exact[before] + share * (exact[after] - exact[before]);
  }
}

}  // namespace gauntlet::sim
