#pragma once

#include <Eigen/Core>

namespace gauntlet::controller {

/// How a joint may move: a linear system of three states, driven by white noise.
///
///     dx/dt = F x + w,   E w w' = Q delta(t),   angle = H x
///
/// Units: angle [deg], time [s]; r below in deg^2.
struct MotionModel {
  Eigen::Matrix3d f;
  Eigen::Matrix3d q;
  Eigen::RowVector3d h;
};

/// Velocity, or with three states acceleration, does what it does until now: white acceleration of
/// density q [deg^2/s^3], or white jerk [deg^2/s^5]. States: angle, velocity, acceleration.
MotionModel WhiteAcceleration(double q_deg2_per_s3);
MotionModel WhiteJerk(double q_deg2_per_s5);

/// A swing around a middle that wanders:
///
///     angle = m + s,   s'' = -w^2 s - 2 damping w s' + a,   w = 2 pi frequency
///
/// m: a random walk of density `drift_deg2_per_s`; a: white acceleration of density q. States: m,
/// s, s'.
MotionModel Swing(double frequency_hz, double damping, double q_deg2_per_s3,
                  double drift_deg2_per_s);

/// A Kalman filter of a model at its settled gain, in steps of a clock:
///
///     x^- = A x,   x = x^- + K (z - H x^-)
///
/// Source: discretised by Van Loan, IEEE TAC 23 (1978); K from the Riccati equation.
struct SettledFilter {
  Eigen::Matrix3d a;
  Eigen::Vector3d k;
};
SettledFilter Settle(const MotionModel& model, double r_deg2, double step_s);

/// Expectation of the model in `horizon_s` from a state x now:  H exp(F horizon) x  = result * x.
Eigen::RowVector3d LookAhead(const MotionModel& model, double horizon_s);

}  // namespace gauntlet::controller
