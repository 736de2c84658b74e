#pragma once

#include <string>
#include <vector>

#include "controller/export.h"
#include "controller/settings.h"

namespace gauntlet::controller {

enum class LinearisationKind { kGlove, kTable, kPolynomial };

/// The curve of one channel from counts to bending angle, as `gauntlet calibrate` writes it.
struct GAUNTLET_API ChannelCurve {
  std::string channel;  // empty: the channel at this place of the list

  /// kTable: corners of a broken line; two are a two-point calibration. Beyond the ends the first
  /// and last pieces go on.
  std::vector<double> counts;
  std::vector<double> angle_deg;

  /// kPolynomial: angle_deg = c_0 + c_1 u + c_2 u^2 + ..., u = (counts - center) / scale. It holds
  /// for -1 <= u <= 1; beyond, the tangents at the ends go on.
  std::vector<double> coefficients_deg;
  double center_counts = 512.0;
  double scale_counts = 512.0;

  void Visit(SettingsVisitor& visitor);
};

/// Which linearisation a controller uses: the two known poses of the glove, or measured curves.
struct GAUNTLET_API LinearisationConfig {
  LinearisationKind kind = LinearisationKind::kGlove;
  std::vector<ChannelCurve> channels;

  void Visit(SettingsVisitor& visitor);
};

}  // namespace gauntlet::controller
