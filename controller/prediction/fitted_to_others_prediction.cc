#include "controller/prediction/fitted_to_others_prediction.h"

#include "controller/prediction/fallback.h"
#include "controller/prediction/horizon.h"
#include "controller/prediction/predictor.h"

namespace gauntlet::controller {

void FittedToOthersPredictionConfig::Visit(SettingsVisitor& visitor) {
  VisitHorizon(visitor, horizon_ms);
  visitor.Integer({"order", "how many taps into the past", 1, 1000}, order);
  visitor.Number({"tap_ms", "how far they lie apart", 0.1, 1000}, tap_ms);
  visitor.Number({"caution", "fit as if the noise had so many times its variance", 1, 1e6},
                 caution);
  visitor.Flag({"offset",
                "look at where a channel is, too; it is then drawn to where such motions go, also "
                "at rest"},
               offset);
  visitor.Flag(
      {"all_channels", "look at where all channels are and how they move, too; needs offset: true"},
      all_channels);
  VisitFallback(visitor, fallback, r_deg2);
}

std::unique_ptr<Filter> MakePredictor(const FittedToOthersPredictionConfig&, int, double) {
  throw SettingError("kind",
                     "is fitted_to_others, which has no weights yet: gauntlet export and gauntlet "
                     "calibrate --predictor fit them");
}

}  // namespace gauntlet::controller
