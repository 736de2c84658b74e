#include "controller/calibration/curve_fit.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "controller/calibration/noise_estimate.h"
#include "controller/linearisation/polynomial_linearisation.h"
#include "controller/linearisation/table_linearisation.h"

namespace gauntlet::controller {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

struct Pose {
  double sum = 0.0;
  double square_sum = 0.0;
  int samples = 0;
};

}  // namespace

CurveFit FitTable(const VectorXd& counts, const VectorXd& angle_deg) {
  CheckData(counts, angle_deg);
  std::map<double, Pose> poses;  // by angle
  for (Index k = 0; k < counts.size(); ++k) {
    Pose& pose = poses[angle_deg[k]];
    pose.sum += counts[k];
    ++pose.samples;
  }
  for (Index k = 0; k < counts.size(); ++k) {
    Pose& pose = poses[angle_deg[k]];
    const double off = counts[k] - pose.sum / pose.samples;
    pose.square_sum += off * off;
  }
  if (poses.size() < 2) {
    throw SettingError("recording", "has " + std::to_string(poses.size()) +
                                        " poses of known angle, must have at least 2");
  }
  struct Corner {
    double counts, angle_deg, half_width_counts;
  };
  std::vector<Corner> corners;
  for (const auto& [angle, pose] : poses) {
    const double freedom = pose.samples - 1.0;
    const double deviation = std::sqrt(pose.square_sum / freedom / pose.samples);
    corners.push_back({pose.sum / pose.samples, angle,
                       freedom >= 1.0 ? StudentQuantile(freedom) * deviation : kNan});
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

CurveFit FitTwoPoint(const VectorXd& counts, const VectorXd& angle_deg) {
  CheckData(counts, angle_deg);
  if (counts.size() == 0) throw SettingError("recording", "has no pose of known angle");
  const double lowest = angle_deg.minCoeff();
  const double highest = angle_deg.maxCoeff();
  std::vector<Index> ends;  // samples of the two poses
  for (Index k = 0; k < counts.size(); ++k) {
    if (angle_deg[k] == lowest || angle_deg[k] == highest) ends.push_back(k);
  }
  CurveFit fit = FitTable(counts(ends), angle_deg(ends));
  Judge(*MakeTableLinearisation({fit.curve}), counts, angle_deg, fit);
  return fit;
}

CurveFit FitPolynomial(const VectorXd& counts, const VectorXd& angle_deg, int degree) {
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
        freedom >= 1.0 ? StudentQuantile(freedom) * std::sqrt(variance * inverse(i, i)) : kNan);
  }
  return fit;
}

}  // namespace gauntlet::controller
