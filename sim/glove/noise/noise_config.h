#pragma once

#include <vector>

#include "controller/settings.h"

namespace gauntlet::sim {

/// Diagonal of the measurement covariance that the paper estimated from 18 channels [counts^2].
/// Source: Bai, Jiang, Yokoi, section 2.4. The paper does not name the channels; we keep its order.
inline constexpr double kPaperVarianceCounts2[18] = {21.18, 12.52, 10.62, 9.86,  26.94, 10.08,
                                                     9.71,  17.58, 6.05,  9.91,  47.19, 11.04,
                                                     7.56,  23.94, 26.82, 28.82, 27.69, 31.49};

enum class WhiteNoiseKind { kNone, kBoxMuller, kGalton };

/// Noise of the electrical signal, before the converter: white Gaussian noise, and what may be
/// added to it. Counts are those of a 10-bit converter: a coarser converter sees the same noise in
/// fewer counts.
struct NoiseConfig {
  WhiteNoiseKind kind = WhiteNoiseKind::kBoxMuller;
  std::vector<double> variance_counts2;    // empty: the paper's
  std::vector<double> covariance_counts2;  // row by row; empty: channels are independent
  double variance_scale = 1.0;
  int galton_rows = 64;
  int galton_balls = 4;
  double pink_variance_counts2 = 0.0;
  double mains_amplitude_counts = 0.0;
  double mains_hz = 50.0;

  /// Variance of the white noise of a channel, scale included [counts^2 of a 10-bit converter].
  double VarianceCounts2(int channel) const;
  /// How many channels the covariance is of: the first of KnownChannels().
  std::size_t covariance_channels() const;
  /// Errors: SettingError for lists of a wrong length or a matrix that is no covariance.
  void Check() const;
  void Visit(controller::SettingsVisitor& visitor);
};

}  // namespace gauntlet::sim
