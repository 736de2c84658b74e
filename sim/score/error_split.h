#pragma once

#include <array>
#include <vector>

#include "sim/score/fourier.h"
#include "sim/score/score.h"

namespace gauntlet::sim {

/// Where the distance between hand and wearer comes from.
enum class ErrorCause { kDelay, kConstant, kGain, kLimit, kFrames, kNoise, kRest };
inline constexpr int kErrorCauseCount = 7;

/// The mean square error of one joint by ErrorCause [rad^2]. It sums to the whole.
struct ErrorSplit {
  std::array<double, kErrorCauseCount> mean_squares{};

  double& Of(ErrorCause cause) { return mean_squares[static_cast<std::size_t>(cause)]; }
  double Of(ErrorCause cause) const { return mean_squares[static_cast<std::size_t>(cause)]; }
};

/// Splits the error e = hand - reference of every joint by its cause. With the hand of a noise-free
/// glove h0, e is the sum of
///
///     delay     r(t - d) - r(t)                    d, a and b such that  h0(t) ~ a + b r(t - d)
///     constant  a + (b - 1) mean(r(t - d))
///     gain      (b - 1) (r(t - d) - mean(r(t - d)))
///     limit     what is left of h0 while a motor of the joint is at its limit, and 250 ms after
///     frames    what is left of h0 at other times, above jitter_above_hz
///     rest      what is left of h0 at other times, below it: friction, play, gravity
///     noise     h - h0
///
/// and the part of a cause is the mean of its signal times e. So the parts sum to mean(e^2), and
/// what two causes do together is shared evenly between them. A part is below 0 where a cause
/// takes more of the others' error away than it makes itself.
///
/// A motor is at its limit that gives all it has for a whole command frame on end, and for 20 ms at
/// least: the next command finds it still behind. Shorter is the kick with which it takes every
/// step of the staircase.
///
/// d, a and b are found by least squares over the ticks that are not `limit`, or over all where
/// these are less than half a second. d is the delay of DelaySamples(); without one (as for a hand
/// or a reference that moves by less than 0.1 deg RMS) d is 0. Without a reference that moves b is
/// 1.
///
/// Means are over the ticks that count, and only these are fitted.
///
/// None without the noise-free hand, its motors' limits and the motors of each joint.
/// Units: rad. Shapes: one split per joint of the input.
std::vector<ErrorSplit> SplitErrors(const ScoreInput& input, Fourier& fourier);

}  // namespace gauntlet::sim
