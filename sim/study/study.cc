#include "sim/study/study.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/nearest_name.h"
#include "sim/study/study_database.h"

namespace gauntlet::sim {
namespace {

/// The glove signal of one seed, made by the first trial that needs it, freed after the last.
struct SharedGlove {
  std::once_flag once;
  GloveSignal signal;
  std::atomic<int> users_left{0};
};

Scores Score(const GloveSignal& glove, const Trace& trace, const std::vector<int>& cable_channel) {
  std::vector<LabelledSegment> segments;
  for (const MotionSegment& segment : glove.segments) {
    segments.push_back({segment.label, segment.begin, segment.end});
  }
  ScoreInput input;
  input.rate_hz = glove.rate_hz;
  input.reference_angle_rad = &glove.true_angle_rad;
  input.hand_angle_rad = &trace.hand_angle_rad;
  input.command_counts = &trace.command_counts;
  input.motor_speed_rad_s = &trace.spool_speed_rad_s;
  input.tension_n = &trace.tension_n;
  input.cable_channel = cable_channel;
  if (trace.grip_force_n.cols() > 0) input.grip_force_n = &trace.grip_force_n;
  input.saturation_share = trace.saturation_share;
  input.segments = segments;
  return ComputeScores(input);
}

/// Per cable the channel that it moves: the one whose name the cable's begins with.
std::vector<int> CableChannels(const HandModel& hand) {
  const std::vector<std::string>& channels = hand.transmission().channel_names;
  std::vector<int> result;
  for (const std::string& cable : hand.cable_names()) {
    const auto found = std::find_if(channels.begin(), channels.end(), [&](const auto& channel) {
      return cable.starts_with(channel + "_");
    });
    result.push_back(static_cast<int>(found - channels.begin()));
  }
  return result;
}

std::string HashOf(const GloveSignal& glove) {
  Hash hash;
  for (const Signal* signal : {&glove.counts, &glove.true_angle_rad}) {
    hash.Add(std::span<const double>(signal->data(), static_cast<std::size_t>(signal->size())));
  }
  return hash.Text();
}

/// The trials of a study as tasks that threads take in the order of seeds.
class Schedule {
 public:
  Schedule(const Study& study, const StudyOptions& options)
      : study_(study),
        options_(options),
        gloves_(static_cast<std::size_t>(options.seeds)),
        controllers_(study.scenario.controllers.size()),
        cable_channel_(CableChannels(*study.hand)) {
    result_.channel_names = study.hand->transmission().channel_names;
    result_.rate_hz = study.scenario.glove.rate_hz;
    for (const NamedController& c : study.scenario.controllers) {
      result_.controller_names.push_back(c.name);
    }
    for (int i = 0; i < options.seeds; ++i) {
      result_.seeds.push_back({.seed = study.scenario.seed + i, .controllers = {}});
      result_.seeds.back().controllers.resize(controllers_);
      gloves_[static_cast<std::size_t>(i)].users_left = static_cast<int>(controllers_);
    }
    if (options.keep_first_traces) result_.first_traces.resize(controllers_);
  }

  /// Takes tasks until there are none, an error or a stop.
  void Work() {
    while (!stopped_) {
      const std::size_t task = next_task_++;
      if (task >= TaskCount()) return;
      try {
        RunTask(task / controllers_, task % controllers_);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
        stopped_ = true;
      }
    }
  }

  StudyResult Finish() {
    if (error_) std::rethrow_exception(error_);
    return std::move(result_);
  }

  std::size_t TaskCount() const { return controllers_ * gloves_.size(); }

 private:
  void RunTask(std::size_t seed_index, std::size_t controller_index) {
    SeedOutcome& seed = result_.seeds[seed_index];
    SharedGlove& glove = gloves_[seed_index];
    TrialOutcome& outcome = seed.controllers[controller_index];
    if (Recall(seed_index, controller_index, outcome)) return;
    std::call_once(glove.once, [&] {
      glove.signal = SynthesiseGlove(study_.scenario.glove, static_cast<std::uint64_t>(seed.seed));
    });
    const NamedController& named = study_.scenario.controllers[controller_index];
    const Eigen::Index blocks = glove.signal.counts.rows() / 64 + 1;
    Trace trace =
        RunTrial(named.name, named.config, glove.signal, study_.calibration, study_.scenario.event,
                 study_.hand, [&] { return Progress(1.0 / static_cast<double>(blocks)); });
    outcome.scores = Score(glove.signal, trace, cable_channel_);
    outcome.health = trace.health;
    outcome.untrusted_samples = trace.untrusted_samples;
    if (options_.database != nullptr) {
      options_.database->Keep(seed.seed, controller_index, outcome);
    }
    const bool keep = seed_index == 0 && options_.keep_first_traces;
    if (keep) result_.first_traces[controller_index] = std::move(trace);
    LeaveGlove(seed_index);
  }

  /// The last trial of a seed frees its signal, or hands out that of the first seed.
  void LeaveGlove(std::size_t seed_index) {
    SharedGlove& glove = gloves_[seed_index];
    if (--glove.users_left > 0) return;
    if (seed_index == 0) {
      result_.reference_name = glove.signal.reference_name;
      result_.first_glove = std::move(glove.signal);
    }
    glove.signal = {};
  }

  /// Takes a trial from the database, if it is there. The first seed runs again: its signals are
  /// wanted, too.
  bool Recall(std::size_t seed_index, std::size_t controller_index, TrialOutcome& outcome) {
    if (options_.database == nullptr || seed_index == 0) return false;
    auto known = options_.database->Find(result_.seeds[seed_index].seed, controller_index);
    if (!known) return false;
    outcome = std::move(*known);
    LeaveGlove(seed_index);
    Progress(1.0);
    return true;
  }

  bool Progress(double trials) {
    if (stopped_) return false;
    if (!options_.progress) return true;
    const std::lock_guard lock(mutex_);
    trials_done_ += trials;
    return options_.progress(std::min(trials_done_, static_cast<double>(TaskCount())),
                             static_cast<int>(TaskCount()));
  }

  const Study& study_;
  const StudyOptions& options_;
  std::vector<SharedGlove> gloves_;
  std::size_t controllers_;
  std::vector<int> cable_channel_;
  StudyResult result_;
  std::atomic<std::size_t> next_task_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
  double trials_done_ = 0.0;
};

/// Errors: SettingError for a channel that the glove does not have.
void ChooseVideoChannel(const std::vector<std::string>& channels, std::string& channel) {
  const auto has = [&channels](const std::string& name) {
    return std::ranges::find(channels, name) != channels.end();
  };
  if (channel.empty()) channel = has("index_mcp") ? "index_mcp" : channels.front();
  if (has(channel)) return;
  throw controller::SettingError(
      "video.channel", channel + " is not a channel of this glove" + Suggestion(channel, channels));
}

}  // namespace

Study PrepareStudy(Scenario scenario) {
  Study study;
  // A recording that cannot be read is found here, before anything is written.
  GloveSignal glove = controller::WithinSetting("glove", [&scenario] {
    return SynthesiseGlove(scenario.glove, static_cast<std::uint64_t>(scenario.seed));
  });
  study.hand = std::make_shared<const HandModel>(scenario.hand, glove.channel_names);
  study.calibration = NominalCalibration(scenario.glove);
  study.glove_hash = HashOf(glove);
  for (const NamedController& named : scenario.controllers) {
    controller::WithinSetting("controllers." + named.name, [&] {
      return controller::Controller(named.config, study.calibration, study.hand->transmission());
    });
  }
  ChooseVideoChannel(glove.channel_names, scenario.video.channel);
  study.scenario = std::move(scenario);
  study.remarks = std::move(glove.remarks);
  return study;
}

StudyResult RunStudy(const Study& study, const StudyOptions& options) {
  Schedule schedule(study, options);
  const std::size_t threads = std::min<std::size_t>(
      static_cast<std::size_t>(std::max(1, options.jobs)), schedule.TaskCount());
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back([&schedule] { schedule.Work(); });
  schedule.Work();
  for (std::thread& thread : others) thread.join();
  return schedule.Finish();
}

}  // namespace gauntlet::sim
