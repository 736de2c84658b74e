#include "controller/calibration/curve_fit.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>

#include "controller/assert.h"
#include "controller/calibration/noise_correlation.h"
#include "controller/calibration/noise_estimate.h"
#include "controller/calibration/rounded_noise.h"
#include "controller/linearisation/polynomial_linearisation.h"
#include "controller/linearisation/table_linearisation.h"
#include "controller/number.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd VectorOf(std::span<const double> values) {
  return Eigen::Map<const VectorXd>(values.data(), std::ssize(values));
}
std::span<const double> ValuesOf(const VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

void CheckData(const VectorXd& counts, const VectorXd& angle_deg) {
  if (counts.size() != angle_deg.size() || !counts.allFinite() || !angle_deg.allFinite()) {
    throw SettingError("recording", "must have one finite angle for each finite count");
  }
}

/// Fills in the errors that a curve leaves on its data.
void Judge(const Linearisation& linearisation, const VectorXd& counts, const VectorXd& angle_deg,
           CurveFit& fit) {
  double sum = 0.0;
  fit.largest_error_deg = 0.0;
  for (Index k = 0; k < counts.size(); ++k) {
    double angle_rad = 0.0;
    linearisation.ToAngles({&counts[k], 1}, {&angle_rad, 1});
    const double error = std::abs(angle_rad * 180.0 / std::numbers::pi - angle_deg[k]);
    sum += error * error;
    fit.largest_error_deg = std::max(fit.largest_error_deg, error);
  }
  fit.rms_error_deg = std::sqrt(sum / counts.size());
}

/// 97.5 % quantile of Student's law; Hill's expansion around the normal one, good from 3 degrees of
/// freedom on.
double StudentQuantile(double degrees_of_freedom) {
  const double z = NormalQuantile(0.975);
  const double f = degrees_of_freedom;
  return z + (z * z * z + z) / (4.0 * f) +
         (5.0 * std::pow(z, 5) + 16.0 * z * z * z + 3.0 * z) / (96.0 * f * f);
}

/// The samples of one pose, of all times that it was taken.
struct Pose {
  std::vector<VectorXd> runs;

  double Samples() const {
    double samples = 0.0;
    for (const VectorXd& run : runs) samples += static_cast<double>(run.size());
    return samples;
  }
  double Mean() const {
    double sum = 0.0;
    for (const VectorXd& run : runs) sum += run.sum();
    return sum / Samples();
  }

  /// Half width of the 95 % interval of its mean; NaN where there is too little to tell. `noise` is
  /// that of the channel and tells how samples depend on those before; how large it is, the pose
  /// itself shows, with what differs between its runs.
  double HalfWidth95(const ChannelNoise& noise) const {
    const double samples = Samples();
    const double mean = Mean();
    double square_sum = 0.0;
    double dependent = 0.0;  // variances that the sum of all samples has
    for (const VectorXd& run : runs) {
      square_sum += (run.array() - mean).square().sum();
      const auto length = static_cast<double>(run.size());
      dependent += length * noise.MeanFactor(length);
    }
    const double freedom = (samples - 1.0) / noise.VarianceFactor();
    const double taken = dependent / samples;
    if (freedom < 1.0 || taken >= samples) return kNaN;
    const double variance = square_sum / (samples - taken);
    return StudentQuantile(freedom) * std::sqrt(variance * dependent) / samples;
  }
};

/// By angle. Samples that follow each other and have the same angle are a run.
std::map<double, Pose> PosesOf(const VectorXd& counts, const VectorXd& angle_deg) {
  std::map<double, Pose> poses;
  Index begin = 0;
  for (Index k = 1; k <= counts.size(); ++k) {
    if (k < counts.size() && angle_deg[k] == angle_deg[begin]) continue;
    poses[angle_deg[begin]].runs.emplace_back(counts.segment(begin, k - begin));
    begin = k;
  }
  return poses;
}

std::vector<VectorXd> RunsOf(const std::map<double, Pose>& poses) {
  std::vector<VectorXd> runs;
  for (const auto& [angle, pose] : poses) {
    runs.insert(runs.end(), pose.runs.begin(), pose.runs.end());
  }
  return runs;
}

/// How far rounding to steps moves a mean of normal noise at most; by the least noise that the runs
/// bear, for they may look noisier than they are.
double RoundingOfMean(const std::vector<VectorXd>& runs, const ChannelNoise& noise, double step) {
  constexpr double kSureFrom = 0.5;  // steps^2: from there on it is below 1e-4 steps
  const double step2 = step * step;
  if (noise.variance - step2 / 12.0 >= kSureFrom * step2) return 0.0;
  const double least =
      EstimateRoundedNoise(runs, step, 1.0 / noise.VarianceFactor(), 0.95).variance_low;
  return 0.5 * step * std::exp(-2.0 * std::numbers::pi * std::numbers::pi * least / step2);
}

}  // namespace

CurveFit FitTable(std::span<const double> counts_of_samples,
                  std::span<const double> angle_of_samples_deg, double resolution_counts) {
  GAUNTLET_ASSERT(resolution_counts >= 0.0);
  const VectorXd counts = VectorOf(counts_of_samples);
  const VectorXd angle_deg = VectorOf(angle_of_samples_deg);
  CheckData(counts, angle_deg);
  const std::map<double, Pose> poses =
      counts.size() > 0 ? PosesOf(counts, angle_deg) : std::map<double, Pose>();
  if (poses.size() < 2) {
    throw SettingError("recording", "has " + std::to_string(poses.size()) +
                                        " poses of known angle, must have at least 2");
  }
  struct Corner {
    double counts, angle_deg, half_width_counts;
  };
  std::vector<Corner> corners;
  const std::vector<VectorXd> runs = RunsOf(poses);
  const ChannelNoise noise = DescribeNoise(runs, resolution_counts * resolution_counts / 12.0);
  const double rounding =
      resolution_counts > 0.0 ? RoundingOfMean(runs, noise, resolution_counts) : 0.0;
  for (const auto& [angle, pose] : poses) {
    corners.push_back({pose.Mean(), angle, pose.HalfWidth95(noise) + rounding});
  }
  if (corners.back().counts < corners.front().counts) {
    std::reverse(corners.begin(), corners.end());
  }
  CurveFit fit;
  for (const Corner& corner : corners) {
    fit.curve.counts.push_back(corner.counts);
    fit.curve.angle_deg.push_back(corner.angle_deg);
  }
  const auto linearisation = MakeTableLinearisation({fit.curve});  // checks that it is monotone
  for (std::size_t i = 0; i < corners.size(); ++i) {
    // From counts to degrees by the steeper of the two pieces that meet here.
    double slope = 0.0;
    for (std::size_t j = std::max<std::size_t>(i, 1); j < std::min(i + 2, corners.size()); ++j) {
      slope = std::max(slope, std::abs((corners[j].angle_deg - corners[j - 1].angle_deg) /
                                       (corners[j].counts - corners[j - 1].counts)));
    }
    fit.half_width_95_deg.push_back(slope * corners[i].half_width_counts);
  }
  Judge(*linearisation, counts, angle_deg, fit);
  return fit;
}

CurveFit FitTwoPoint(std::span<const double> counts_of_samples,
                     std::span<const double> angle_of_samples_deg, double resolution_counts) {
  const VectorXd counts = VectorOf(counts_of_samples);
  const VectorXd angle_deg = VectorOf(angle_of_samples_deg);
  CheckData(counts, angle_deg);
  if (counts.size() == 0) throw SettingError("recording", "has no pose of known angle");
  const double lowest = angle_deg.minCoeff();
  const double highest = angle_deg.maxCoeff();
  std::vector<Index> ends;  // samples of the two poses
  for (Index k = 0; k < counts.size(); ++k) {
    if (angle_deg[k] == lowest || angle_deg[k] == highest) ends.push_back(k);
  }
  CurveFit fit = FitTable(ValuesOf(counts(ends)), ValuesOf(angle_deg(ends)), resolution_counts);
  Judge(*MakeTableLinearisation({fit.curve}), counts, angle_deg, fit);
  return fit;
}

CurveFit FitPolynomial(std::span<const double> counts_of_samples,
                       std::span<const double> angle_of_samples_deg, int degree) {
  const VectorXd counts = VectorOf(counts_of_samples);
  const VectorXd angle_deg = VectorOf(angle_of_samples_deg);
  CheckData(counts, angle_deg);
  const Index unknowns = degree + 1;
  if (degree < 1 || counts.size() < unknowns || counts.maxCoeff() <= counts.minCoeff()) {
    throw SettingError("degree", "is " + std::to_string(degree) +
                                     ", must be at least 1 and below the number of different "
                                     "counts");
  }
  CurveFit fit;
  fit.curve.center_counts = 0.5 * (counts.maxCoeff() + counts.minCoeff());
  fit.curve.scale_counts = 0.5 * (counts.maxCoeff() - counts.minCoeff());
  Eigen::MatrixXd powers(counts.size(), unknowns);
  powers.col(0).setOnes();
  const VectorXd u = (counts.array() - fit.curve.center_counts) / fit.curve.scale_counts;
  for (Index i = 1; i < unknowns; ++i) powers.col(i) = powers.col(i - 1).cwiseProduct(u);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(powers);
  if (decomposition.rank() < unknowns) {
    throw SettingError("degree", "is " + std::to_string(degree) +
                                     ", must be below the number of different counts");
  }
  const VectorXd coefficients = decomposition.solve(angle_deg);
  fit.curve.coefficients_deg.assign(coefficients.begin(), coefficients.end());
  Judge(*MakePolynomialLinearisation({fit.curve}), counts, angle_deg, fit);

  const double freedom = counts.size() - unknowns;
  const Eigen::MatrixXd inverse = (powers.transpose() * powers).inverse();
  const double variance = (powers * coefficients - angle_deg).squaredNorm() / freedom;
  for (Index i = 0; i < unknowns; ++i) {
    fit.half_width_95_deg.push_back(
        freedom >= 1.0 ? StudentQuantile(freedom) * std::sqrt(variance * inverse(i, i)) : kNaN);
  }
  return fit;
}

}  // namespace gauntlet::controller
