#include "controller/filters/kalman_kernels.h"

#include "controller/assert.h"
#include "controller/filters/subnormal.h"
#include "controller/filters/vectorise.h"

// The equations of KalmanConfig written out per element, in the paper's symbols: x the state, P its
// covariance, K the gain, z the measurement; ⁻ marks what is predicted, before z is known. f are
// the factors of Q = f q. P⁻ and P are symmetric.
//
// (I − K H) P⁻ is computed as K R in its first row: 1 − K₁ = R / (P⁻₁₁ + R) exactly, without the
// cancellation of the difference when R is small.

namespace gauntlet::controller {
GAUNTLET_VECTORISED void StepCovariance2(ChannelArrays& arrays, const ProcessNoiseFactors& f) {
  GAUNTLET_ASSERT(arrays.array_count() >= kKalmanArrays2);
  double *p11 = arrays[kP11], *p12 = arrays[kP12], *p22 = arrays[kP22];
  double *k1 = arrays[kK1], *k2 = arrays[kK2];
  const double *r = arrays[kR], *q = arrays[kQ];
  const int channel_count = arrays.channel_count();
  const double f11 = f.q11, f12 = f.q12, f22 = f.q22;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double m11 = p11[i] + p12[i];               // M = A P
    const double m12 = p12[i] + p22[i];               // M₂₂ = P₂₂
    const double p11_prior = m11 + m12 + f11 * q[i];  // P⁻ = M Aᵀ + Q
    const double p12_prior = m12 + f12 * q[i];        // P⁻₁₂ = M₁₂ + Q₁₂
    const double p22_prior = p22[i] + f22 * q[i];     // P⁻₂₂ = M₂₂ + Q₂₂
    const double s = p11_prior + r[i];                // S = H P⁻ Hᵀ + R
    const double k1_new = p11_prior / s;              // K₁ = P⁻₁₁ / S
    const double k2_new = p12_prior / s;              // K₂ = P⁻₁₂ / S
    p11[i] = k1_new * r[i];                           // P = (I − K H) P⁻
    p12[i] = k2_new * r[i];                           // P₁₂ = (1 − K₁) P⁻₁₂ = K₂ R
    p22[i] = p22_prior - k2_new * p12_prior;          // P₂₂ = P⁻₂₂ − K₂ P⁻₁₂
    k1[i] = k1_new;
    k2[i] = k2_new;
  }
}

GAUNTLET_VECTORISED void StepCovariance3(ChannelArrays& arrays, const ProcessNoiseFactors& f) {
  GAUNTLET_ASSERT(arrays.array_count() >= kKalmanArrays3);
  double *p11 = arrays[kP11Of3], *p12 = arrays[kP12Of3], *p13 = arrays[kP13Of3];
  double *p22 = arrays[kP22Of3], *p23 = arrays[kP23Of3], *p33 = arrays[kP33Of3];
  double *k1 = arrays[kK1Of3], *k2 = arrays[kK2Of3], *k3 = arrays[kK3Of3];
  const double *r = arrays[kROf3], *q = arrays[kQOf3];
  const int channel_count = arrays.channel_count();
  const double f11 = f.q11, f12 = f.q12, f13 = f.q13;
  const double f22 = f.q22, f23 = f.q23, f33 = f.q33;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double m11 = p11[i] + p12[i] + 0.5 * p13[i];  // M = A P
    const double m12 = p12[i] + p22[i] + 0.5 * p23[i];  // M₁₂ = P₁₂ + P₂₂ + ½ P₃₂
    const double m13 = p13[i] + p23[i] + 0.5 * p33[i];  // M₁₃ = P₁₃ + P₂₃ + ½ P₃₃
    const double m22 = p22[i] + p23[i];                 // M₂₂ = P₂₂ + P₃₂
    const double m23 = p23[i] + p33[i];                 // M₂₃ = P₂₃ + P₃₃
    const double p11_prior = m11 + m12 + 0.5 * m13 + f11 * q[i];  // P⁻ = M Aᵀ + Q
    const double p12_prior = m12 + m13 + f12 * q[i];  // P⁻₁₂ = M₁₂ + M₁₃ + Q₁₂
    const double p13_prior = m13 + f13 * q[i];        // P⁻₁₃ = M₁₃ + Q₁₃
    const double p22_prior = m22 + m23 + f22 * q[i];  // P⁻₂₂ = M₂₂ + M₂₃ + Q₂₂
    const double p23_prior = m23 + f23 * q[i];        // P⁻₂₃ = M₂₃ + Q₂₃
    const double p33_prior = p33[i] + f33 * q[i];     // P⁻₃₃ = M₃₃ + Q₃₃
    const double s = p11_prior + r[i];                // S = H P⁻ Hᵀ + R
    const double k1_new = p11_prior / s;              // K₁ = P⁻₁₁ / S
    const double k2_new = p12_prior / s;              // K₂ = P⁻₁₂ / S
    const double k3_new = p13_prior / s;              // K₃ = P⁻₁₃ / S
    p11[i] = k1_new * r[i];                           // P = (I − K H) P⁻
    p12[i] = k2_new * r[i];                           // P₁₂ = (1 − K₁) P⁻₁₂ = K₂ R
    p13[i] = k3_new * r[i];                           // P₁₃ = (1 − K₁) P⁻₁₃ = K₃ R
    p22[i] = p22_prior - k2_new * p12_prior;          // P₂₂ = P⁻₂₂ − K₂ P⁻₁₂
    p23[i] = p23_prior - k2_new * p13_prior;          // P₂₃ = P⁻₂₃ − K₂ P⁻₁₃
    p33[i] = p33_prior - k3_new * p13_prior;          // P₃₃ = P⁻₃₃ − K₃ P⁻₁₃
    k1[i] = k1_new;
    k2[i] = k2_new;
    k3[i] = k3_new;
  }
}

GAUNTLET_VECTORISED void StepStates2(const States2& states, const double* z, double* output,
                                     int channel_count) {
  const auto [x, w, k1, k2] = states;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double x_prior = x[i] + w[i];                          // x⁻ = A x
    const double innovation = WithoutSubnormal(z[i] - x_prior);  // z − H x⁻
    // x = x⁻ + K (z − H x⁻),  w = w⁻ + K₂ (z − H x⁻)
    const double x_posterior = x_prior + k1[i] * innovation;
    w[i] += k2[i] * innovation;
    x[i] = x_posterior;
    output[i] = x_posterior;
  }
}

GAUNTLET_VECTORISED void StepStates3(const States3& states, const double* z, double* output,
                                     int channel_count) {
  const auto [x, w, a, k1, k2, k3] = states;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double x_prior = x[i] + w[i] + 0.5 * a[i];             // x⁻ = A x
    const double w_prior = w[i] + a[i];                          // w⁻ = w + a,  a⁻ = a
    const double innovation = WithoutSubnormal(z[i] - x_prior);  // z − H x⁻
    // x = x⁻ + K (z − H x⁻),  w = w⁻ + K₂ (z − H x⁻),  a = a⁻ + K₃ (z − H x⁻)
    const double x_posterior = x_prior + k1[i] * innovation;
    w[i] = w_prior + k2[i] * innovation;
    a[i] += k3[i] * innovation;
    x[i] = x_posterior;
    output[i] = x_posterior;
  }
}

void StepKalman2(ChannelArrays& arrays, const ProcessNoiseFactors& q, const double* measured,
                 double* output) {
  StepCovariance2(arrays, q);
  StepStates2({.x = arrays[kX], .w = arrays[kW], .k1 = arrays[kK1], .k2 = arrays[kK2]}, measured,
              output, arrays.channel_count());
}

}  // namespace gauntlet::controller
