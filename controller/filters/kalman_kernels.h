#pragma once

#include "controller/filters/channel_arrays.h"
#include "controller/filters/process_noise.h"

namespace gauntlet::controller {

/// Arrays of a Kalman filter with position and velocity per step: state, covariance (upper
/// triangle), gain, measurement variance, q.
enum KalmanArray2 { kX, kW, kP11, kP12, kP22, kK1, kK2, kR, kQ, kKalmanArrays2 };

/// Arrays of a Kalman filter with the acceleration per step squared as a third state. Begins like
/// KalmanArray2 with position and velocity.
enum KalmanArray3 {
  kAcceleration3 = 2,
  kP11Of3,
  kP12Of3,
  kP13Of3,
  kP22Of3,
  kP23Of3,
  kP33Of3,
  kK1Of3,
  kK2Of3,
  kK3Of3,
  kROf3,
  kQOf3,
  kKalmanArrays3
};

/// The half of a step that does not depend on the data: covariance and gain of every channel.
void StepCovariance2(ChannelArrays& arrays, const ProcessNoiseFactors& q);
void StepCovariance3(ChannelArrays& arrays, const ProcessNoiseFactors& q);

/// Position and velocity of every channel, and their gains.
struct States2 {
  double *x, *w;
  const double *k1, *k2;
};
/// Position, velocity and acceleration of every channel, and their gains.
struct States3 {
  double *x, *w, *a;
  const double *k1, *k2, *k3;
};

/// The other half: predict the states, correct them by the gains, output the a-posteriori position.
/// `measured` and `output` may be the same memory.
void StepStates2(const States2& states, const double* measured, double* output, int channel_count);
void StepStates3(const States3& states, const double* measured, double* output, int channel_count);

/// Both halves of every channel.
void StepKalman2(ChannelArrays& arrays, const ProcessNoiseFactors& q, const double* measured,
                 double* output);

}  // namespace gauntlet::controller
