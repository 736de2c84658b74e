#include "controller/calibration/rounded_noise.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "controller/assert.h"
#include "controller/calibration/noise_estimate.h"

namespace gauntlet::controller {
namespace {

/// How often each value was seen, in steps.
using Histogram = std::map<double, double>;

Histogram HistogramOf(const Eigen::VectorXd& values, double step) {
  Histogram histogram;
  for (const double value : values) {
    if (!std::isnan(value)) ++histogram[std::round(value / step)];
  }
  return histogram;
}

/// Probability that normal noise of variance 1 is above x.
double Above(double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); }

/// Probability that it is from `low` to `high`, in the tail that keeps the digits.
double Between(double low, double high) {
  return low > 0.0 ? Above(low) - Above(high) : Above(-high) - Above(-low);
}

double LogLikelihood(const Histogram& histogram, double mean, double sigma) {
  constexpr double kLeast = 1e-300;
  double sum = 0.0;
  for (const auto& [value, count] : histogram) {
    const double low = (value - 0.5 - mean) / sigma;
    sum += count * std::log(std::max(Between(low, low + 1.0 / sigma), kLeast));
  }
  return sum;
}

/// The largest over all means. It is unimodal in the mean: the logarithm of the probability of an
/// interval is concave.
double LogLikelihood(const Histogram& histogram, double sigma) {
  if (histogram.empty()) return 0.0;
  constexpr double kGolden = 1.0 / std::numbers::phi;
  double low = histogram.begin()->first - 0.5;
  double high = histogram.rbegin()->first + 0.5;
  double a = high - kGolden * (high - low);
  double b = low + kGolden * (high - low);
  double at_a = LogLikelihood(histogram, a, sigma);
  double at_b = LogLikelihood(histogram, b, sigma);
  while (high - low > 1e-4 * sigma) {
    if (at_a > at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = LogLikelihood(histogram, a, sigma);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = LogLikelihood(histogram, b, sigma);
    }
  }
  return std::max(at_a, at_b);
}

/// Searched deviations, in steps; below the lowest, rounding hides everything.
constexpr double kLowest = 0.02;
constexpr double kHighest = 2.0;
constexpr int kGrid = 60;

/// Likelihood of a standard deviation, given by its place on a grid with equal ratios, which may
/// lie between two of it.
class Profile {
 public:
  Profile(std::vector<Histogram> histograms, double weight)
      : histograms_(std::move(histograms)), weight_(weight) {}

  static double Sigma(double place) {
    return kLowest * std::pow(kHighest / kLowest, place / (kGrid - 1.0));
  }
  double At(double place) const {
    double sum = 0.0;
    for (const Histogram& histogram : histograms_) {
      sum += weight_ * LogLikelihood(histogram, Sigma(place));
    }
    return sum;
  }
  /// Place at which it falls to `least`, between one above and one below.
  double Crossing(double inside, double outside, double least) const {
    for (int i = 0; i < 30; ++i) {
      const double middle = 0.5 * (inside + outside);
      (At(middle) >= least ? inside : outside) = middle;
    }
    return inside;
  }

 private:
  std::vector<Histogram> histograms_;
  double weight_;
};

}  // namespace

RoundedNoise EstimateRoundedNoise(const std::vector<Eigen::VectorXd>& stretches, double step,
                                  double weight, double confidence) {
  GAUNTLET_ASSERT(step > 0.0 && weight > 0.0);
  GAUNTLET_ASSERT(0.0 < confidence && confidence < 1.0);
  constexpr double kEqual = 1e-3;  // of log-likelihoods
  std::vector<Histogram> histograms;
  for (const Eigen::VectorXd& stretch : stretches) {
    histograms.push_back(HistogramOf(stretch, step));
  }
  const Profile profile(std::move(histograms), weight);
  std::vector<double> likelihood;
  for (int i = 0; i < kGrid; ++i) likelihood.push_back(profile.At(i));
  const auto top = std::ranges::max_element(likelihood);
  // The top may lie between two places; thirds find it.
  double low = std::max<double>(static_cast<double>(top - likelihood.begin()) - 1.0, 0.0);
  double high = std::min<double>(low + 2.0, kGrid - 1.0);
  while (high - low > 1e-3) {
    const double third = (high - low) / 3.0;
    if (profile.At(low + third) < profile.At(high - third)) {
      low += third;
    } else {
      high -= third;
    }
  }
  const double best = 0.5 * (low + high);
  const double largest = std::max(profile.At(best), *top);
  const double normal = NormalQuantile(0.5 + 0.5 * confidence);
  const double least = largest - 0.5 * normal * normal;
  const double at_lowest = likelihood.front();
  const double at_highest = likelihood.back();
  const double from = at_lowest >= least ? 0.0 : profile.Crossing(best, 0.0, least);
  const double to = at_highest >= least ? kGrid - 1.0 : profile.Crossing(best, kGrid - 1.0, least);
  const double most = at_highest >= largest - kEqual
                          ? kGrid - 1.0
                          : profile.Crossing(best, kGrid - 1.0, largest - kEqual);
  const auto variance = [step](double place) {
    const double deviation = Profile::Sigma(place) * step;
    return deviation * deviation;
  };
  return {variance(most), at_lowest >= least ? 0.0 : variance(from), variance(to)};
}

}  // namespace gauntlet::controller
