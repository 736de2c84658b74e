#pragma once

#include <array>
#include <string_view>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

/// Meaning of the covariance Q of a Kalman filter's motion model.
///
/// kIdentity: Q = q I per step, the paper's form; another rate makes it another filter.
/// kWhite: the highest derivative of the state is driven by continuous white noise of density q
/// (white acceleration for position and velocity, in unit^2/s^3; white jerk when acceleration is a
/// state, too, in unit^2/s^5); the same q means the same motion at every rate.
enum class ProcessNoise { kIdentity, kWhite };

/// Q of one channel as factors of q, for states counted per step: position, velocity x step,
/// acceleration x step^2. Only the upper triangle.
struct GAUNTLET_API ProcessNoiseFactors {
  double q11, q12, q13, q22, q23, q33;
  bool operator==(const ProcessNoiseFactors&) const = default;
};

/// With step T: white acceleration is q T^3 [1/3 1/2; 1/2 1], white jerk is
/// q T^5 [1/20 1/8 1/6; 1/8 1/3 1/2; 1/6 1/2 1] in these states.
/// Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking, 6.2.
inline ProcessNoiseFactors FactorsOf(ProcessNoise kind, int states, double step_s) {
  if (kind == ProcessNoise::kIdentity) return {1.0, 0.0, 0.0, 1.0, 0.0, 1.0};
  const double t3 = step_s * step_s * step_s;
  if (states == 2) return {t3 / 3.0, t3 / 2.0, 0.0, t3, 0.0, 0.0};
  const double t5 = t3 * step_s * step_s;
  return {t5 / 20.0, t5 / 8.0, t5 / 6.0, t5 / 3.0, t5 / 2.0, t5};
}

inline void VisitStates(SettingsVisitor& visitor, int& states) {
  visitor.Integer({"states", "2: position and velocity (the paper); 3: acceleration, too", 2, 3},
                  states);
}

inline void VisitProcessNoise(SettingsVisitor& visitor, ProcessNoise& kind) {
  static constexpr std::array<std::string_view, 2> kNames = {"identity", "white"};
  VisitEnum(visitor,
            {"process_noise",
             "identity: Q = q I per step (the paper); white: q is the density of white "
             "acceleration [unit^2/s^3], or of white jerk [unit^2/s^5] with 3 states"},
            kNames, kind);
}

}  // namespace gauntlet::controller
