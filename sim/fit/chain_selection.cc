#include "sim/fit/chain_selection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "controller/calibration/robust_statistics.h"
#include "sim/base/quantile.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Share of the largest speeds that noise may have made.
double SpeedOf(std::span<const double> values, double rate_hz, double quantile) {
  constexpr double kWindow_s = 0.05;
  const auto rows = std::max<std::size_t>(2, std::lround(kWindow_s * rate_hz));
  std::vector<double> speeds;
  for (std::size_t k = rows; k < values.size(); ++k) {
    speeds.push_back(std::abs(values[k] - values[k - rows]) * rate_hz / static_cast<double>(rows));
  }
  return Quantile(std::move(speeds), quantile);
}

VectorXd HeldOut(const LeastSquaresFit& fit, const std::vector<WithoutBlock>& without) {
  VectorXd held_out = fit.residual;
  for (Index block = 0; block < kBlocks; ++block) {
    const Index begin = held_out.size() * block / kBlocks;
    const Index rows = held_out.size() * (block + 1) / kBlocks - begin;
    const VectorXd change = without[static_cast<std::size_t>(block)].parameters - fit.parameters;
    held_out.segment(begin, rows) -= fit.derivatives.middleRows(begin, rows) * change;
  }
  return held_out;
}

double ValueOf(const FittedFamily& fit, ChainParameter parameter) {
  return fit.solution.parameters[fit.family.At(parameter)];
}

/// Copies the shared parameters into a start of another family.
VectorXd StartFrom(const FittedFamily& fit, const ChainFamily& family) {
  VectorXd start = VectorXd::Zero(std::ssize(family.free));
  for (const ChainParameter parameter : fit.family.free) {
    start[family.At(parameter)] = ValueOf(fit, parameter);
  }
  return start;
}

/// A family with one parameter more, and the starts of its fit.
struct Candidate {
  ChainFamily family;
  std::vector<VectorXd> starts;
};

Candidate StretchCandidate(const FittedFamily& fit, bool in_lag) {
  Candidate candidate{fit.family.With(kStretch), {}};
  candidate.family.friction_in_lag = in_lag;
  VectorXd start = StartFrom(fit, candidate.family);
  double& play = start[candidate.family.At(kPlay)];
  play *= 1.2;  // a fit without stretch finds too narrow a loop
  start[candidate.family.At(kStretch)] = 0.6 * play;
  candidate.starts = {start};
  return candidate;
}

Candidate LostCandidate(const FittedFamily& fit) {
  Candidate candidate{fit.family.With(kLostPlay), {}};
  const VectorXd start = StartFrom(fit, candidate.family);
  const Index play = candidate.family.At(kPlay);
  for (const double share : {0.1, 0.5, 0.9}) {
    VectorXd split = start;
    split[candidate.family.At(kLostPlay)] = share * start[play];
    split[play] = (1.0 - share) * start[play];
    // Without lost motion, dead time and lag are shared out wrongly.
    const double delay_s = start[candidate.family.At(kDeadTime)] + start[candidate.family.At(kLag)];
    split[candidate.family.At(kDeadTime)] = 0.5 * delay_s;
    split[candidate.family.At(kLag)] = 0.5 * delay_s;
    split[candidate.family.At(kInertia)] = std::pow(0.5 * delay_s / 1.6, 2);
    candidate.starts.push_back(split);
  }
  return candidate;
}

Candidate LimitCandidate(const PartRows& rows, const FittedFamily& fit, bool in_lag) {
  Candidate candidate{fit.family.With(kSlowness), {}};
  candidate.family.limit_in_lag = in_lag;
  const auto [least_in, most_in] = std::ranges::minmax(rows.command_deg);
  const auto [least_out, most_out] = std::ranges::minmax(rows.angle_deg);
  VectorXd start = StartFrom(fit, candidate.family);
  const double delay_s = start[candidate.family.At(kDeadTime)] + start[candidate.family.At(kLag)];
  start[candidate.family.At(kSlowness)] = 1.0 / SpeedOf(rows.angle_deg, rows.rate_hz, 0.98);
  candidate.starts.push_back(start);
  // A limit that is often reached makes dead time and lag too long and the gain too small.
  const double gain = (most_out - least_out) / (most_in - least_in);
  start[candidate.family.At(kOffset)] +=
      (start[candidate.family.At(kGain)] - gain) * 0.5 * (least_in + most_in);
  start[candidate.family.At(kGain)] = gain;
  if (fit.family.Has(kPlay)) start[candidate.family.At(kPlay)] *= 0.2;
  constexpr double kShare = 0.4;
  start[candidate.family.At(kDeadTime)] = kShare * delay_s;
  start[candidate.family.At(kLag)] = kShare * delay_s;
  start[candidate.family.At(kInertia)] = std::pow(kShare * delay_s / 1.6, 2);
  candidate.starts.push_back(start);
  return candidate;
}

/// True if the command moves faster than the angle ever does: a speed limit may be the reason.
bool CommandIsFaster(const PartRows& rows, const FittedFamily& fit) {
  constexpr double kFaster = 1.5;
  const double wanted_deg_s =
      std::abs(ValueOf(fit, kGain)) * SpeedOf(rows.command_deg, rows.rate_hz, 1.0);
  return wanted_deg_s > kFaster * SpeedOf(rows.angle_deg, rows.rate_hz, 0.98);
}

/// A third pole or a zero. The delay of slow motions stays the same.
Candidate ExtraLagCandidate(const FittedFamily& fit) {
  Candidate candidate{fit.family.With(kExtraLag), {}};
  for (const double share : {-0.4, 0.4}) {
    VectorXd start = StartFrom(fit, candidate.family);
    double& lag_s = start[candidate.family.At(kLag)];
    start[candidate.family.At(kExtraLag)] = share * lag_s;
    lag_s *= 1.0 - share;
    candidate.starts.push_back(start);
  }
  return candidate;
}

std::vector<Candidate> CandidatesOf(const PartRows& rows, const FittedFamily& fit,
                                    ChainDetail detail) {
  constexpr double kLeastRate_hz = 100.0;  // friction in the lag is simulated explicitly
  std::vector<Candidate> candidates;
  const bool rubs = fit.family.Has(kPlay);
  if (detail == ChainDetail::kBasic) {
    if (!fit.family.Has(kSlowness) && CommandIsFaster(rows, fit)) {
      for (const bool in_lag : {false, true}) {
        candidates.push_back(LimitCandidate(rows, fit, in_lag));
      }
    }
    if (rubs && !fit.family.Has(kLostPlay)) candidates.push_back(LostCandidate(fit));
    return candidates;
  }
  if (rubs && !fit.family.Has(kStretch)) {
    candidates.push_back(StretchCandidate(fit, false));
    const FineCommand fine = RefineCommand(rows.command_deg, rows.rate_hz, rows.frames);
    if (fine.rate_hz >= kLeastRate_hz) candidates.push_back(StretchCandidate(fit, true));
  }
  if (!fit.family.Has(kExtraLag)) candidates.push_back(ExtraLagCandidate(fit));
  if (!fit.family.Has(kBend)) {
    const ChainFamily family = fit.family.With(kBend);
    candidates.push_back({family, {StartFrom(fit, family)}});
  }
  if (!fit.family.Has(kSlowness)) {
    for (const bool in_lag : {false, true}) candidates.push_back(LimitCandidate(rows, fit, in_lag));
  }
  if (rubs && !fit.family.Has(kLostPlay)) candidates.push_back(LostCandidate(fit));
  return candidates;
}

/// True unless a fit claims lost motion that chance may explain.
bool MayBeClaimed(const FittedFamily& fit, int parts) {
  if (!fit.family.Has(kLostPlay)) return true;
  constexpr double kLeastLost_deg = 0.01;  // noise-free angles always gain a little
  const double lost_deg = ValueOf(fit, kLostPlay);
  if (!(2.0 * lost_deg > kLeastLost_deg)) return false;
  const double error_deg = StandardErrorOf(
      fit.solution, fit.without, [&](const VectorXd& p) { return p[fit.family.At(kLostPlay)]; });
  return !IsByChance(lost_deg / error_deg, parts);
}

double MedianAbsolute(const VectorXd& values) {
  const VectorXd sizes = values.cwiseAbs();
  return controller::MedianOf(std::vector<double>(sizes.begin(), sizes.end()));
}

}  // namespace

std::vector<Reweighted> ReweighRows(const PartRows& rows, const FittedFamily& fit) {
  constexpr double kFast_s = 0.02;
  const Index count = fit.solution.residual.size();
  MatrixXd all(count, fit.solution.parameters.size() + 1);
  all << fit.solution.residual, fit.solution.derivatives;
  const VectorXd command =
      Eigen::Map<const VectorXd>(rows.command_deg.data(), std::ssize(rows.command_deg)).tail(count);
  std::optional<Index> held;
  if (!fit.second_order) held = fit.family.At(kInertia);
  std::vector<Reweighted> result;
  const Index lag = std::max<Index>(1, std::lround(kFast_s * rows.rate_hz));
  result.push_back(
      Reweigh(fit.solution, all.bottomRows(count - lag) - all.topRows(count - lag), held));
  VectorXd speed = VectorXd::Zero(count);
  speed.tail(count - lag) = command.tail(count - lag) - command.head(count - lag);
  const VectorXd place = command.array() - command.mean();
  const VectorXd slow = (speed.array().abs() <= MedianAbsolute(speed)).cast<double>();
  const VectorXd outer = (place.array().abs() >= MedianAbsolute(place)).cast<double>();
  for (const VectorXd& weight : {slow, outer}) {
    result.push_back(Reweigh(fit.solution, weight.asDiagonal() * all, held));
  }
  return result;
}

ChainModel FittedFamily::ModelOf(const VectorXd& parameters) const {
  return ModelOfChain(family, parameters, bend_middle_deg);
}

std::optional<FittedFamily> FitFamily(const PartRows& rows, const ChainFamily& family,
                                      const std::vector<VectorXd>& starts) {
  ChainProblem problem(rows.command_deg, rows.angle_deg, rows.rate_hz, family, rows.frames,
                       rows.beginning_s);
  FittedFamily fit;
  fit.family = family;
  fit.bend_middle_deg = problem.bend_middle_deg();
  const auto [least, most] = std::ranges::minmax(rows.command_deg);
  fit.half_travel_deg = 0.5 * (most - least);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    LeastSquaresFit solution = Minimise(problem, starts[i]);
    if (i == 0 || solution.squares < fit.solution.squares) fit.solution = std::move(solution);
  }
  std::optional<std::vector<WithoutBlock>> without = WithoutEachBlock(fit.solution);
  if (!without && family.Has(kInertia)) {
    without = WithoutEachBlock(fit.solution, family.At(kInertia));
    fit.second_order = false;
  }
  if (!without) return std::nullopt;
  fit.without = std::move(*without);
  fit.held_out = HeldOut(fit.solution, fit.without);
  return fit;
}

std::vector<FittedFamily> SelectChain(const PartRows& rows, FittedFamily basic, int parts,
                                      ChainDetail detail) {
  constexpr int kMostAdded = 3;
  std::vector<FittedFamily> fits = {std::move(basic)};
  std::size_t selected = 0;
  for (int added = 0; added < kMostAdded; ++added) {
    const std::vector<Candidate> candidates = CandidatesOf(rows, fits[selected], detail);
    std::optional<std::size_t> best;
    for (const Candidate& candidate : candidates) {
      std::optional<FittedFamily> fit = FitFamily(rows, candidate.family, candidate.starts);
      if (!fit || !MayBeClaimed(*fit, parts)) continue;
      fits.push_back(std::move(*fit));
      const auto squares = [&](std::size_t i) { return fits[i].held_out.squaredNorm(); };
      if (!best || squares(fits.size() - 1) < squares(*best)) best = fits.size() - 1;
    }
    if (!best) break;
    const double t = StudentOfGain(fits[*best].held_out, fits[selected].held_out);
    if (IsByChance(t, static_cast<int>(candidates.size()))) break;
    selected = *best;
  }
  std::swap(fits[0], fits[selected]);
  const VectorXd& held_out = fits[0].held_out;
  std::erase_if(fits, [&](const FittedFamily& fit) {
    return &fit != &fits[0] && !IsByChance(StudentOfGain(held_out, fit.held_out), 1);
  });
  return fits;
}

}  // namespace gauntlet::sim
