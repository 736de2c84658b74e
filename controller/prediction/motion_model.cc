#include "controller/prediction/motion_model.h"

#include <cmath>
#include <numbers>

#include "controller/assert.h"
#include "controller/filters/riccati.h"

namespace gauntlet::controller {
namespace {

/// exp(m): m halved until it is small, its Taylor series, and squared as often.
template <int n>
Eigen::Matrix<long double, n, n> Exponential(Eigen::Matrix<long double, n, n> m) {
  using Matrix = Eigen::Matrix<long double, n, n>;
  int halvings = 0;
  while (m.cwiseAbs().rowwise().sum().maxCoeff() > 0.5L) {
    m *= 0.5L;
    ++halvings;
  }
  Matrix sum = Matrix::Identity();
  Matrix term = Matrix::Identity();
  for (int i = 1; i <= 20; ++i) {  // 0.5^20 / 20! is below 1e-24
    term = term * m / i;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

}  // namespace

MotionModel WhiteAcceleration(double q_deg2_per_s3) {
  MotionModel model = WhiteJerk(0.0);
  model.f(1, 2) = 0.0;
  model.q(1, 1) = q_deg2_per_s3;
  return model;
}

MotionModel WhiteJerk(double q_deg2_per_s5) {
  MotionModel model;
  model.f << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0;
  model.q = Eigen::Vector3d(0.0, 0.0, q_deg2_per_s5).asDiagonal();
  model.h << 1.0, 0.0, 0.0;
  return model;
}

MotionModel Swing(double frequency_hz, double damping, double q_deg2_per_s3,
                  double drift_deg2_per_s) {
  const double w = 2.0 * std::numbers::pi * frequency_hz;
  MotionModel model;
  model.f << 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -w * w, -2.0 * damping * w;
  model.q = Eigen::Vector3d(drift_deg2_per_s, 0.0, q_deg2_per_s3).asDiagonal();
  model.h << 1.0, 1.0, 0.0;
  return model;
}

SettledFilter Settle(const MotionModel& model, double r_deg2, double step_s) {
  GAUNTLET_ASSERT(r_deg2 > 0.0 && step_s > 0.0);
  // exp([-F Q; 0 F'] T) = [. inv(A) Q_T; 0 A']
  using Matrix6 = Eigen::Matrix<long double, 6, 6>;
  Matrix6 both = Matrix6::Zero();
  both.topLeftCorner<3, 3>() = -model.f.cast<long double>();
  both.topRightCorner<3, 3>() = model.q.cast<long double>();
  both.bottomRightCorner<3, 3>() = model.f.transpose().cast<long double>();
  const Matrix6 e = Exponential<6>(both * static_cast<long double>(step_s));
  const Eigen::Matrix<long double, 3, 3> a = e.bottomRightCorner<3, 3>().transpose();
  const Eigen::Matrix<long double, 3, 3> q = a * e.topRightCorner<3, 3>();

  SettledFilter filter;
  filter.a = a.cast<double>();
  const Eigen::MatrixXd p =
      SolveRiccati(filter.a, model.h, q.cast<double>(), Eigen::MatrixXd::Constant(1, 1, r_deg2));
  const Eigen::Vector3d to_angle = p * model.h.transpose();
  filter.k = to_angle / (model.h * to_angle + r_deg2);
  return filter;
}

Eigen::RowVector3d LookAhead(const MotionModel& model, double horizon_s) {
  const Eigen::Matrix<long double, 3, 3> f = model.f.cast<long double>() * horizon_s;
  return (model.h.cast<long double>() * Exponential<3>(f)).cast<double>();
}

}  // namespace gauntlet::controller
