#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "sim/score/counted_ticks.h"

namespace gauntlet::sim {

/// Causes that put the hand beside the wearer, in the order in which trials take one after the
/// other away: each of these trials is without all causes before, and without this.
enum class ErrorCause {
  kNoise,       // noise and faults of the glove
  kGlove,       // what its sensors get wrong of an angle
  kLinkLoss,    // frames that a link loses
  kLinkJitter,  // delays of a link that differ from their mean
  kLink,        // command frames, and the mean delay of their way
  kSaturation,  // motors that have no more torque or speed
  kFriction,    // of motors and cables, and backlash
  kServo,       // its lag, its steps and its dead band
  kRest,        // of the hand: masses, cables that stretch, couplings; then there is no hand
  kController,  // what filter and prediction ask for beside the wearer
};
inline constexpr std::size_t kErrorCauseCount = 10;
/// One for each cause but the last: for that there is nothing to take away.
inline constexpr std::size_t kCauseTrialCount = kErrorCauseCount - 1;

/// Causes that a trial can switch off alone, with all others as they are. A link is one cause.
inline constexpr std::array kSwitchedCauses = {ErrorCause::kNoise,    ErrorCause::kGlove,
                                               ErrorCause::kLink,     ErrorCause::kSaturation,
                                               ErrorCause::kFriction, ErrorCause::kServo};
inline constexpr std::size_t kSwitchedCauseCount = kSwitchedCauses.size();

/// The mean square error of one joint by ErrorCause [rad^2]:
///
///     part_i = mean((h_(i-1) - h_i) e),   e = h_0 - r
///
/// h_0 is the hand, h_i the hand without the causes up to number i; the last of all is r. So the
/// parts sum to mean(e^2), and what two causes do together is shared evenly between them. A part is
/// below 0 where a cause takes more of the others' error away than it makes itself, as a prediction
/// does with all that makes the hand late.
using ErrorByCauses = std::array<double, kErrorCauseCount>;

/// `without`: h_1 .. of the same joint, empty for a cause that cannot be taken away here: its part
/// is NaN, and what it does is in the next. Means are over the ticks that count. None without the
/// trial of kRest.
std::optional<ErrorByCauses> PartsOfError(
    std::span<const double> reference, std::span<const double> hand,
    const std::array<std::span<const double>, kCauseTrialCount>& without,
    const CountedTicks& counted);

}  // namespace gauntlet::sim
