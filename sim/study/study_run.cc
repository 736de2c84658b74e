#include "sim/study/study_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <mutex>

#include "sim/base/error.h"
#include "sim/base/threads.h"
#include "sim/score/scores_in_passing.h"
#include "sim/study/study_room.h"
#include "sim/study/trial_score.h"
#include "sim/trial/filter_trial.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {
namespace {

std::size_t JobsOf(const StudyOptions& options) {
  return static_cast<std::size_t>(std::max(1, options.jobs));
}

/// Whether all scores are found while trials run.
bool IsInPassing(const StudyOptions& options) {
  return !options.physics && !options.keep_first_traces && AreInPassing(options.scores);
}

/// The glove signal of one seed, made by the first trial that needs it, freed after the last.
struct SharedGlove {
  std::once_flag once;
  std::shared_ptr<const GloveSignal> signal;
  std::shared_ptr<const GloveSignal> noise_free;  // for twins that are trials; else null
  Signal reference_rad;                           // ticks x joints of the hand
  std::atomic<int> users_left{0};
  std::atomic<int> twins_left{0};
};

std::shared_ptr<const GloveSignal> NoiseFreeGlove(const Study& study, int seed) {
  return std::make_shared<const GloveSignal>(SynthesiseGlove(
      WithoutNoise(GloveOf(study.scenario, seed)), static_cast<std::uint64_t>(seed)));
}

/// None of a trial that ended early. Moves the signals of a trace that is not needed any more.
template <class AnyTrace>
std::optional<NoiseFreeTwin> AsTwin(AnyTrace&& trace) {
  if (!trace.health.ok) return std::nullopt;
  return NoiseFreeTwin{.hand_angle_rad = std::forward<AnyTrace>(trace).hand_angle_rad,
                       .spool_speed_rad_s = std::forward<AnyTrace>(trace).spool_speed_rad_s,
                       .motor_at_limit = std::forward<AnyTrace>(trace).motor_at_limit};
}

/// Which of the seeds differ, in what the wearer does and in anything at all.
class Repeats {
 public:
  /// `seeds`: how many are asked for. Costs one more signal per repetition that comes twice.
  Repeats(const Study& study, int seeds)
      : study_(study), count_(static_cast<int>(study.repetitions.size())) {
    alike_ = seeds > count_;
    for (int i = 0; i < count_ && i + count_ < seeds; ++i) {
      const GloveFacts& first = study.repetitions[i];
      const GloveFacts next = FactsOf(*GloveOfSeed(study, study.scenario.seed + count_ + i));
      alike_ = alike_ && next.signal_hash == first.signal_hash;
      drawn_.push_back(next.motion_hash != first.motion_hash);
    }
    drawn_.resize(count_, false);  // a repetition that comes once
  }

  /// Whether every repetition is the same again.
  bool alike() const { return alike_; }
  /// A name for the motion of the i-th seed.
  std::string MotionOf(int i) const {
    const int repetition = i % count_;
    if (drawn_[repetition] && i >= count_) return fmt::format("of seed number {}", i);
    return study_.repetitions[repetition].motion_hash;
  }

 private:
  const Study& study_;
  int count_;
  bool alike_ = false;
  std::vector<bool> drawn_;  // per repetition: another motion for every seed
};

/// Numbers the motions of the seeds in the order in which they come.
void NumberMotions(const Repeats& repeats, StudyResult& result) {
  std::vector<std::string> motions;
  for (std::size_t i = 0; i < result.seeds.size(); ++i) {
    const std::string motion = repeats.MotionOf(static_cast<int>(i));
    const auto known = std::ranges::find(motions, motion);
    result.seeds[i].motion = static_cast<int>(known - motions.begin());
    if (known == motions.end()) motions.push_back(motion);
  }
}

void FindDurations(const Study& study, StudyResult& result) {
  const std::size_t used = std::min(study.repetitions.size(), result.seeds.size());
  const auto [shortest, longest] = std::ranges::minmax_element(
      study.repetitions.begin(), study.repetitions.begin() + static_cast<std::ptrdiff_t>(used), {},
      &GloveFacts::ticks);
  const double rate_hz = study.hand->timing().tick_rate_hz();
  result.shortest_s = static_cast<double>(shortest->ticks) / rate_hz;
  result.longest_s = static_cast<double>(longest->ticks) / rate_hz;
}

/// The trials of a study as tasks that threads take in the order of seeds: one trial, or some
/// controllers of a seed where they run together.
class Schedule {
 public:
  Schedule(const Study& study, const StudyOptions& options)
      : study_(study),
        options_(options),
        gloves_(static_cast<std::size_t>(options.seeds)),
        controllers_(study.scenario.controllers.size()),
        in_passing_(IsInPassing(options)),
        together_(ControllersTogether(options, controllers_)),
        tasks_of_seed_((controllers_ + together_ - 1) / together_),
        threads_(std::min(JobsOf(options), tasks_of_seed_ * gloves_.size())) {
    result_.row_names = study.rows.names;
    for (const NamedController& c : study.scenario.controllers) {
      result_.controller_names.push_back(c.name);
    }
    for (int i = 0; i < options.seeds; ++i) {
      result_.seeds.push_back({.seed = study.scenario.seed + i, .controllers = {}});
      result_.seeds.back().controllers.resize(controllers_);
      gloves_[static_cast<std::size_t>(i)].users_left = static_cast<int>(controllers_);
      gloves_[static_cast<std::size_t>(i)].twins_left = static_cast<int>(controllers_);
    }
    if (options.keep_first_traces) {
      result_.first_traces.resize(controllers_);
      result_.first_twins.resize(controllers_);
    }
    for (int i = 0; i < options.seeds; ++i) trials_in_all_ += TrialsOf(study.scenario.seed + i);
    trials_in_all_ *= static_cast<int>(controllers_);
  }

  /// Takes tasks until there are none, an error or a stop.
  void Work() {
    while (!stopped_) {
      const std::size_t task = next_task_++;
      if (task >= tasks_of_seed_ * gloves_.size()) return;
      try {
        RunTask(task / tasks_of_seed_, task % tasks_of_seed_);
      } catch (...) {
        stopped_ = true;
        throw;
      }
    }
  }

  StudyResult Finish() { return std::move(result_); }

  std::size_t threads() const { return threads_; }

 private:
  TwinSource WantedTwin(int seed) const {
    const bool wanted =
        options_.scores.empty() || std::ranges::any_of(options_.scores, NeedsNoiseFreeTwin);
    return wanted ? TwinOf(study_, seed) : TwinSource::kNone;
  }
  int TrialsOf(int seed) const { return WantedTwin(seed) == TwinSource::kTrial ? 2 : 1; }

  /// Unless it is there; whoever wants it meanwhile waits.
  void MakeGlove(std::size_t seed_index) {
    SharedGlove& glove = gloves_[seed_index];
    const int seed = result_.seeds[seed_index].seed;
    std::call_once(glove.once, [&] {
      glove.signal = GloveOfSeed(study_, seed);
      glove.reference_rad = ReferenceAngles(study_.joint_map(), glove.signal->true_angle_rad);
      if (WantedTwin(seed) == TwinSource::kTrial) glove.noise_free = NoiseFreeGlove(study_, seed);
    });
  }

  /// As the last tasks of a seed begin, so that none of the threads that run them waits for it
  /// later.
  void MakeNextGlove(std::size_t seed_index, std::size_t task_of_seed) {
    const std::size_t next = seed_index + 1;
    const bool is_time = threads_ > 1 && tasks_of_seed_ > threads_ &&
                         task_of_seed + threads_ == tasks_of_seed_ && next < gloves_.size();
    if (!is_time) return;
    // Where the store has the first trial, it may have them all.
    if (options_.store != nullptr && options_.store->Take(result_.seeds[next].seed, 0)) return;
    ++gloves_[next].users_left;  // whoever else leaves it does not free what is being made
    ++gloves_[next].twins_left;
    MakeGlove(next);
    LeaveNoiseFreeGlove(gloves_[next]);
    LeaveGlove(next);
  }

  void RunTask(std::size_t seed_index, std::size_t task_of_seed) {
    const std::size_t first = task_of_seed * together_;
    std::vector<std::size_t> unknown;
    for (std::size_t c = first; c < std::min(first + together_, controllers_); ++c) {
      if (!Recall(seed_index, c, OutcomeOf(seed_index, c))) unknown.push_back(c);
    }
    if (unknown.empty()) return;
    MakeGlove(seed_index);
    MakeNextGlove(seed_index, task_of_seed);
    if (in_passing_) return RunInPassing(seed_index, unknown);
    for (const std::size_t c : unknown) RunWhole(seed_index, c);
  }

  TrialOutcome& OutcomeOf(std::size_t seed_index, std::size_t controller_index) {
    return result_.seeds[seed_index].controllers[controller_index];
  }

  /// One trial, with the signals that its scores need.
  void RunWhole(std::size_t seed_index, std::size_t controller_index) {
    SharedGlove& glove = gloves_[seed_index];
    TrialOutcome& outcome = OutcomeOf(seed_index, controller_index);
    const TwinSource twin_source = WantedTwin(result_.seeds[seed_index].seed);
    const bool keep = seed_index == 0 && options_.keep_first_traces;
    std::optional<NoiseFreeTwin> twin;
    if (glove.noise_free) twin = AsTwin(Run(controller_index, *glove.noise_free, kTwinSignals));
    LeaveNoiseFreeGlove(glove);
    Trace trace = Run(controller_index, *glove.signal,
                      keep ? std::vector<std::string_view>() : SignalsOfScores(options_.scores));
    if (twin_source == TwinSource::kItself) twin = AsTwin(trace);
    outcome.health = trace.health;
    outcome.scores = trace.health.ok ? ScoreTrial(study_, *glove.signal, glove.reference_rad, trace,
                                                  twin, options_.scores)
                                     : NoScores(study_.rows);
    outcome.untrusted_samples = trace.untrusted_samples;
    if (keep) {
      result_.first_traces[controller_index] = std::move(trace);
      result_.first_twins[controller_index] = std::move(twin);
    }
    FinishTrial(seed_index, controller_index);
  }

  /// Trials without a hand whose scores need no signals.
  void RunInPassing(std::size_t seed_index, std::span<const std::size_t> controllers) {
    const SharedGlove& glove = gloves_[seed_index];
    std::vector<TrialSetup> setups;
    for (const std::size_t c : controllers) {
      setups.push_back(SetupOf(study_, study_.scenario.controllers[c]));
    }
    std::vector<MeanSquareError> errors(setups.size(), ErrorInPassing(study_, *glove.signal));
    Eigen::Index tick = 0;  // of the next block
    AngleRows reference_rad;
    std::vector<Trace> traces =
        RunFilterTrials(setups, *glove.signal,
                        [&](std::size_t trial, const Eigen::Ref<const AngleRows>& angle_rad) {
                          if (trial == 0) {
                            reference_rad = glove.reference_rad.middleRows(tick, angle_rad.rows());
                            if (tick % kTrimRows == 0) TrimSignals();
                            tick += angle_rad.rows();
                          }
                          errors[trial].AddRows(angle_rad, reference_rad);
                        });
    for (std::size_t i = 0; i < controllers.size(); ++i) {
      if (!Progress(1.0)) throw Cancelled{};
      TrialOutcome& outcome = OutcomeOf(seed_index, controllers[i]);
      outcome.scores = ScoreInPassing(study_, errors[i], options_.scores);
      outcome.untrusted_samples = std::move(traces[i].untrusted_samples);
      FinishTrial(seed_index, controllers[i]);
    }
  }

  void FinishTrial(std::size_t seed_index, std::size_t controller_index) {
    TrialOutcome& outcome = OutcomeOf(seed_index, controller_index);
    if (options_.store != nullptr) {
      options_.store->Keep(result_.seeds[seed_index].seed, controller_index, outcome);
    }
    if (!options_.keep_rows) outcome.scores.channels = {};
    LeaveGlove(seed_index);
  }

  /// Records these signals, or all if none is named.
  Trace Run(std::size_t controller_index, const GloveSignal& glove,
            std::span<const std::string_view> signals) {
    const TrialSetup setup = SetupOf(study_, study_.scenario.controllers[controller_index]);
    if (!options_.physics) {
      Trace trace = RunFilterTrial(setup, glove);
      if (!Progress(1.0)) throw Cancelled{};
      return trace;
    }
    const Eigen::Index blocks = glove.true_angle_rad.rows() / TraceRecorder::kBlockTicks + 1;
    return RunTrial(setup, glove,
                    {.keep_going = [&] { return Progress(1.0 / static_cast<double>(blocks)); },
                     .signals = {signals.begin(), signals.end()}});
  }

  /// The last twin of a seed frees its signal, in whose memory the trial's signals then lie.
  static void LeaveNoiseFreeGlove(SharedGlove& glove) {
    if (--glove.twins_left == 0) glove.noise_free.reset();
  }

  /// The last trial of a seed frees its signal, or hands out that of the first seed.
  void LeaveGlove(std::size_t seed_index) {
    SharedGlove& glove = gloves_[seed_index];
    if (--glove.users_left > 0) return;
    if (seed_index == 0 && options_.keep_first_traces) {
      result_.reference_name = glove.signal->reference_name;
      result_.first_glove = std::move(glove.signal);
      result_.first_reference_rad = std::move(glove.reference_rad);
    }
    glove.signal.reset();
    glove.reference_rad = {};
  }

  /// Takes a trial from the store, if it is there. The first seed runs again where its signals are
  /// wanted, too.
  bool Recall(std::size_t seed_index, std::size_t controller_index, TrialOutcome& outcome) {
    if (options_.store == nullptr) return false;
    if (seed_index == 0 && options_.keep_first_traces) return false;
    auto known = options_.store->Take(result_.seeds[seed_index].seed, controller_index);
    if (!known) return false;
    outcome = std::move(*known);
    LeaveNoiseFreeGlove(gloves_[seed_index]);
    LeaveGlove(seed_index);
    Progress(TrialsOf(result_.seeds[seed_index].seed));
    return true;
  }

  bool Progress(double trials) {
    if (stopped_) return false;
    if (!options_.progress) return true;
    const std::lock_guard lock(mutex_);
    trials_done_ += trials;
    return options_.progress(std::min(trials_done_, static_cast<double>(trials_in_all_)),
                             trials_in_all_);
  }

  const Study& study_;
  const StudyOptions& options_;
  std::vector<SharedGlove> gloves_;
  std::size_t controllers_;
  bool in_passing_;       // all scores are found so
  std::size_t together_;  // controllers of a task
  std::size_t tasks_of_seed_;
  std::size_t threads_;
  StudyResult result_;
  std::atomic<std::size_t> next_task_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  double trials_done_ = 0.0;
  int trials_in_all_ = 0;  // twins counted
};

}  // namespace

std::size_t ControllersTogether(const StudyOptions& options, std::size_t controllers) {
  if (!IsInPassing(options)) return 1;
  constexpr std::size_t kMost = 128;  // more gain little
  // Each thread has two tasks of a seed, so that the next glove is made meanwhile.
  return std::clamp<std::size_t>(controllers / (2 * JobsOf(options)), 1, kMost);
}

TwinSource TwinOf(const Study& study, int seed) {
  if (!study.scenario.score.noise_free_twin) return TwinSource::kNone;
  const int repetition = (seed - study.scenario.seed) % static_cast<int>(study.repetitions.size());
  if (study.repetitions[repetition].is_recorded) return TwinSource::kNone;
  const bool itself = IsWithoutNoise(GloveOf(study.scenario, seed));
  return itself ? TwinSource::kItself : TwinSource::kTrial;
}

int TrialCount(const Study& study, int seeds) {
  int count = 0;
  for (int i = 0; i < seeds; ++i) {
    count += TwinOf(study, study.scenario.seed + i) == TwinSource::kTrial ? 2 : 1;
  }
  return count * static_cast<int>(study.scenario.controllers.size());
}

StudyResult RunStudy(const Study& study, const StudyOptions& asked) {
  StudyOptions options = asked;
  const Repeats repeats(study, asked.seeds);
  if (repeats.alike()) options.seeds = static_cast<int>(study.repetitions.size());
  CheckRoom(study, options);
  Schedule schedule(study, options);
  RunOnThreads(
      schedule.threads(), [&schedule] { schedule.Work(); },
      [&](std::size_t started, const std::string& reason) {
        if (!options.remark) return;
        options.remark(fmt::format("only {} of {} threads can be started: {}", started,
                                   schedule.threads(), reason));
      });
  StudyResult result = schedule.Finish();
  result.seeds_alike = repeats.alike();
  NumberMotions(repeats, result);
  FindDurations(study, result);
  return result;
}

}  // namespace gauntlet::sim
