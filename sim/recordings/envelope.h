#pragma once

#include <deque>

namespace gauntlet::sim {

/// Envelope of a muscle's signal (EMG): its activity, rectified and smoothed, row by row and
/// without later values.
///
///     y[k] = a (y[k-1] + x[k] - x[k-1]),  a = 1 / (1 + 2 pi f dt),  f = 10 Hz
///     e[k] = mean of |y| over the rows of the last `window_ms`
///
/// The envelope lags the activity by half the window. Behind a gap longer than the window it begins
/// anew. Units: those of x. A missing value is NaN and changes nothing.
/// Source: Hudgins, Parker, Scott 1993, IEEE Trans. Biomed. Eng. 40(1), 82-94 (mean absolute value
/// of windows). The high pass is an assumption: it removes the offset of a converter.
class Envelope {
 public:
  explicit Envelope(double window_ms) : window_s_(1e-3 * window_ms) {}

  /// `time_s` rises.
  double Step(double time_s, double value);

 private:
  struct Rectified {
    double time_s = 0.0;
    double value = 0.0;
  };
  double window_s_;
  std::deque<Rectified> recent_;
  double before_s_ = 0.0;
  double before_ = 0.0;    // x
  double filtered_ = 0.0;  // y
};

inline constexpr double kShortestEnvelope_ms = 10.0;
inline constexpr double kLongestEnvelope_ms = 2000.0;
inline constexpr double kUsualEnvelope_ms = 150.0;

}  // namespace gauntlet::sim
