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
/// neighbours refines below a sample. Of several counted ranges each is compared with itself, and
/// their sums are added; the longest stands for the signal in what follows.
///
/// A motion that repeats after P (see RepeatPeriod()) looks the same after a delay of d and of
/// d + P. So the lags of one period are searched, from 10 ms before `earliest_s` on: no cause acts
/// sooner, and a maximum at an end is none. A motion that does not repeat is searched from 100 ms
/// before `earliest_s` to 1 s after it. The lag is at most a quarter of the signal.
///
/// None if the maximum means nothing: a signal that moves by less than 0.1 deg RMS (a constant
/// channel), a largest correlation below kLeastDelayCorrelation, a maximum at the first or last lag
/// or beside a lag whose overlap has less than a tenth of a signal's variance (a finger that an
/// object pushes against the wearer's motion), a flat maximum (r within 1e-4 of it over more than
/// 60 ms), and a second maximum within 0.02 of the largest.
///
/// Units: signals in rad, the delay in samples. Shapes: both signals of the same length.
/// Source: Knapp and Carter 1976 (delay by correlation); parabola: Jacovitti and Scarano 1993.
std::optional<double> DelaySamples(std::span<const double> leader, std::span<const double> follower,
                                   double rate_hz, double earliest_s, const CountedTicks& counted,
                                   Fourier& fourier);

/// The time after which a motion repeats: the lag of the first side peak of its autocorrelation
/// above one half, up to a quarter of the longest counted range. To 10 ms. None for a motion that
/// does not repeat.
std::optional<double> RepeatPeriod_s(std::span<const double> motion, double rate_hz,
                                     const CountedTicks& counted, Fourier& fourier);

/// Unrelated motions correlate at some lag, too: below this, the delayed leader explains less than
/// a quarter of the follower's motion. Assumption.
inline constexpr double kLeastDelayCorrelation = 0.5;

/// Below this RMS a signal counts as still. Assumption: a tenth of what a servo resolves.
inline constexpr double kStillRms_rad = 0.1 * kRadPerDeg;

/// Peak of the parabola through three equidistant values, relative to the middle one.
double ParabolaPeak(double left, double middle, double right);

/// RMS of follower[n + delay] - leader[n] where both lie in the same counted range, linear between
/// samples.
double AlignedRms(std::span<const double> leader, std::span<const double> follower,
                  double delay_samples, const CountedTicks& counted);

}  // namespace gauntlet::sim
