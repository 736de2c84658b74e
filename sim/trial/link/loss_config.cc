#include "sim/trial/link/loss_config.h"

namespace gauntlet::sim {

void IndependentLoss::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"percent", "frames that are lost", 0, 100}, percent);
}

void GilbertElliottLoss::Visit(controller::SettingsVisitor& visitor) {
  visitor.Number({"begin_percent", "frames at which a burst of losses begins", 0, 100},
                 begin_percent);
  visitor.Number({"mean_frames", "mean length of a burst", 1, 100000}, mean_frames);
  visitor.Number({"lost_percent", "frames of a burst that are lost", 0, 100}, lost_percent);
}

bool LossDraw::Next() noexcept {
  if (const auto* single = std::get_if<IndependentLoss>(&settings_)) {
    return 100.0 * random_.Uniform() < single->percent;
  }
  const auto* bursts = std::get_if<GilbertElliottLoss>(&settings_);
  if (bursts == nullptr) return false;
  const double change = random_.Uniform();
  in_burst_ =
      in_burst_ ? change * bursts->mean_frames >= 1.0 : 100.0 * change < bursts->begin_percent;
  const double lost = random_.Uniform();  // drawn in both states: the stream stays in step
  return in_burst_ && 100.0 * lost < bursts->lost_percent;
}

}  // namespace gauntlet::sim
