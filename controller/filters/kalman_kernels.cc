#include "controller/filters/kalman_kernels.h"

#include "controller/filters/vectorise.h"

// The equations of KalmanConfig written out per element; the symbols are those of the paper.
// (I - K H) P^- is computed as K R in its first row: 1 - K_1 = R / (P_11^- + R) exactly, without
// the cancellation of the difference when R is small.

namespace gauntlet::controller {
namespace {

GAUNTLET_VECTORISED void Step2(double* x, double* w, double* p11, double* p12, double* p22,
                               const double* r, const double* q, ProcessNoiseFactors factors,
                               const double* z, double* output, int channel_count) {
  const double f11 = factors.q11;
  const double f12 = factors.q12;
  const double f22 = factors.q22;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double x_prior = x[i] + w[i];
    const double sum = p12[i] + p22[i];
    const double p11_prior = (p11[i] + p12[i]) + sum + f11 * q[i];
    const double p12_prior = sum + f12 * q[i];
    const double p22_prior = p22[i] + f22 * q[i];
    const double s = p11_prior + r[i];
    const double k1 = p11_prior / s;
    const double k2 = p12_prior / s;
    const double innovation = z[i] - x_prior;
    const double x_posterior = x_prior + k1 * innovation;
    w[i] = w[i] + k2 * innovation;
    p11[i] = k1 * r[i];
    p12[i] = k2 * r[i];
    p22[i] = p22_prior - k2 * p12_prior;
    x[i] = x_posterior;
    output[i] = x_posterior;
  }
}

GAUNTLET_VECTORISED void Step3(double* x, double* w, double* a, double* p11, double* p12,
                               double* p13, double* p22, double* p23, double* p33, const double* r,
                               const double* q, ProcessNoiseFactors f, const double* z,
                               double* output, int channel_count) {
  const double f11 = f.q11, f12 = f.q12, f13 = f.q13;
  const double f22 = f.q22, f23 = f.q23, f33 = f.q33;
  GAUNTLET_CHANNEL_LOOP
  for (int i = 0; i < channel_count; ++i) {
    const double w_prior = w[i] + a[i];
    const double x_prior = x[i] + w[i] + 0.5 * a[i];
    // M = A P, then P^- = M A' + Q, upper triangle.
    const double m11 = p11[i] + p12[i] + 0.5 * p13[i];
    const double m12 = p12[i] + p22[i] + 0.5 * p23[i];
    const double m13 = p13[i] + p23[i] + 0.5 * p33[i];
    const double m22 = p22[i] + p23[i];
    const double m23 = p23[i] + p33[i];
    const double p11_prior = m11 + m12 + 0.5 * m13 + f11 * q[i];
    const double p12_prior = m12 + m13 + f12 * q[i];
    const double p13_prior = m13 + f13 * q[i];
    const double p22_prior = m22 + m23 + f22 * q[i];
    const double p23_prior = m23 + f23 * q[i];
    const double p33_prior = p33[i] + f33 * q[i];
    const double s = p11_prior + r[i];
    const double k1 = p11_prior / s;
    const double k2 = p12_prior / s;
    const double k3 = p13_prior / s;
    const double innovation = z[i] - x_prior;
    const double x_posterior = x_prior + k1 * innovation;
    w[i] = w_prior + k2 * innovation;
    a[i] = a[i] + k3 * innovation;
    p11[i] = k1 * r[i];
    p12[i] = k2 * r[i];
    p13[i] = k3 * r[i];
    p22[i] = p22_prior - k2 * p12_prior;
    p23[i] = p23_prior - k2 * p13_prior;
    p33[i] = p33_prior - k3 * p13_prior;
    x[i] = x_posterior;
    output[i] = x_posterior;
  }
}

}  // namespace

void StepKalman2(ChannelArrays& arrays, const ProcessNoiseFactors& q, const double* measured,
                 double* output) {
  Step2(arrays[kX], arrays[kW], arrays[kP11], arrays[kP12], arrays[kP22], arrays[kR], arrays[kQ], q,
        measured, output, arrays.channel_count());
}

void StepKalman3(ChannelArrays& arrays, const ProcessNoiseFactors& q, const double* measured,
                 double* output) {
  Step3(arrays[kX], arrays[kW], arrays[kAcceleration3], arrays[kP11Of3], arrays[kP12Of3],
        arrays[kP13Of3], arrays[kP22Of3], arrays[kP23Of3], arrays[kP33Of3], arrays[kROf3],
        arrays[kQOf3], q, measured, output, arrays.channel_count());
}

}  // namespace gauntlet::controller
