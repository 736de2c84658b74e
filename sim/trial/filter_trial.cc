#include "sim/trial/filter_trial.h"

#include <algorithm>
#include <utility>

#include "controller/angle_estimator.h"
#include "controller/assert.h"
#include "controller/periodic_clock.h"
#include "controller/sample_guard.h"
#include "sim/base/stop.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

using Eigen::Index;
using CountRows = AngleRows;  // samples, or steps, x channels

/// Ticks that go through one trial after the other: a read or write per column and tick would touch
/// a cache line each, and in columns of a power of two they would get in each other's way.
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

/// When filters step, and with which counts: the same for all trials whose guards are alike.
class FilterSteps {
 public:
  /// A channel that starts anew before a step of the block; `step` may be that after the last one.
  struct Start {
    Index step;
    int channel;
  };

  FilterSteps(const controller::RobotConfig& robot, std::vector<double> start_counts)
      : config_(robot.controller.untrusted),
        filter_at_(robot.controller.filter_at),
        start_counts_(std::move(start_counts)),
        guard_(config_, start_counts_, controller::ConvertersOf(robot.glove),
               robot.timing.sample_rate_hz(), robot.glove.frame_number_bits),
        event_clock_(robot.timing.TicksOf(robot.timing.event_period_ms)),
        counts_(kBlockTicks, std::ssize(start_counts_)),
        steps_until_(kBlockTicks) {}

  bool AreOf(const controller::ControllerConfig& config,
             const std::vector<double>& start_counts) const {
    return config.untrusted == config_ && config.filter_at == filter_at_ &&
           start_counts == start_counts_;
  }

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

  controller::SampleGuardConfig config_;
  controller::FilterAt filter_at_;
  std::vector<double> start_counts_;
  controller::SampleGuard guard_;
  controller::PeriodicClock event_clock_;
  CountRows counts_;
  Index steps_ = 0;
  std::vector<Index> steps_until_;
  std::vector<Start> starts_;
};

/// Channels' angles of a block, in memory that all trials of a glove use: it stays in the cache.
struct BlockAngles {
  explicit BlockAngles(Index channels)
      : predicted_rad(kBlockTicks + 1, channels), held_rad(kBlockTicks, channels) {}

  AngleRows predicted_rad;  // what held before the block, then of its steps
  AngleRows held_rad;       // of its ticks, where there is not a step at each
};

/// One controller, from trusted counts to joints.
class FilterTrial {
 public:
  FilterTrial(const controller::RobotConfig& robot, const controller::JointMap& joint_map)
      : estimator_(robot, robot.controller),
        joint_angles_(joint_map),
        start_counts_(static_cast<std::size_t>(estimator_.channel_count())) {
    estimator_.MoveTo(joint_map, robot.hand.reference_angle_rad);  // as a new Controller
    estimator_.ToCounts(start_counts_);
  }

  /// Counts that its guard holds before the first good value.
  const std::vector<double>& start_counts() const { return start_counts_; }
  void UseSteps(const std::vector<FilterSteps>& all, std::size_t number) {
    steps_ = number;
    estimator_.Reset(all[number].guard().trusted_counts());
  }
  std::size_t steps() const { return steps_; }

  /// The joints' angles of the block. Good until `angles` are used again.
  Eigen::Map<const AngleRows> Run(const FilterSteps& steps, Index ticks, BlockAngles& angles) {
    GAUNTLET_ASSERT(steps.count() <= ticks && ticks <= kBlockTicks);
    // What held before, then what each step gives.
    std::ranges::copy(estimator_.predicted_rad(), angles.predicted_rad.data());
    Index done = 0;
    const auto step_until = [&](Index end) {
      if (end == done) return;
      const std::span<const double> predicted = RowsOf(angles.predicted_rad, done + 1, end - done);
      estimator_.Step(steps.Counts(done, end - done),
                      {angles.predicted_rad.data() + (done + 1) * angles.predicted_rad.cols(),
                       predicted.size()});
      done = end;
    };
    for (const auto& [step, channel] : steps.starts()) {
      step_until(step);
      estimator_.StartChannel(channel);
    }
    step_until(steps.count());
    if (steps.count() == ticks) return joint_angles_.Of(RowsOf(angles.predicted_rad, 1, ticks));
    for (Index tick = 0; tick < ticks; ++tick) {
      angles.held_rad.row(tick) = angles.predicted_rad.row(steps.CountUntil(tick));
    }
    return joint_angles_.Of(RowsOf(angles.held_rad, 0, ticks));
  }

 private:
  controller::AngleEstimator estimator_;
  JointAngleRows joint_angles_;
  std::vector<double> start_counts_;
  std::size_t steps_ = 0;  // its place among those of all trials
};

controller::RobotConfig RobotOf(const TrialSetup& setup, const TrialPrograms& programs) {
  return {.controller = programs.config(),
          .glove = setup.calibration,
          .hand = setup.hand->transmission(),
          .joint_map = setup.joint_map,
          .timing = setup.hand->timing().controller};
}

}  // namespace

Trace RunFilterTrial(const TrialSetup& setup, const GloveSignal& glove) {
  Signal angle_rad(glove.true_angle_rad.rows(),
                   static_cast<Index>(setup.hand->joint_names().size()));
  Index tick = 0;
  std::vector<Trace> traces =
      RunFilterTrials({&setup, 1}, glove, [&](std::size_t, const auto& block) {
        // As 0 + 1 channel: no -0.
        angle_rad.middleRows(tick, block.rows()) =
            (0.0 + block.array()).template cast<Stored<double>>().template cast<double>();
        if (tick % kTrimRows == 0) TrimSignals();
        tick += block.rows();
      });
  traces[0].hand_angle_rad = std::move(angle_rad);
  return std::move(traces[0]);
}

std::vector<Trace> RunFilterTrials(std::span<const TrialSetup> setups, const GloveSignal& glove,
                                   const SeeAngles& see) {
  GAUNTLET_ASSERT(glove.counts.cols() == std::ssize(glove.channel_names));
  std::vector<FilterSteps> steps;
  std::vector<TrialPrograms> programs;
  std::vector<FilterTrial> trials;
  for (const TrialSetup& setup : setups) {
    programs.emplace_back(setup.controller);
    const controller::RobotConfig robot = RobotOf(setup, programs.back());
    FilterTrial& trial = trials.emplace_back(
        robot, controller::JointMap(setup.joint_map, glove.channel_names, robot.hand));
    const auto known = std::ranges::find_if(steps, [&](const FilterSteps& those) {
      return those.AreOf(robot.controller, trial.start_counts());
    });
    const auto place = static_cast<std::size_t>(known - steps.begin());
    if (known == steps.end()) steps.emplace_back(robot, trial.start_counts());
    trial.UseSteps(steps, place);
  }
  BlockAngles angles(std::ssize(glove.channel_names));
  for (Index tick = 0; tick < glove.true_angle_rad.rows(); tick += kBlockTicks) {
    ThrowIfStopped();
    const GloveBlock block(glove, tick);
    for (FilterSteps& those : steps) those.ComputeSteps(block);
    for (std::size_t i = 0; i < trials.size(); ++i) {
      see(i, trials[i].Run(steps[trials[i].steps()], block.ticks, angles));
    }
  }
  ThrowIfStopped();  // which also ends a program's wait
  std::vector<Trace> traces(setups.size());
  for (std::size_t i = 0; i < setups.size(); ++i) {
    traces[i].controller_name = setups[i].controller_name;
    const auto untrusted = steps[trials[i].steps()].guard().untrusted_samples();
    traces[i].untrusted_samples.assign(untrusted.begin(), untrusted.end());
    programs[i].ThrowMistake(setups[i].controller_name);
    if (!programs[i].ok()) traces[i].health = {.ok = false, .problem = programs[i].problem()};
  }
  return traces;
}

}  // namespace gauntlet::sim
