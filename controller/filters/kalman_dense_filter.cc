#include "controller/filters/kalman_dense_filter.h"

#include <Eigen/Cholesky>
#include <iterator>
#include <string>
#include <utility>

#include "controller/filters/check_filter.h"
#include "controller/filters/filter_registry.h"
#include "controller/filters/state_filter.h"
#include "controller/filters/subnormal.h"
#include "controller/linear_algebra.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostChannels = 128;

MatrixXd FromRows(const std::vector<double>& values, Index size) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const Rows>(values.data(), size, size);
}

/// One variance for all, one each, or a whole covariance of the channels.
MatrixXd ChannelCovariance(const char* key, const std::vector<double>& values, Index n) {
  const Index count = std::ssize(values);
  if (count == 1) return values.front() * MatrixXd::Identity(n, n);
  if (count == n) return Eigen::Map<const VectorXd>(values.data(), n).asDiagonal();
  if (count == n * n) return FromRows(values, n);
  std::string allowed = "1, " + std::to_string(n) + " or " + std::to_string(n * n);
  if (key[0] == 'q') allowed += " or " + std::to_string(4 * n * n);
  throw SettingError(key, "has " + std::to_string(count) + " values, must have " + allowed +
                              " for " + std::to_string(n) + " channels");
}

void CheckCovariance(const char* key, const MatrixXd& covariance, bool positive_definite) {
  const double scale = covariance.cwiseAbs().maxCoeff();
  const bool symmetric =
      (covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * scale;
  const VectorXd values = EigenvaluesOf(covariance);
  const bool allowed = positive_definite ? values[0] > 0.0 : values[0] >= -1e-12 * scale;
  if (!symmetric || !allowed) {
    throw SettingError(key, std::string("must be symmetric and positive ") +
                                (positive_definite ? "definite" : "semi-definite"));
  }
}

class KalmanDenseFilter final : public StateFilter<Filter> {
 public:
  KalmanDenseFilter(const KalmanDenseConfig& config, int n)
      : StateFilter(config.start, n),
        r_(ChannelCovariance("r", config.r, n)),
        q11_(n, n),
        q12_(MatrixXd::Zero(n, n)),
        q22_(n, n),
        x_(n),
        w_(n),
        innovation_(n),
        p11_(n, n),
        p12_(n, n),
        p22_(n, n),
        gain1_(n, n),
        gain2_(n, n),
        product_(n, n),
        cholesky_(n) {
    CheckCovariance("r", r_, true);
    if (std::ssize(config.q) == 4 * n * n) {
      const MatrixXd q = FromRows(config.q, 2 * n);
      CheckCovariance("q", q, false);
      q11_ = q.topLeftCorner(n, n);
      q12_ = q.topRightCorner(n, n);
      q22_ = q.bottomRightCorner(n, n);
    } else {
      q11_ = ChannelCovariance("q", config.q, n);
      CheckCovariance("q", q11_, false);
      q22_ = q11_;
    }
    Reset();
  }

 private:
  bool SwapChecked(Filter& from) noexcept override {
    auto* other = dynamic_cast<KalmanDenseFilter*>(&from);
    if (other == nullptr) return false;
    x_.swap(other->x_);
    w_.swap(other->w_);
    p11_.swap(other->p11_);
    p12_.swap(other->p12_);
    p22_.swap(other->p22_);
    SwapFresh(*other);
    return true;
  }
  void StepAll(std::span<const double> input, std::span<double> output) noexcept override {
    Predict();
    CopyWithoutSubnormals(input.data(), innovation_.data(), channel_count());
    Update();
    CopyWithoutSubnormals(x_.data(), x_.data(), channel_count());
    CopyWithoutSubnormals(w_.data(), w_.data(), channel_count());
    std::copy(x_.begin(), x_.end(), output.begin());
  }

  void Predict() noexcept {
    x_ += w_;
    // Each of these reads what the next ones have not changed yet.
    p11_ += p22_ + q11_;
    product_ = p12_ + p12_.transpose();
    p11_ += product_;
    p12_ += p22_ + q12_;
    p22_ += q22_;
  }

  /// With what was measured in `innovation_`.
  void Update() noexcept {
    product_ = p11_ + r_;
    cholesky_.compute(product_);
    gain1_ = p11_;  // transposed gains: S^-1 H P^-
    cholesky_.solveInPlace(gain1_);
    gain2_ = p12_;
    cholesky_.solveInPlace(gain2_);
    innovation_ -= x_;
    x_.noalias() += gain1_.transpose() * innovation_;
    w_.noalias() += gain2_.transpose() * innovation_;
    product_.noalias() = gain2_.transpose() * p12_;
    p22_ -= product_;
    MakeSymmetric(p22_);
    product_.noalias() = gain1_.transpose() * p12_;
    p12_ -= product_;
    product_.noalias() = gain1_.transpose() * p11_;
    p11_ -= product_;
    MakeSymmetric(p11_);
  }

  void MakeSymmetric(MatrixXd& matrix) noexcept {
    product_ = 0.5 * (matrix + matrix.transpose());
    matrix = product_;
  }

  /// Independent of all other channels.
  void SetState(int channel, double position) noexcept override {
    x_[channel] = position;
    w_[channel] = 0.0;
    for (MatrixXd* block : {&p11_, &p12_, &p22_}) {
      block->row(channel).setZero();
      block->col(channel).setZero();
    }
    p11_(channel, channel) = 1.0;
    p22_(channel, channel) = 1.0;
  }

  MatrixXd r_, q11_, q12_, q22_;
  VectorXd x_, w_, innovation_;
  MatrixXd p11_, p12_, p22_;  // blocks of P; p21 is p12'
  MatrixXd gain1_, gain2_, product_;
  Eigen::LLT<MatrixXd> cholesky_;
};

}  // namespace

void KalmanDenseConfig::Visit(SettingsVisitor& visitor) {
  VisitStart(visitor, start);
  visitor.Numbers({"r",
                   "measurement covariance [unit of the input squared]: one variance for all, one "
                   "each, or the full matrix row by row",
                   -1e20, 1e20},
                  r);
  visitor.Numbers({"q",
                   "process covariance per step: one variance for all, one each, the full matrix "
                   "of the channels, or the full matrix of all 2n states",
                   -1e20, 1e20},
                  q);
}

std::unique_ptr<Filter> MakeFilter(const KalmanDenseConfig& config, int channel_count,
                                   double rate_hz) {
  CheckFilter(config, channel_count, rate_hz);
  if (channel_count > kMostChannels) {
    throw SettingError("kind", "kalman_dense takes at most " + std::to_string(kMostChannels) +
                                   " channels, there are " + std::to_string(channel_count));
  }
  return std::make_unique<KalmanDenseFilter>(config, channel_count);
}

}  // namespace gauntlet::controller
