#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sim/fit/chain_model.h"
#include "sim/fit/least_squares.h"

namespace gauntlet::sim {

/// Parameters of a ChainModel, in SI units and degrees. The speed limit is fitted as its inverse,
/// which is 0 without a limit.
enum ChainParameter {
  kDeadTime,
  kGain,
  kOffset,
  kPlay,
  kLag,
  kInertia,
  kLostPlay,
  kStretch,
  kExtraLag,
  kBend,
  kSlowness,
};

/// The parameters of a fit, and on what friction and the speed limit act. Parameters that are not
/// free have the value of a default ChainModel.
struct ChainFamily {
  std::vector<ChainParameter> free;
  bool friction_in_lag = false;
  bool limit_in_lag = false;

  bool Has(ChainParameter parameter) const;
  /// Position of a free parameter. Precondition: Has().
  Eigen::Index At(ChainParameter parameter) const;
  ChainFamily With(ChainParameter parameter) const;
  bool operator==(const ChainFamily&) const = default;
};

/// Shift in time, scale and offset.
ChainFamily ShiftFamily();
/// Shift in time, scale, offset and play: the loop between two angles.
ChainFamily PlayFamily();
/// The basic chain: dead time, play, second-order lag, gain and offset.
ChainFamily BasicFamily();

/// The model with these free parameters. The middle is that of the bend.
ChainModel ModelOfChain(const ChainFamily& family, const Eigen::VectorXd& parameters,
                        double bend_middle_deg);

/// Least-squares problem of a family for one log. The offset needs no difference quotient.
/// Preconditions: command and angle of equal length; they must outlive the problem.
class ChainProblem : public LeastSquaresProblem {
 public:
  ChainProblem(std::span<const double> command_deg, std::span<const double> angle_deg,
               double rate_hz, ChainFamily family, const std::optional<CommandClock>& frames,
               double beginning_s);

  const ChainFamily& family() const { return family_; }
  double bend_middle_deg() const { return bend_middle_deg_; }
  /// The angle of a model, in the rows that are compared.
  Eigen::VectorXd Simulated(const ChainModel& model);

  Eigen::VectorXd Residual(const Eigen::VectorXd& parameters) override;
  /// Derivative of the model's angle for each parameter, one-sided at a bound.
  Eigen::MatrixXd Derivatives(const Eigen::VectorXd& parameters) override;
  void KeepWithinBounds(Eigen::VectorXd& parameters) const override;

 private:
  Eigen::VectorXd DerivativeOfExchange(const Eigen::VectorXd& parameters);
  void SetBounds(double travel_deg, double period_s);
  void Bound(ChainParameter parameter, double low, double high, double step);

  FineCommand command_;
  Eigen::Index first_;
  Eigen::VectorXd angle_deg_;
  std::vector<double> simulated_deg_;
  ChainFamily family_;
  double bend_middle_deg_ = 0.0;
  double exchange_deg_ = 0.0;
  Eigen::VectorXd low_;
  Eigen::VectorXd high_;
  Eigen::VectorXd step_;
};

}  // namespace gauntlet::sim
