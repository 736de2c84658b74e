#include "sim/trial/link/receiver_config.h"

namespace gauntlet::sim {
namespace {

void VisitWindow(controller::SettingsVisitor& visitor, double& window_ms) {
  visitor.Number(
      {"window_ms", "how long a measured delay counts: the sender's clock drifts", 100, 600000},
      window_ms);
}

}  // namespace

void QueueReceiver::Visit(controller::SettingsVisitor& visitor) {
  visitor.Integer({"longest_frames", "frames that wait at most; more are lost", 1, 100000},
                  longest_frames);
}

void BufferReceiver::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"delay_ms", "time in which late frames may still arrive", 0, 1000}, delay_ms);
  VisitWindow(visitor, window_ms);
}

void AdaptiveBufferReceiver::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"quantile_percent", "frames that are to arrive in time", 1, 100},
                 quantile_percent);
  visitor.Number({"longest_ms", "longest buffer", 1, 1000}, longest_ms);
  VisitWindow(visitor, window_ms);
}

void PredictGap::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"slope_ms", "time over which the slope is measured", 1, 1000}, slope_ms);
  visitor.Number({"longest_ms", "time after which the extrapolation stays", 0, 1000}, longest_ms);
}

}  // namespace gauntlet::sim
