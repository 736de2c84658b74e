#include "controller/linearisation/polynomial_linearisation.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "controller/angle.h"
#include "controller/assert.h"

namespace gauntlet::controller {
namespace {

struct Polynomial {
  std::vector<double> coefficients;  // rad
  double center_counts;
  double scale_counts;

  double Value(double u) const {
    double value = 0.0;
    for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) value = value * u + *c;
    return value;
  }
  double Slope(double u) const {
    double slope = 0.0;
    for (std::size_t i = coefficients.size() - 1; i > 0; --i) {
      slope = slope * u + i * coefficients[i];
    }
    return slope;
  }
  /// With the tangents at the ends beyond -1 and 1.
  double Angle(double counts) const {
    const double u = (counts - center_counts) / scale_counts;
    const double inside = std::clamp(u, -1.0, 1.0);
    return Value(inside) + Slope(inside) * (u - inside);
  }
  double Counts(double angle) const {
    const double sign = Value(1.0) > Value(-1.0) ? 1.0 : -1.0;
    double u = 0.0;
    if (sign * angle <= sign * Value(-1.0)) {
      u = -1.0 + (angle - Value(-1.0)) / Slope(-1.0);
    } else if (sign * angle >= sign * Value(1.0)) {
      u = 1.0 + (angle - Value(1.0)) / Slope(1.0);
    } else {
      double low = -1.0;
      double high = 1.0;
      constexpr int kHalvings = 53;  // down to the spacing of numbers near 1
      for (int i = 0; i < kHalvings; ++i) {
        u = 0.5 * (low + high);
        (sign * Value(u) < sign * angle ? low : high) = u;
      }
    }
    return center_counts + scale_counts * u;
  }
};

Polynomial MakePolynomial(const ChannelCurve& curve, std::size_t channel) {
  const std::string place = "linearisation.channels[" + std::to_string(channel) + "]";
  if (curve.coefficients_deg.size() < 2) {
    throw SettingError(place, "coefficients_deg must have at least 2 values");
  }
  Polynomial polynomial{{}, curve.center_counts, curve.scale_counts};
  for (const double c : curve.coefficients_deg) {
    polynomial.coefficients.push_back(c * kRadPerDeg);
  }
  // Fine enough for the low degrees of sensors; the ends belong to it because tangents go on there.
  constexpr int kChecks = 1000;
  const double sign = polynomial.Slope(0.0);
  for (int i = -kChecks; i <= kChecks; ++i) {
    const double u = static_cast<double>(i) / kChecks;
    if (polynomial.Slope(u) * sign > 0.0) continue;
    const double counts = curve.center_counts + u * curve.scale_counts;
    throw SettingError(place, "the polynomial turns back at " + NumberText(counts) +
                                  " counts; it must grow or fall over its whole range");
  }
  return polynomial;
}

class PolynomialLinearisation final : public Linearisation {
 public:
  explicit PolynomialLinearisation(const std::vector<ChannelCurve>& curves) {
    for (std::size_t i = 0; i < curves.size(); ++i) {
      polynomials_.push_back(MakePolynomial(curves[i], i));
    }
  }

  int channel_count() const noexcept override { return polynomials_.size(); }
  void ToAngles(std::span<const double> counts,
                std::span<double> angle_rad) const noexcept override {
    GAUNTLET_ASSERT(angle_rad.size() == counts.size() && std::ssize(counts) % channel_count() == 0);
    for (std::size_t at = 0; at < counts.size(); ++at) {
      angle_rad[at] = polynomials_[at % polynomials_.size()].Angle(counts[at]);
    }
  }
  void ToCounts(std::span<const double> angle_rad,
                std::span<double> counts) const noexcept override {
    GAUNTLET_ASSERT(counts.size() == angle_rad.size() && std::ssize(counts) % channel_count() == 0);
    for (std::size_t at = 0; at < angle_rad.size(); ++at) {
      counts[at] = polynomials_[at % polynomials_.size()].Counts(angle_rad[at]);
    }
  }

 private:
  std::vector<Polynomial> polynomials_;
};

}  // namespace

std::unique_ptr<Linearisation> MakePolynomialLinearisation(
    const std::vector<ChannelCurve>& curves) {
  return std::make_unique<PolynomialLinearisation>(curves);
}

}  // namespace gauntlet::controller
