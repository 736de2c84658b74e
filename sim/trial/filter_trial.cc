#include "sim/trial/filter_trial.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "controller/angle_estimator.h"
#include "controller/assert.h"
#include "controller/periodic_clock.h"
#include "controller/sample_guard.h"
#include "sim/base/stop.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows that are copied together between signals and memory of a row after the other: a read or
/// write per column and tick would touch a cache line each.
constexpr Index kBlockTicks = 192;

/// From samples to what the controller asks the joints for.
class FilterTrial {
 public:
  FilterTrial(const controller::RobotConfig& robot, const controller::JointMap& joint_map)
      : estimator_(robot, robot.controller),
        joint_map_(joint_map),
        filter_at_(robot.controller.filter_at),
        guard_(robot.controller.untrusted, StartCounts(robot),
               controller::ConvertersOf(robot.glove), robot.timing.sample_rate_hz(),
               robot.glove.frame_number_bits),
        event_clock_(robot.timing.TicksOf(robot.timing.event_period_ms)),
        predicted_rad_(static_cast<std::size_t>(estimator_.channel_count())) {
    estimator_.Reset(guard_.trusted_counts());
  }

  const controller::SampleGuard& guard() const { return guard_; }

  void TakeSample(std::span<const double> counts) {
    guard_.Step({.counts = counts}, [this](int channel) { estimator_.StartChannel(channel); });
    if (filter_at_ == controller::FilterAt::kSample) StepFilters();
  }
  void Tick(std::span<double> joint_angle_rad) {
    if (event_clock_.Tick() && filter_at_ == controller::FilterAt::kEvent) StepFilters();
    joint_map_.ToJoints(estimator_.predicted_rad(), joint_angle_rad);
  }

 private:
  /// Counts that the guard holds before the first good value, as in a new Controller.
  std::vector<double> StartCounts(const controller::RobotConfig& robot) {
    std::vector<double> counts(static_cast<std::size_t>(estimator_.channel_count()));
    estimator_.MoveTo(joint_map_, robot.hand.reference_angle_rad);
    estimator_.ToCounts(counts);
    return counts;
  }
  void StepFilters() { estimator_.Step(guard_.trusted_counts(), predicted_rad_); }

  controller::AngleEstimator estimator_;
  controller::JointMap joint_map_;
  controller::FilterAt filter_at_;
  controller::SampleGuard guard_;
  controller::PeriodicClock event_clock_;
  std::vector<double> predicted_rad_;
};

std::span<double> RowOf(Rows& rows, Index row) {
  return {rows.data() + row * rows.cols(), static_cast<std::size_t>(rows.cols())};
}

}  // namespace

Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove) {
  GAUNTLET_ASSERT(glove.counts.cols() == std::ssize(glove.channel_names));
  const TrialPrograms programs(setup.controller);
  const controller::RobotConfig robot = {.controller = programs.config(),
                                         .glove = setup.calibration,
                                         .hand = setup.hand->transmission(),
                                         .joint_map = setup.joint_map,
                                         .timing = setup.hand->timing().controller};
  FilterTrial trial(robot, controller::JointMap(setup.joint_map, glove.channel_names, robot.hand));
  const Index ticks = glove.true_angle_rad.rows();
  const Index per_sample = glove.ticks_per_sample;
  Signal angle_rad(ticks, static_cast<Index>(setup.hand->joint_names().size()));
  Rows joints(kBlockTicks, angle_rad.cols());
  for (Index first = 0; first < ticks; first += kBlockTicks) {
    ThrowIfStopped();
    const Index end = std::min(first + kBlockTicks, ticks);
    const Index first_sample = (first + per_sample - 1) / per_sample;
    Rows counts =
        glove.counts.middleRows(first_sample, (end + per_sample - 1) / per_sample - first_sample);
    for (Index tick = first; tick < end; ++tick) {
      if (tick % per_sample == 0) trial.TakeSample(RowOf(counts, tick / per_sample - first_sample));
      trial.Tick(RowOf(joints, tick - first));
    }
    // As 0 + 1 channel: no -0.
    angle_rad.middleRows(first, end - first) =
        (0.0 + joints.topRows(end - first).array()).cast<Stored<double>>().cast<double>();
    if (first % kTrimRows == 0) TrimSignals();
  }
  ThrowIfStopped();  // which also ends a program's wait
  Trace trace;
  trace.controller_name = setup.controller_name;
  const auto untrusted = trial.guard().untrusted_samples();
  trace.untrusted_samples.assign(untrusted.begin(), untrusted.end());
  programs.ThrowMistake(setup.controller_name);
  if (!programs.ok()) trace.health = {.ok = false, .problem = programs.problem()};
  trace.hand_angle_rad = std::move(angle_rad);
  return trace;
}

}  // namespace gauntlet::sim
