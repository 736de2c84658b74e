#pragma once

#include <optional>
#include <span>

#include "sim/base/signal.h"
#include "sim/score/counted_ticks.h"
#include "sim/score/fourier.h"

namespace gauntlet::sim {

/// By how many samples `follower` is late behind `leader`; negative when it is ahead.
///
///     delay = argmax over lag of  r(lag) = correlation of leader[n] with follower[n + lag]
///
/// r is Pearson's coefficient over the samples that overlap at that lag, so that a slow motion in a
/// short signal gives its true delay: the plain sum over a shrinking overlap is biased towards zero
/// by 1/(duration omega^2), 63 ms for 0.2 Hz in 10 s. A parabola through the largest r and its
/// neighbours refines below a sample. The lag is bounded by half the dominant period of the leader
/// (a periodic motion has a second, equal peak beyond), by a quarter of the signal and by 2 s.
/// Of several counted ranges each is compared with itself, and their sums are added; the longest
/// stands for the signal then.
///
/// None where there is nothing to find: a signal that moves by less than 0.1 deg RMS (a constant
/// channel), a largest correlation below kLeastDelayCorrelation, or no peak inside the bound and
/// inside the lags whose overlap holds a tenth of each signal's variance. So it is for a finger
/// that an object pushes against the wearer's motion.
///
/// Units: signals in rad, the delay in samples. Shapes: both signals of the same length.
/// Source: Knapp and Carter 1976 (delay by correlation); parabola: Jacovitti and Scarano 1993.
std::optional<double> DelaySamples(std::span<const double> leader, std::span<const double> follower,
                                   double rate_hz, Fourier& fourier);
std::optional<double> DelaySamples(std::span<const double> leader, std::span<const double> follower,
                                   double rate_hz, const CountedTicks& counted, Fourier& fourier);

/// Unrelated motions correlate at some lag, too: below this, the delayed leader explains less than
/// a quarter of the follower's motion. Assumption.
inline constexpr double kLeastDelayCorrelation = 0.5;

/// Below this RMS a signal counts as still. Assumption: a tenth of what a servo resolves.
inline constexpr double kStillRms_rad = 0.1 * kRadPerDeg;

/// Period of the strongest frequency of a signal without its mean, in samples.
double DominantPeriod(std::span<const double> signal, Fourier& fourier);

/// Where the parabola through three equidistant values has its peak, relative to the middle one.
double ParabolaPeak(double left, double middle, double right);

/// RMS of follower[n + delay] - leader[n] where both lie in the same counted range, linear between
/// samples.
double AlignedRms(std::span<const double> leader, std::span<const double> follower,
                  double delay_samples, const CountedTicks& counted);

}  // namespace gauntlet::sim
