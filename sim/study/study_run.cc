#include "sim/study/study_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "sim/base/error.h"
#include "sim/base/threads.h"
#include "sim/score/no_score.h"
#include "sim/study/cause_trials.h"
#include "sim/study/repeats.h"
#include "sim/study/study.h"
#include "sim/study/study_room.h"
#include "sim/study/trial_score.h"
#include "sim/trial/external/external_filters.h"
#include "sim/trial/filter_trial.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {
namespace {

/// The glove signals of one seed, made by the first trial that needs them. They live as long as
/// the tasks that hold them.
struct SeedGloves {
  struct Shared {
    std::once_flag once;
    std::shared_ptr<const GloveSignal> signal;
    Signal reference_rad;  // ticks x joints of the hand
  };
  std::shared_ptr<Shared> shared = std::make_shared<Shared>();
  /// Only where the noise-free twin is a trial of its own.
  std::shared_ptr<std::optional<GloveSignal>> noise_free =
      std::make_shared<std::optional<GloveSignal>>();
};

/// One controller of one seed.
struct TrialTask {
  std::size_t seed_index = 0;
  std::size_t controller = 0;
  SeedGloves gloves;
  std::optional<SeedGloves> next;  // of the next seed, if this task makes them
};

/// The trials of a study as tasks, in the order of the seeds. Any thread may call it.
class TrialQueue {
 public:
  TrialQueue(const WorkRange& trials, std::size_t controllers, std::size_t jobs);

  /// None after the last task, or after Stop().
  std::optional<TrialTask> Next();
  void Stop() { stopped_ = true; }
  bool is_stopped() const { return stopped_; }
  std::size_t threads() const { return threads_; }

 private:
  std::size_t controllers_;
  std::size_t end_;  // of the tasks
  std::size_t threads_;
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::size_t next_task_;
  SeedGloves gloves_;  // of the seed whose tasks are given out
  SeedGloves next_gloves_;
};

TrialQueue::TrialQueue(const WorkRange& trials, std::size_t controllers, std::size_t jobs)
    : controllers_(controllers),
      end_(static_cast<std::size_t>(trials.end)),
      threads_(std::min(jobs, static_cast<std::size_t>(trials.end - trials.first))),
      next_task_(static_cast<std::size_t>(trials.first)) {}

std::optional<TrialTask> TrialQueue::Next() {
  const std::lock_guard lock(mutex_);
  if (stopped_ || next_task_ >= end_) return std::nullopt;
  const std::size_t place = next_task_ % controllers_;
  if (place == 0) gloves_ = std::exchange(next_gloves_, SeedGloves{});
  TrialTask task = {
      .seed_index = next_task_ / controllers_, .controller = place, .gloves = gloves_, .next = {}};
  ++next_task_;
  // The last tasks of a seed run on all threads. The first of these tasks makes the next glove, so
  // that no thread waits for it later.
  const bool is_last_seed = (task.seed_index + 1) * controllers_ >= end_;
  if (threads_ > 1 && place > 0 && place + threads_ == controllers_ && !is_last_seed) {
    task.next = next_gloves_;
  }
  if (place + 1 == controllers_) gloves_ = {};
  return task;
}

/// None of a trial that ended early. Moves the signals of a trace that is not needed any more.
template <class AnyTrace>
std::optional<NoiseFreeTwin> AsTwin(AnyTrace&& trace) {
  if (!trace.health.ok) return std::nullopt;
  return NoiseFreeTwin{.hand_angle_rad = std::forward<AnyTrace>(trace).hand_angle_rad,
                       .spool_speed_rad_s = std::forward<AnyTrace>(trace).spool_speed_rad_s};
}

/// Deletes the scores of a trial that need trials for causes, of one kind or of both.
void ForgetCauses(bool switched, bool chain, Scores& scores) {
  for (std::size_t m = 0; m < Metrics().size(); ++m) {
    const Metric& metric = Metrics()[m];
    if (!(switched && metric.needs_switched) && !(chain && metric.needs_chain)) continue;
    scores.summary[m] = kNoScore;
    for (std::vector<double>& row : scores.channels) row[m] = kNoScore;
  }
}

/// Causes that are named as scores are found of all seeds, and of whole trials.
CausePlan PlanOf(const Study& study, const StudyOptions& options) {
  CausePlan plan;
  if (!options.physics) return plan;
  if (options.scores.empty()) return PlanCauses(study, options.seeds, options.causes);
  plan.switched = AnyNeeds(options.scores, &Metric::needs_switched);
  plan.chain = AnyNeeds(options.scores, &Metric::needs_chain);
  if (plan.switched || plan.chain) plan.seeds = options.seeds;
  plan.trials = (plan.switched ? SwitchedTrialsOf(study, study.scenario.seed) : 0) +
                (plan.chain ? ChainTrialsOf(study) : 0);
  return plan;
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

/// Filters alone would be scored as if there were no links. Errors: SettingError.
void RefuseLinks(const Scenario& scenario) {
  for (const NamedController& named : scenario.controllers) {
    if (!LinksOf(scenario, named).exist()) continue;
    throw controller::SettingError(
        "link", "is simulated only with a hand; leave out --filter-only (physics: false)");
  }
}

/// Runs the trials of a study on the threads that call Work().
class StudyRun {
 public:
  StudyRun(const Study& study, const StudyOptions& options, const WorkRange& trials)
      : study_(study),
        options_(options),
        causes_(PlanOf(study, options)),
        cause_trials_(study),
        queue_(trials, study.scenario.controllers.size(),
               static_cast<std::size_t>(std::max(1, options.jobs))) {
    const std::size_t controllers = study.scenario.controllers.size();
    result_.row_names = study.rows.names;
    for (const NamedController& c : study.scenario.controllers) {
      result_.controller_names.push_back(c.name);
    }
    for (int i = 0; i < options.seeds; ++i) {
      const int seed = study.scenario.seed + i;
      result_.seeds.push_back(
          {.seed = seed, .controllers = std::vector<TrialOutcome>(controllers)});
    }
    for (std::int64_t i = trials.first; i < trials.end; ++i) {
      const auto number = static_cast<std::size_t>(i);
      trials_in_all_ += TrialsOf(number / controllers, number % controllers);
    }
    if (options.keep_first_traces) {
      result_.first_traces.resize(controllers);
      result_.first_twins.resize(controllers);
      result_.first_others.resize(controllers);
    }
  }

  /// Takes tasks until there are none, an error or a stop.
  void Work() {
    while (std::optional<TrialTask> task = queue_.Next()) {
      try {
        RunTask(*task);
      } catch (...) {
        queue_.Stop();
        throw;
      }
    }
  }

  StudyResult Finish() {
    result_.causes = causes_;
    if (first_glove_) {
      result_.reference_name = first_glove_->signal->reference_name;
      result_.first_glove = std::move(first_glove_->signal);
      result_.first_reference_rad = std::move(first_glove_->reference_rad);
    }
    return std::move(result_);
  }

  std::size_t threads() const { return queue_.threads(); }

 private:
  TwinSource WantedTwin(int seed) const {
    const bool wanted = options_.scores.empty() || AnyNeeds(options_.scores, &Metric::needs_twin) ||
                        causes_.seeds > 0;
    return wanted ? TwinOf(study_, seed) : TwinSource::kNone;
  }
  double TrialsOf(std::size_t seed_index, std::size_t controller_index) const {
    return (WantedTwin(result_.seeds[seed_index].seed) == TwinSource::kTrial ? 2.0 : 1.0) +
           (causes_.Has(seed_index, controller_index) ? causes_.trials : 0.0);
  }

  /// Unless they are there; a thread that needs them meanwhile waits.
  void Make(const SeedGloves& gloves, std::size_t seed_index) {
    const int seed = result_.seeds[seed_index].seed;
    std::call_once(gloves.shared->once, [&] {
      SeedGloves::Shared& shared = *gloves.shared;
      if (seed_index == 0 && options_.keep_first_traces) first_glove_ = gloves.shared;
      shared.signal = GloveOfSeed(study_, seed);
      shared.reference_rad = ReferenceAngles(study_.joint_map(), shared.signal->true_angle_rad);
      if (WantedTwin(seed) != TwinSource::kTrial) return;
      gloves.noise_free->emplace(SynthesiseGlove(WithoutNoise(GloveOf(study_.scenario, seed)),
                                                 static_cast<std::uint64_t>(seed)));
    });
  }

  void RunTask(TrialTask& task) {
    if (Recall(task.seed_index, task.controller)) return;
    Make(task.gloves, task.seed_index);
    if (task.next) {
      const std::size_t next = task.seed_index + 1;
      // If the store has the first trial, it may have all of them.
      if (!options_.store || !options_.store->Has(result_.seeds[next].seed, 0)) {
        Make(*task.next, next);
      }
      task.next.reset();
    }
    RunTrialOf(task);
  }

  int SeedOf(const TrialTask& task) const { return result_.seeds[task.seed_index].seed; }
  TrialOutcome& OutcomeOf(std::size_t seed_index, std::size_t controller_index) {
    return result_.seeds[seed_index].controllers[controller_index];
  }

  /// One trial, with the signals that its scores need.
  void RunTrialOf(TrialTask& task) {
    ReturnFreedMemory();  // of the recording, of the glove, of the last trial's scores
    const std::size_t seed_index = task.seed_index;
    const std::size_t controller_index = task.controller;
    const SeedGloves::Shared& glove = *task.gloves.shared;
    TrialOutcome& outcome = OutcomeOf(seed_index, controller_index);
    const TwinSource twin_source = WantedTwin(result_.seeds[seed_index].seed);
    const bool keep = seed_index == 0 && options_.keep_first_traces;
    std::optional<NoiseFreeTwin> twin;
    if (*task.gloves.noise_free) {
      twin = AsTwin(Run(task, **task.gloves.noise_free, kTwinSignals));
    }
    task.gloves.noise_free.reset();  // in whose memory the trial's signals then lie
    Trace trace = Run(task, *glove.signal,
                      keep ? std::vector<std::string_view>() : SignalsOfScores(options_.scores));
    if (twin_source == TwinSource::kItself) twin = AsTwin(trace);
    outcome.health = trace.health;
    const NamedController& named = study_.scenario.controllers[controller_index];
    CauseAngles others;
    if (causes_.Has(seed_index, controller_index) && trace.health.ok &&
        HasTypicalBegin(named, glove, trace)) {
      const Signal unknown;
      others = cause_trials_.Run(causes_,
                                 {.named = named,
                                  .seed = SeedOf(task),
                                  .glove = *glove.signal,
                                  .noise_free = twin ? twin->hand_angle_rad : unknown,
                                  .progress = [this](double trials) { return Progress(trials); }});
    }
    const auto score = [&](const CountedTicks& left_out) {
      return ScoreTrial(study_, named.config, *glove.signal, glove.reference_rad, trace, twin,
                        options_.scores, others, left_out);
    };
    const std::size_t repetition = seed_index % study_.repetitions.size();
    CountedTicks left_out =
        options_.left_out.empty() ? CountedTicks() : options_.left_out[repetition];
    outcome.scores = trace.health.ok ? score(left_out) : NoScores(study_.rows);
    if (trace.health.ok && !options_.blocks.empty()) {
      std::vector<Scores*> alike = {&outcome.scores};
      for (const TickRange& block : options_.blocks[repetition]) {
        left_out.push_back(block);
        outcome.without.push_back(score(left_out));
        left_out.pop_back();
      }
      for (Scores& one : outcome.without) alike.push_back(&one);
      UseCommonParts(alike);
    }
    outcome.untrusted_samples = trace.untrusted_samples;
    if (keep) {
      result_.first_traces[controller_index] = std::move(trace);
      result_.first_twins[controller_index] = std::move(twin);
      result_.first_others[controller_index] = std::move(others);
    }
    FinishTrial(seed_index, controller_index);
  }

  /// True if the stretch of the trials for causes has the tracking error of the whole trial, within
  /// 20 %.
  bool HasTypicalBegin(const NamedController& named, const SeedGloves::Shared& glove,
                       const Trace& trace) const {
    constexpr double kMost = 1.2;
    if (!causes_.ticks) return true;
    const std::vector<std::size_t> tracking = {MetricIndex("tracking_rmse_deg")};
    const auto error = [&](const CountedTicks& left_out) {
      return ScoreTrial(study_, named.config, *glove.signal, glove.reference_rad, trace, {},
                        tracking, {}, left_out)
          .summary[tracking.front()];
    };
    const double whole = error({});
    const double first =
        error({{static_cast<int>(*causes_.ticks), static_cast<int>(trace.hand_angle_rad.rows())}});
    return first <= kMost * whole && whole <= kMost * first;
  }

  void FinishTrial(std::size_t seed_index, std::size_t controller_index) {
    TrialOutcome& outcome = OutcomeOf(seed_index, controller_index);
    if (options_.store != nullptr) {
      const int seed = result_.seeds[seed_index].seed;
      if (causes_.ticks && causes_.Has(seed_index, controller_index)) {
        TrialOutcome kept = outcome;  // of a whole trial alone
        ForgetCauses(true, true, kept.scores);
        options_.store->Keep(seed, controller_index, kept);
      } else {
        options_.store->Keep(seed, controller_index, outcome);
      }
    }
    if (!options_.keep_rows) outcome.scores.channels = {};
    for (Scores& one : outcome.without) one.channels = {};
  }

  /// Records these signals, or all if none is named.
  Trace Run(const TrialTask& task, const GloveSignal& glove,
            std::span<const std::string_view> signals) {
    const TrialSetup setup =
        SetupOf(study_, study_.scenario.controllers[task.controller], SeedOf(task));
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

  /// Takes a trial from the store, if it is there. The first seed runs again where its signals are
  /// wanted, too.
  bool Recall(std::size_t seed_index, std::size_t controller_index) {
    if (options_.store == nullptr) return false;
    if (seed_index == 0 && options_.keep_first_traces) return false;
    auto known = options_.store->Take(result_.seeds[seed_index].seed, controller_index);
    if (!known) return false;
    const NamedController& named = study_.scenario.controllers[controller_index];
    if (!known->health.ok && HasPrograms(named.config)) return false;  // it may go well now
    const bool wants = causes_.Has(seed_index, controller_index);
    const auto lacks = [&](bool wanted, std::size_t metric) {
      return wanted && (causes_.ticks || !std::isfinite(known->scores.summary[metric]));
    };
    if (wants && known->health.ok && options_.scores.empty() &&
        (lacks(causes_.switched, ErrorWithAll()) ||
         lacks(causes_.chain, TrackingErrorParts().back().metric))) {
      return false;
    }
    if (options_.scores.empty()) {
      // Results do not depend on what earlier runs computed.
      ForgetCauses(!wants || !causes_.switched, !wants || !causes_.chain, known->scores);
    }
    OutcomeOf(seed_index, controller_index) = std::move(*known);
    Progress(TrialsOf(seed_index, controller_index));
    return true;
  }

  bool Progress(double trials) {
    if (queue_.is_stopped()) return false;
    if (!options_.progress) return true;
    const std::lock_guard lock(mutex_);
    trials_done_ += trials;
    const int all = static_cast<int>(std::ceil(trials_in_all_));
    return options_.progress(std::min(trials_done_, static_cast<double>(all)), all);
  }

  const Study& study_;
  const StudyOptions& options_;
  CausePlan causes_;
  CauseTrials cause_trials_;
  TrialQueue queue_;
  StudyResult result_;
  std::shared_ptr<SeedGloves::Shared> first_glove_;
  std::mutex mutex_;  // of the progress
  double trials_done_ = 0.0;
  double trials_in_all_ = 0.0;  // twins counted
};

/// Gives what CheckRoom() gives. Errors: SettingError, RunError.
std::shared_ptr<const FewSignalsOnHeap> CheckOptions(const Study& study,
                                                     const StudyOptions& options,
                                                     bool seeds_alike) {
  if (!options.physics) RefuseLinks(study.scenario);
  if (options.seeds > 1 && !seeds_alike) RefuseOtherGloves(study, options.seeds);
  return CheckRoom(study, options);
}

void RunOnAllThreads(const StudyOptions& options, StudyRun& run) {
  RunOnThreads(
      run.threads(), [&run] { run.Work(); },
      [&](std::size_t started, const std::string& reason) {
        if (!options.remark) return;
        options.remark(fmt::format("only {} of {} threads can be started: {}", started,
                                   run.threads(), reason));
      });
}

}  // namespace

int TrialCount(const Study& study, int seeds, CauseSeeds causes) {
  const CausePlan plan = PlanCauses(study, seeds, causes);
  const auto controllers = static_cast<double>(study.scenario.controllers.size());
  double count = plan.seeds * plan.trials * (plan.controller ? 1.0 : controllers);
  for (int i = 0; i < seeds; ++i) {
    const bool twin = TwinOf(study, study.scenario.seed + i) == TwinSource::kTrial;
    count += (twin ? 2.0 : 1.0) * controllers;
  }
  return static_cast<int>(std::ceil(count));
}

int SeedsThatDiffer(const Study& study, int seeds) {
  return Repeats(study, seeds).alike() ? static_cast<int>(study.repetitions.size()) : seeds;
}

StudyResult RunStudy(const Study& study, const StudyOptions& asked) {
  StudyOptions options = asked;
  const Repeats repeats(study, asked.seeds);
  if (repeats.alike()) options.seeds = static_cast<int>(study.repetitions.size());
  std::shared_ptr<const FewSignalsOnHeap> few_on_heap =
      CheckOptions(study, options, repeats.alike());
  StudyRun run(study, options, {0, options.seeds * std::ssize(study.scenario.controllers)});
  RunOnAllThreads(options, run);
  StudyResult result = run.Finish();
  result.few_on_heap = std::move(few_on_heap);
  for (SeedOutcome& seed : result.seeds) {
    std::vector<Scores*> trials;
    for (TrialOutcome& trial : seed.controllers) trials.push_back(&trial.scores);
    UseCommonParts(trials);
  }
  result.seeds_alike = repeats.alike();
  const std::vector<int> motions = repeats.MotionNumbers(result.seeds.size());
  for (std::size_t i = 0; i < motions.size(); ++i) result.seeds[i].motion = motions[i];
  FindDurations(study, result);
  return result;
}

void RunSomeTrials(const Study& study, const StudyOptions& asked, const WorkRange& trials) {
  StudyOptions options = asked;
  options.seeds = SeedsThatDiffer(study, asked.seeds);
  const auto few_on_heap = CheckOptions(study, options, options.seeds < asked.seeds);
  StudyRun run(study, options, trials);
  RunOnAllThreads(options, run);
}

}  // namespace gauntlet::sim
