#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/fit/chain_episodes.h"
#include "sim/results/verdict.h"

namespace gauntlet::sim {

/// A stretch of an episode for curves. Rows at a constant rate; angles as in the log.
struct ValidatedCurve {
  double rate_hz = 0.0;
  std::vector<double> command_deg;
  std::vector<double> measured_deg;
  std::vector<double> simulated_deg;
};

/// A part of a log beside the simulated servo, over the held-out episodes.
struct ValidatedPart {
  std::string part;
  std::string problem;  // why it could not be simulated; empty if it was
  std::size_t episodes = 0;
  double measured_delay_ms = kNaN;  // means over the episodes
  double simulated_delay_ms = kNaN;
  ChainEstimate delay_difference_ms;  // simulated less measured
  double rms_deg = kNaN;              // measured less simulated
  double motion_rms_deg = kNaN;       // of the measured angle around its mean
  double shifted_rms_deg = kNaN;  // of the command, by gain, offset and the measured delay alone
  double repeat_rms_deg = kNaN;   // between episodes that repeat each other: see HeldOutPart
  /// Shares of the squared error while the command rests, is slow and is fast: below 5 deg/s, up to
  /// half of its largest usual speed (95 % quantile), and above.
  std::array<double, 3> speed_share{};
  ValidatedCurve shown;  // the held-out episode in which it moves most

  double share_of_motion() const { return rms_deg / motion_rms_deg; }
};

struct Validation {
  ChainResult identified;
  std::string hand;  // its file; empty: each part on a joint of its own
  std::vector<ValidatedPart> parts;
};

/// Runs the simulated hand with the commands of a log, and compares its angles with the measured
/// ones. The chain is identified first (see IdentifyChain()); a log of one episode is cut into four
/// for this. Gain and offset are taken from the chain, since they are a controller's calibration.
/// The servo (see TryServos() and SearchServo()) is that of up to three fitted episodes with the
/// most motion; the angles that are compared are of up to six episodes that no fit contains, behind
/// their first 0.5 s.
///
/// Without `hand` each part turns a joint of its own directly (models/one_joint.xml), with its own
/// servo. With a hand, its joints with the names of parts answer together, by one servo.
/// Errors: UserError for a log whose unit is unknown, is too short, or has no part that can be
/// fitted; for a hand without joints of these names.
Validation Validate(ChainEpisodes episodes, const std::filesystem::path& hand,
                    const ChainProgress& progress = {});

Verdict VerdictOf(const Validation& validation);
/// A row per part.
ResultTable ValidationTable(const Validation& validation);
ResultText ValidationText(const Validation& validation);
std::string ValidationJson(const Validation& validation);

}  // namespace gauntlet::sim
