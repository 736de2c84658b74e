#include "controller/filters/kalman_noise.h"

#include <string>

#include "controller/filters/kalman_variances.h"
#include "controller/filters/per_channel.h"

namespace gauntlet::controller {

void KalmanNoise::Visit(SettingsVisitor& visitor) {
  visitor.Numbers({"r",
                   "measurement variance [unit of the input squared], one for all channels or one "
                   "for each; the default is the paper's, for 18 channels in counts",
                   1e-20, 1e20},
                  r);
  visitor.Numbers({"q",
                   "how much the motion may change, one for all channels or one for each; see "
                   "process_noise; the default is the paper's Q = I",
                   0, 1e20},
                  q);
  VisitProcessNoise(visitor, process_noise);
}

bool IsDefaultMeasurementVariance(const std::vector<double>& r) {
  return r == PaperMeasurementVariance();
}

Eigen::ArrayXd MeasurementVariance(const KalmanNoise& noise, int channel_count) {
  const int values = static_cast<int>(noise.r.size());
  if (values != 1 && values != channel_count && IsDefaultMeasurementVariance(noise.r)) {
    throw SettingError("r", "the default is the paper's for 18 channels, but there are " +
                                std::to_string(channel_count) +
                                "; give one number for all channels or one for each");
  }
  return PerChannel("r", noise.r, channel_count);
}

Eigen::ArrayXd ProcessVariance(const KalmanNoise& noise, int channel_count) {
  return PerChannel("q", noise.q, channel_count);
}

}  // namespace gauntlet::controller
