#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/fit/audit.h"
#include "sim/fit/command_kind.h"
#include "sim/fit/follow_fit.h"

namespace gauntlet::sim {

/// "3, 7, 9, 12" or "3, 7, 9, 10, .."
std::string NumbersText(const std::set<double>& numbers);

/// Rows of a part in an episode, at an even rate. A gap in time begins another of `stretches`.
struct PartInRows {
  double episode = 0.0;
  double rate_hz = 0.0;
  double first_s = 0.0;
  std::vector<FollowRows> stretches;
  /// As they are in the file, if command and angle have the same rows: no copy shows in values
  /// between them. Else empty.
  FollowRows raw;
};

/// Gathers what an audit needs of one part, episode by episode.
class PartAudit {
 public:
  explicit PartAudit(std::string name) : name_(std::move(name)) {}

  void Add(const PartInRows& rows);
  /// `unit`: of the values.
  AuditedPart Finish(const std::vector<double>& episodes, const std::string& unit);

 private:
  struct Stretch {
    std::vector<double> episodes;  // numbers
    double first_s = 0.0;          // in its episode
    double length_s = 0.0;
    double rate_hz = 0.0;
    double travel = 0.0;  // of the command
    double angle_travel = 0.0;
    double later_travel = 0.0;  // of the angle, but for the beginning
    FollowFit fit = {};
    double place = 0.0;         // mean of the command
    double offset = 0.0;        // median of the angle less the delayed command
    double least_error = 0.0;   // 5 % of the same are smaller in size
    double residual = 0.0;      // RMS of the angle less the delayed command
    double rest_squares = 0.0;  // of the same less its mean, at rest
    double rest_rows = 0.0;
  };
  struct Judged {
    CommandKind kind = CommandKind::kTarget;
    double episode = 0.0;
    double travel = 0.0;
    CopiedRows copied = {};
    double first_s = 0.0;  // of the piece, in its episode
    double row_s = 0.0;
    std::size_t rows = 0;
  };
  struct Freeze {
    double episode = 0.0;
    double length_s = 0.0;
    double command_travel = 0.0;
  };

  void Fit(const std::vector<FollowRows>& rows, const std::vector<double>& episodes, double rate_hz,
           double first_s, double length_s);
  void FindFreezes(const FollowRows& rows, double episode, double rate_hz, const FollowFit& fit);
  void AddSamples(const FollowRows& rows, const FollowFit& fit);
  void JudgeKind(const PartInRows& rows);
  bool Moves(const Stretch& stretch) const;
  void FinishPending();
  std::string MixedRows(std::size_t episodes, double least_share) const;
  bool NameKind(const std::vector<double>& episodes, AuditedPart& part) const;
  void FindOddStretches(std::size_t episodes, AuditedPart& part) const;
  bool MayTouch(const std::set<double>& episodes) const;
  void FinishDelay(const std::vector<const Stretch*>& moving, AuditedPart& part) const;
  void FinishOffset(const std::vector<const Stretch*>& moving, const std::string& unit,
                    std::size_t episodes, AuditedPart& part) const;
  void FinishEnds(const std::string& unit, AuditedPart& part) const;

  std::string name_;
  std::vector<Stretch> stretches_;
  std::optional<CommonCorrelation> correlation_;
  std::vector<Judged> judged_;
  std::vector<Freeze> freezes_;
  std::set<double> empty_;           // episodes without values
  std::vector<FollowRows> pending_;  // of short episodes, until they are long enough together
  std::vector<double> pending_episodes_;
  double pending_s_ = 0.0;
  double pending_rate_hz_ = 0.0;
  double longest_travel_ = 0.0;
  /// Pairs of delayed command and angle over the whole data set, every n-th.
  std::vector<std::pair<double, double>> samples_;
  std::size_t sample_step_ = 1;
  std::size_t sample_next_ = 0;
  FollowRows worst_;
  double worst_residual_ = -1.0;
  double worst_episode_ = kNaN;
  double worst_rate_hz_ = 0.0;
};

}  // namespace gauntlet::sim
