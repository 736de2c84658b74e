#include "sim/trial/filter_trial.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "controller/angle_estimator.h"
#include "controller/assert.h"
#include "controller/periodic_clock.h"
#include "controller/sample_guard.h"
#include "sim/base/stop.h"
#include "sim/trial/external/external_filters.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using CountRows = AngleRows;  // samples, or steps, x channels

/// Ticks that go through the trial together: a read or write per column and tick would touch a cache
/// line each, and in columns of a power of two they would get in each other's way.
constexpr Index kBlockTicks = 192;

/// Samples that begin before this tick.
Index SamplesBefore(Index ticks, Index ticks_per_sample) {
  return (ticks + ticks_per_sample - 1) / ticks_per_sample;
}

std::span<const double> RowsOf(const AngleRows& rows, Index first, Index count) {
  GAUNTLET_ASSERT(0 <= first && 0 <= count && first + count <= rows.rows());
  return {rows.data() + first * rows.cols(), static_cast<std::size_t>(count * rows.cols())};
}

/// The next ticks of a glove.
struct GloveBlock {
  GloveBlock(const GloveSignal& glove, Index tick)
      : first_tick(tick),
        ticks(std::min(kBlockTicks, glove.true_angle_rad.rows() - tick)),
        ticks_per_sample(glove.ticks_per_sample),
        first_sample(SamplesBefore(tick, ticks_per_sample)),
        counts(glove.counts.middleRows(
            first_sample, SamplesBefore(tick + ticks, ticks_per_sample) - first_sample)) {}

  /// True if the glove has a new sample at a tick of the block.
  bool HasSample(Index tick) const { return (first_tick + tick) % ticks_per_sample == 0; }
  std::span<const double> SampleAt(Index tick) const {
    GAUNTLET_ASSERT(HasSample(tick));
    return RowsOf(counts, (first_tick + tick) / ticks_per_sample - first_sample, 1);
  }

  Index first_tick;
  Index ticks;
  Index ticks_per_sample;
  Index first_sample;
  CountRows counts;  // of its samples
};

/// When filters step, and with which counts.
class FilterSteps {
 public:
  /// A channel that starts anew before a step of the block; `step` may be that after the last one.
  struct Start {
    Index step;
    int channel;
  };

  FilterSteps(const controller::RobotConfig& robot, std::span<const double> start_counts)
      : filter_at_(robot.controller.filter_at),
        guard_(robot.controller.untrusted, start_counts, controller::ConvertersOf(robot.glove),
               robot.timing.sample_rate_hz(), robot.glove.frame_number_bits),
        event_clock_(robot.timing.TicksOf(robot.timing.event_period_ms)),
        counts_(kBlockTicks, std::ssize(start_counts)),
        steps_until_(kBlockTicks) {}

  void ComputeSteps(const GloveBlock& block) {
    steps_ = 0;
    starts_.clear();
    for (Index tick = 0; tick < block.ticks; ++tick) {
      if (block.HasSample(tick)) {
        guard_.Step({.counts = block.SampleAt(tick)}, [this](int channel) {
          starts_.push_back({steps_, channel});
        });
        if (filter_at_ == controller::FilterAt::kSample) AddStep();
      }
      if (event_clock_.Tick() && filter_at_ == controller::FilterAt::kEvent) AddStep();
      steps_until_[static_cast<std::size_t>(tick)] = steps_;
    }
  }

  const controller::SampleGuard& guard() const { return guard_; }
  /// Steps of the block: steps x channels, their number, and their number when a tick ended.
  std::span<const double> Counts(Index first, Index count) const {
    return RowsOf(counts_, first, count);
  }
  Index count() const { return steps_; }
  Index CountUntil(Index tick) const {
    GAUNTLET_ASSERT(0 <= tick && tick < std::ssize(steps_until_));
    return steps_until_[static_cast<std::size_t>(tick)];
  }
  std::span<const Start> starts() const { return starts_; }

 private:
  void AddStep() {
    GAUNTLET_ASSERT(steps_ < counts_.rows());
    const std::span<const double> trusted = guard_.trusted_counts();
    std::copy(trusted.begin(), trusted.end(), &counts_(steps_++, 0));
  }

  controller::FilterAt filter_at_;
  controller::SampleGuard guard_;
  controller::PeriodicClock event_clock_;
  CountRows counts_;
  Index steps_ = 0;
  std::vector<Index> steps_until_;
  std::vector<Start> starts_;
};

/// The controller, from trusted counts to joints.
class FilterTrial {
 public:
  FilterTrial(const controller::RobotConfig& robot, const controller::JointMap& joint_map)
      : estimator_(robot, robot.controller),
        joint_angles_(joint_map),
        steps_(robot, StartCounts(robot, joint_map)),
        predicted_rad_(kBlockTicks + 1, estimator_.channel_count()),
        held_rad_(kBlockTicks, estimator_.channel_count()) {
    estimator_.Reset(guard().trusted_counts());
  }

  const controller::SampleGuard& guard() const { return steps_.guard(); }

  /// The joints' angles of the block. Good until the next one.
  Eigen::Map<const AngleRows> Run(const GloveBlock& block) {
    steps_.ComputeSteps(block);
    GAUNTLET_ASSERT(steps_.count() <= block.ticks && block.ticks <= kBlockTicks);
    // What held before, then what each step gives.
    std::ranges::copy(estimator_.predicted_rad(), predicted_rad_.data());
    Index done = 0;
    const auto step_until = [&](Index end) {
      if (end == done) return;
      const std::span<const double> predicted = RowsOf(predicted_rad_, done + 1, end - done);
      estimator_.Step(
          steps_.Counts(done, end - done),
          {predicted_rad_.data() + (done + 1) * predicted_rad_.cols(), predicted.size()});
      done = end;
    };
    for (const auto& [step, channel] : steps_.starts()) {
      step_until(step);
      estimator_.StartChannel(channel);
    }
    step_until(steps_.count());
    if (steps_.count() == block.ticks) {
      return joint_angles_.Of(RowsOf(predicted_rad_, 1, block.ticks));
    }
    for (Index tick = 0; tick < block.ticks; ++tick) {
      held_rad_.row(tick) = predicted_rad_.row(steps_.CountUntil(tick));
    }
    return joint_angles_.Of(RowsOf(held_rad_, 0, block.ticks));
  }

 private:
  /// Counts that the guard holds before the first good value, as in a new Controller.
  std::vector<double> StartCounts(const controller::RobotConfig& robot,
                                  const controller::JointMap& joint_map) {
    std::vector<double> counts(static_cast<std::size_t>(estimator_.channel_count()));
    estimator_.MoveTo(joint_map, robot.hand.reference_angle_rad);
    estimator_.ToCounts(counts);
    return counts;
  }

  controller::AngleEstimator estimator_;
  JointAngleRows joint_angles_;
  FilterSteps steps_;
  AngleRows predicted_rad_;  // channels: what held before the block, then of its steps
  AngleRows held_rad_;       // channels at its ticks, where there is not a step at each
};

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
  Signal angle_rad(glove.true_angle_rad.rows(),
                   static_cast<Index>(setup.hand->joint_names().size()));
  for (Index tick = 0; tick < angle_rad.rows(); tick += kBlockTicks) {
    ThrowIfStopped();
    const GloveBlock block(glove, tick);
    // As 0 + 1 channel: no -0.
    angle_rad.middleRows(tick, block.ticks) =
        (0.0 + trial.Run(block).array()).cast<Stored<double>>().cast<double>();
    if (tick % kTrimRows == 0) TrimSignals();
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
