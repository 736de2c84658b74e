#pragma once

#include <span>

#include "sim/score/wearer.h"

namespace gauntlet::sim {

/// How far the hand goes beyond the end of the wearer's movements, the mean over movements [rad].
///
///     overshoot = max(0, max over t of direction (hand(t) - offset - to))
///     offset = mean(hand - wearer) over all that counts
///
/// The window lasts from the begin of the movement to the end of the next if that goes back, to the
/// begin of the next if that goes on; at most 1 s beyond the movement's end; plus the delay.
/// Movements at whose end the signal ends, too, do not count. A gain above 1 counts as overshoot,
/// too. NaN without movements.
double Overshoot(std::span<const double> wearer_rad, std::span<const double> hand_rad,
                 double rate_hz, std::span<const Movement> movements, double delay_samples,
                 const CountedTicks& counted);

/// How much later than the wearer the hand leaves its rest, the mean over onsets [samples].
///
/// The onset of an angle is counted as the time that it spends below 10 % of the movement's
/// amplitude from the begin of the wearer's movement until it reaches 50 %: noise neither triggers
/// it nor moves it to one side. Both
/// start from their mean between 0.3 and 0.2 s before that begin. The hand has 1 s
/// after the wearer's end to reach 50 %; else the movement does not count. NaN without any.
double OnsetDelay(std::span<const double> wearer_rad, std::span<const double> hand_rad,
                  double rate_hz, std::span<const Movement> movements);

}  // namespace gauntlet::sim
