#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sim/fit/chain_fit.h"
#include "sim/fit/chain_problem.h"

namespace gauntlet::sim {

/// A log of one part, and the clock of its command.
struct PartRows {
  std::span<const double> command_deg;
  std::span<const double> angle_deg;
  double rate_hz = 0.0;
  std::optional<CommandClock> frames;
  double beginning_s = 0.0;  // not compared, because the state of the chain is unknown there
};

/// A fitted family, and the same fit without each of the blocks.
struct FittedFamily {
  ChainFamily family;
  LeastSquaresFit solution;
  std::vector<WithoutBlock> without;
  bool second_order = true;  // false: a first-order lag explains the log as well
  /// Residual of each row by the fit without its block, to first order.
  Eigen::VectorXd held_out;
  double bend_middle_deg = 0.0;
  double half_travel_deg = 0.0;        // of the command
  std::vector<Reweighted> reweighted;  // of the selected fit, see ReweighRows()

  /// The model of some parameters of this family.
  ChainModel ModelOf(const Eigen::VectorXd& parameters) const;
};

/// The best fit of a family from several starts. None if the log does not distinguish the
/// parameters.
std::optional<FittedFamily> FitFamily(const PartRows& rows, const ChainFamily& family,
                                      const std::vector<Eigen::VectorXd>& starts);

/// The parameters of a fit by three other weights of its rows: by the fast changes, by the slow
/// rows, and by the rows far from the middle of the command.
std::vector<Reweighted> ReweighRows(const PartRows& rows, const FittedFamily& fit);

/// Adds friction with stretch, a third pole or a zero, a speed limit, a bend and lost motion to a
/// fit, one at a time, as long as the best of them predicts held-out blocks better. Better: one-
/// sided t of the gain over the 20 blocks, at 5 % for all candidates together; lost motion also
/// needs a value beyond chance among all `parts` of the hand.
///
/// Result: the selected fit first, then the others whose held-out error is not larger than its by
/// more than chance explains.
/// Source: cross-validation: Stone, J. R. Stat. Soc. B 36, 111-147 (1974).
std::vector<FittedFamily> SelectChain(const PartRows& rows, FittedFamily basic, int parts,
                                      ChainDetail detail);

}  // namespace gauntlet::sim
