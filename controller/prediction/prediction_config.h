#pragma once

#include <span>
#include <string_view>
#include <variant>

#include "controller/export.h"
#include "controller/kinds.h"
#include "controller/prediction/adaptive_prediction.h"
#include "controller/prediction/fitted_prediction.h"
#include "controller/prediction/fitted_to_others_prediction.h"
#include "controller/prediction/kalman_prediction.h"
#include "controller/prediction/linear_prediction.h"
#include "controller/prediction/no_prediction.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Every kind of prediction that there is. To add one: a file with its config and its
/// MakePredictor(), one entry here and one in `predictor.h`.
class GAUNTLET_API PredictionSettings
    : public std::variant<NoPredictionConfig, LinearPredictionConfig, KalmanPredictionConfig,
                          AdaptivePredictionConfig, FittedPredictionConfig,
                          FittedToOthersPredictionConfig> {
 public:
  using variant::variant;
  PredictionSettings();
  PredictionSettings(const PredictionSettings& other);
  PredictionSettings(PredictionSettings&& other) noexcept;
  PredictionSettings& operator=(const PredictionSettings& other);
  PredictionSettings& operator=(PredictionSettings&& other) noexcept;
  ~PredictionSettings();
};

/// Looking ahead, to compensate the delay between the glove and the hand: the paper's second idea.
///
/// Along a line it pays while frequency x horizon stays below 0.1 to 0.2; above, it overshoots; and
/// it raises noise. A predictor may stand behind filters or, better, alone: what filters take away
/// they make late. Source: Bai, Jiang, Yokoi, section 5.
struct GAUNTLET_API PredictionConfig {
  PredictionSettings settings;

  std::string_view kind() const { return KindName(settings); }
  void Visit(SettingsVisitor& visitor);
};

/// All kinds, in the order of every list.
using PredictionKind = Kind<PredictionConfig>;
GAUNTLET_API std::span<const PredictionKind> PredictionKinds();

}  // namespace gauntlet::controller
