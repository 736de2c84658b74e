#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/fit/chain_fit.h"
#include "sim/fit/episode_rows.h"
#include "sim/fit/follow_fit.h"
#include "sim/results/table_text.h"

namespace gauntlet::sim {

/// Something that is wrong with a part of a data set, or with all of it.
struct AuditFault {
  std::string key;        // for programs
  std::string text;       // a sentence without its subject: "is 17.0 deg off in 4 of 50 episodes"
  double severity = 0.0;  // the largest comes first; below 1: it may have its reasons
};

/// A part (joint or motor) in an episode, in its stretch with the largest residual. NaN: not
/// determined.
struct AuditedEpisode {
  double delay_ms = kNaN;
  double offset = kNaN;    // median of the angle less the delayed command
  double residual = kNaN;  // RMS of the same
  double from_s = kNaN;    // the stretch in the episode; NaN if it is of several
  double to_s = kNaN;
};

/// Findings about a part, in its own unit.
struct AuditedPart {
  std::string name;
  std::string unit;  // deg, units, or the unit of a length in its name
  /// Kind of its commands: a NameOf(CommandKind), or `mixed` (copies in some rows or episodes),
  /// `ahead`, `opposite`, `other_part`, `unrelated`, `still`, `command_still`, `angle_still`,
  /// `missing`.
  std::string kind;
  std::string kind_text;       // "targets", or a sentence without its subject on what they are
  ChainEstimate delay_ms;      // of a target
  double delay_low_ms = kNaN;  // of the stretches, the 5th percentile
  double delay_high_ms = kNaN;
  bool delay_stays = true;
  ChainEstimate gain;
  double offset = kNaN;          // median over stretches of the angle less the delayed command
  double offset_limit = kNaN;    // above which an offset counts
  double delay_limit_ms = kNaN;  // by which delays must differ to count
  double rest_error = kNaN;      // RMS at rest, about the offset
  double residual = kNaN;        // RMS with delay, gain and offset
  double travel = 0.0;           // of the command
  std::vector<AuditFault> faults;
  std::vector<AuditedEpisode> episodes;  // as Audit::episodes
  FollowRows worst;                      // the stretch with the largest residual
  double worst_episode = kNaN;
  double worst_rate_hz = 0.0;

  bool is_target() const { return kind == "target"; }
};

/// Result of gauntlet audit.
struct Audit {
  std::string name;  // of the file
  std::vector<AuditedPart> parts;
  std::vector<double> episodes;  // their numbers
  std::string unit;              // of most parts: deg or units
  std::string unit_note;
  double duration_s = 0.0;
  double rate_hz = 0.0;
  std::vector<AuditFault> faults;    // of the whole data set: clock, state older than its row
  std::vector<std::string> ignored;  // columns
};

/// The share of a part's motion above which an offset counts. A policy that learns from the angles
/// and acts by commands is wrong by as much; it is about what a hand's grip or a reach tolerates.
/// Assumption.
inline constexpr double kOffsetOfTravel = 0.05;

/// Hears the share of the file that was read; never, for a text, whose length is not known.
using AuditProgress = std::function<void(double share)>;

/// Finds for each part of a log of commands and angles what its commands are, the delay and the
/// offset of the angle, and whether that stays over the episodes. Reads the file once, an episode
/// at a time: memory grows with the number of episodes, not with their length.
///
/// An episode above 20 s is cut into stretches of 10 s, episodes below 5 s are used together. Each
/// stretch has a FollowFit, the values of a part are means over its stretches (see CommonOf()).
/// Errors: UserError as of EpisodeReader; for a log without motion.
Audit AuditLog(const std::filesystem::path& file, const ChainLogOptions& options,
               const AuditProgress& progress = {});

/// "50 episodes, 612.3 s at 30 Hz"
std::string ExtentText(const Audit& audit);

/// Usable for training or not, what to mend first, and the threshold's reason. `recommended`: fit,
/// fix or unusable. `others`: where the faults are that the first sentence does not name.
Verdict VerdictOf(const Audit& audit, const std::string& others = "--verbose");

/// The table with all parts, all faults, and ignored columns.
ResultText AuditFindings(const Audit& audit);
/// Verdict and table in at most 25 lines; parts without a fault may be left out of the table.
/// `verbose`: AuditFindings() behind the verdict.
ResultText AuditText(const Audit& audit, bool verbose);

std::string AuditJson(const Audit& audit);

}  // namespace gauntlet::sim
