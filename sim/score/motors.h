#pragma once

#include <span>

#include "sim/score/counted_ticks.h"
#include "sim/score/fourier.h"

namespace gauntlet::sim {

/// Centre of the power spectrum of a motor's speed: how high the motor sounds [Hz].
///
///     centroid = sum f P(f) / sum P(f),   0 < f <= rate/2
///
/// P by Welch's method: pieces of about 1 s that overlap by half within what counts, Hann window,
/// mean removed. NaN for less than one piece or a constant speed. Source: Welch 1967; Peeters 2004
/// (spectral centroid).
double SpectralCentroid(std::span<const double> speed, double rate_hz, const CountedTicks& counted,
                        Fourier& fourier);

/// A cable that pulls with so much or less is slack. An assumption: the weight of 1 g.
inline constexpr double kSlackTension_n = 0.01;

/// Share of the samples that count in which a cable is slack.
double SlackShare(std::span<const double> tension_n, const CountedTicks& counted);

}  // namespace gauntlet::sim
