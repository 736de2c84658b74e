#pragma once

#include "controller/filters/channel_arrays.h"
#include "controller/filters/process_noise.h"

namespace gauntlet::controller {

/// Arrays of a Kalman filter with position and velocity per step: state, covariance (upper
/// triangle), measurement variance, q.
enum KalmanArray2 { kX, kW, kP11, kP12, kP22, kR, kQ, kKalmanArrays2 };

/// The same with the acceleration per step squared as a third state. Begins like KalmanArray2 with
/// position and velocity.
enum KalmanArray3 {
  kAcceleration3 = 2,
  kP11Of3,
  kP12Of3,
  kP13Of3,
  kP22Of3,
  kP23Of3,
  kP33Of3,
  kROf3,
  kQOf3,
  kKalmanArrays3
};

/// One step of every channel: predict, update, output the a-posteriori position.
/// `measured` and `output` may be the same memory.
void StepKalman2(ChannelArrays& arrays, const ProcessNoiseFactors& q, const double* measured,
                 double* output);
void StepKalman3(ChannelArrays& arrays, const ProcessNoiseFactors& q, const double* measured,
                 double* output);

}  // namespace gauntlet::controller
