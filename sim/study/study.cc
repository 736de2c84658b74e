#include "sim/study/study.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/nearest_name.h"
#include "sim/study/study_database.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/trace_recorder.h"

namespace gauntlet::sim {
namespace {

/// The glove signal of one seed, made by the first trial that needs it, freed after the last.
struct SharedGlove {
  std::once_flag once;
  std::shared_ptr<const GloveSignal> signal;
  std::shared_ptr<const GloveSignal> noise_free;  // for twins that are trials; else null
  Signal reference_rad;                           // ticks x joints of the hand
  std::atomic<int> users_left{0};
};

/// Of each measured cable what its motor pulls with at stall [N].
std::vector<double> StallTensions(const Study& study) {
  std::vector<double> tensions;
  for (const int motor : study.measured_motors) {
    const Drive& drive = study.hand->drives()[static_cast<std::size_t>(motor)];
    tensions.insert(tensions.end(), drive.cables.size(),
                    drive.servo.stall_torque_nm / drive.drum_radius_m);
  }
  return tensions;
}

/// Per measured joint the places among the measured motors of those that turn it.
std::vector<std::vector<int>> MotorsOfJoints(const Study& study) {
  const controller::TendonTransmission& hand = study.hand->transmission();
  std::vector<std::vector<int>> motors_of_joints;
  for (const int joint : study.measured_joints) {
    std::vector<int>& motors = motors_of_joints.emplace_back();
    for (std::size_t i = 0; i < study.measured_motors.size(); ++i) {
      const int motor = study.measured_motors[i];
      if (hand.coupling[motor * study.joint_count + joint] != 0.0) {
        motors.push_back(static_cast<int>(i));
      }
    }
  }
  return motors_of_joints;
}

/// Per measured motor the share of ticks in which it gives all that it has.
std::vector<double> SaturationShares(const Study& study, const FlagSignal& at_limit) {
  std::vector<double> shares;
  const auto ticks = static_cast<double>(std::max<Eigen::Index>(at_limit.rows(), 1));
  for (const int motor : study.measured_motors) {
    shares.push_back(static_cast<double>(at_limit.col(motor).cast<std::int64_t>().sum()) / ticks);
  }
  return shares;
}

/// The columns of measured parts of a twin, or nothing.
struct MeasuredTwin {
  MeasuredTwin(const Study& study, const NoiseFreeTwin& twin)
      : hand(twin.hand_angle_rad, study.measured_joints),
        speed(twin.spool_speed_rad_s, study.measured_motors),
        at_limit(twin.motor_at_limit(Eigen::all, study.measured_motors).cast<int>()) {}

  Columns<Signal> hand;
  Columns<Signal> speed;
  IntegerSignal at_limit;
};

Scores Score(const Study& study, const GloveSignal& glove, const Signal& reference_rad,
             const Trace& trace, const std::optional<NoiseFreeTwin>& twin) {
  const Columns reference(reference_rad, study.measured_joints);
  const Columns hand(trace.hand_angle_rad, study.measured_joints);
  const Columns command(trace.command_counts, study.measured_motors);
  const Columns speed(trace.spool_speed_rad_s, study.measured_motors);
  const Columns tension(trace.tension_n, study.measured_cables);
  const std::vector<double> stall_tension_n = StallTensions(study);
  const std::vector<double> saturation_share = SaturationShares(study, trace.motor_at_limit);
  const std::vector<std::vector<int>> motors_of_joint = MotorsOfJoints(study);
  std::optional<MeasuredTwin> measured_twin;
  if (twin) measured_twin.emplace(study, *twin);
  ScoreInput input;
  input.rate_hz = glove.tick_rate_hz;
  input.reference_angle_rad = &*reference;
  input.hand_angle_rad = &*hand;
  input.command_counts = &*command;
  input.motor_speed_rad_s = &*speed;
  input.tension_n = &*tension;
  if (trace.grip_force_n.cols() > 0) input.grip_force_n = &trace.grip_force_n;
  input.saturation_share = saturation_share;
  input.segments = glove.segments;
  input.frame_ms = std::max(study.scenario.event.period_ms, study.scenario.hand.servo.frame_ms);
  input.jitter_above_hz = study.scenario.score.jitter_above_hz;
  input.stall_tension_n = stall_tension_n;
  input.motors_of_joint = motors_of_joint;
  if (measured_twin) {
    input.noise_free_hand_angle_rad = &*measured_twin->hand;
    input.noise_free_motor_speed_rad_s = &*measured_twin->speed;
    input.noise_free_motor_at_limit = &measured_twin->at_limit;
  }
  Scores scores = ComputeScores(input, study.rows);
  // No score is -0.0, which SQLite keeps as 0.0.
  for (double& score : scores.summary) score += 0.0;
  for (std::vector<double>& channel : scores.channels) {
    for (double& score : channel) score += 0.0;
  }
  return scores;
}

template <class Names>
std::vector<std::string> Selected(const Names& names, const std::vector<int>& indices) {
  std::vector<std::string> selected;
  for (const int index : indices) selected.push_back(names[static_cast<std::size_t>(index)]);
  return selected;
}

/// Fills in which parts of the hand count.
void FindMeasuredParts(Study& study) {
  const controller::TendonTransmission& hand = study.hand->transmission();
  const controller::JointMap joint_map = study.joint_map();
  const int joints = joint_map.joint_count();
  for (int joint = 0; joint < joints; ++joint) {
    if (joint_map.measured(joint)) study.measured_joints.push_back(joint);
  }
  study.joint_count = joints;
  study.measured_joint_names = Selected(hand.joint_names, study.measured_joints);
  int cable = 0;
  for (int motor = 0; motor < std::ssize(study.hand->drives()); ++motor) {
    const bool counts = std::ranges::any_of(study.measured_joints, [&](int joint) {
      return hand.coupling[motor * joints + joint] != 0.0;
    });
    if (counts) study.measured_motors.push_back(motor);
    for (std::size_t i = 0; i < study.hand->drives()[motor].cables.size(); ++i, ++cable) {
      if (counts) study.measured_cables.push_back(cable);
    }
  }
  study.rows =
      ScoreRows(study.measured_joint_names, Selected(hand.motor_names, study.measured_motors),
                Selected(study.hand->cable_names(), study.measured_cables));
}

void Add(const Signal& signal, Hash& hash) {
  for (Eigen::Index c = 0; c < signal.cols(); ++c) {
    hash.Add(std::span(signal.col(c).data(), static_cast<std::size_t>(signal.rows())));
    TrimSignals();
  }
}

GloveFacts FactsOf(const GloveSignal& glove) {
  Hash motion;
  Add(glove.true_angle_rad, motion);
  Hash signal = motion;
  Add(glove.counts, signal);
  return {.signal_hash = signal.Text(),
          .motion_hash = motion.Text(),
          .ticks = glove.true_angle_rad.rows(),
          .is_recorded = glove.is_recorded};
}

std::shared_ptr<const GloveSignal> GloveOfSeed(const Study& study, int seed) {
  if (seed == study.scenario.seed) return study.first_glove;
  return std::make_shared<const GloveSignal>(
      SynthesiseGlove(GloveOf(study.scenario, seed), static_cast<std::uint64_t>(seed)));
}

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

Eigen::Index LongestTicks(const Study& study) {
  return std::ranges::max(study.repetitions, {}, &GloveFacts::ticks).ticks;
}

/// The trials of a study as tasks that threads take in the order of seeds.
class Schedule {
 public:
  Schedule(const Study& study, const StudyOptions& options)
      : study_(study),
        options_(options),
        gloves_(static_cast<std::size_t>(options.seeds)),
        controllers_(study.scenario.controllers.size()) {
    result_.row_names = study.rows.names;
    for (const NamedController& c : study.scenario.controllers) {
      result_.controller_names.push_back(c.name);
    }
    for (int i = 0; i < options.seeds; ++i) {
      result_.seeds.push_back({.seed = study.scenario.seed + i, .controllers = {}});
      result_.seeds.back().controllers.resize(controllers_);
      gloves_[static_cast<std::size_t>(i)].users_left = static_cast<int>(controllers_);
    }
    if (options.keep_first_traces) {
      result_.first_traces.resize(controllers_);
      result_.first_twins.resize(controllers_);
    }
    trials_in_all_ = TrialCount(study, options.seeds);
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
    const TwinSource twin_source = TwinOf(study_, seed.seed);
    std::call_once(glove.once, [&] {
      glove.signal = GloveOfSeed(study_, seed.seed);
      glove.reference_rad = ReferenceAngles(study_.joint_map(), glove.signal->true_angle_rad);
      if (twin_source == TwinSource::kTrial) glove.noise_free = NoiseFreeGlove(study_, seed.seed);
    });
    std::optional<NoiseFreeTwin> twin;
    if (glove.noise_free) twin = AsTwin(Run(controller_index, *glove.noise_free));
    Trace trace = Run(controller_index, *glove.signal);
    if (twin_source == TwinSource::kItself) twin = AsTwin(trace);
    outcome.health = trace.health;
    outcome.scores = trace.health.ok
                         ? Score(study_, *glove.signal, glove.reference_rad, trace, twin)
                         : NoScores(study_.rows);
    outcome.untrusted_samples = trace.untrusted_samples;
    if (options_.database != nullptr) {
      options_.database->Keep(seed.seed, controller_index, outcome);
    }
    const bool keep = seed_index == 0 && options_.keep_first_traces;
    if (keep) {
      result_.first_traces[controller_index] = std::move(trace);
      result_.first_twins[controller_index] = std::move(twin);
    }
    LeaveGlove(seed_index);
  }

  Trace Run(std::size_t controller_index, const GloveSignal& glove) {
    const Eigen::Index blocks = glove.true_angle_rad.rows() / TraceRecorder::kBlockTicks + 1;
    return RunTrial(SetupOf(study_, study_.scenario.controllers[controller_index]), glove,
                    [&] { return Progress(1.0 / static_cast<double>(blocks)); });
  }

  /// The last trial of a seed frees its signal, or hands out that of the first seed.
  void LeaveGlove(std::size_t seed_index) {
    SharedGlove& glove = gloves_[seed_index];
    if (--glove.users_left > 0) return;
    if (seed_index == 0) {
      result_.reference_name = glove.signal->reference_name;
      result_.first_glove = std::move(glove.signal);
      result_.first_reference_rad = std::move(glove.reference_rad);
    }
    glove.signal.reset();
    glove.noise_free.reset();
    glove.reference_rad = {};
  }

  /// Takes a trial from the database, if it is there. The first seed runs again: its signals are
  /// wanted, too.
  bool Recall(std::size_t seed_index, std::size_t controller_index, TrialOutcome& outcome) {
    if (options_.database == nullptr || seed_index == 0) return false;
    auto known = options_.database->Take(result_.seeds[seed_index].seed, controller_index);
    if (!known) return false;
    outcome = std::move(*known);
    LeaveGlove(seed_index);
    const TwinSource twin = TwinOf(study_, result_.seeds[seed_index].seed);
    Progress(twin == TwinSource::kTrial ? 2.0 : 1.0);
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
  StudyResult result_;
  std::atomic<std::size_t> next_task_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
  double trials_done_ = 0.0;
  int trials_in_all_ = 0;  // twins counted
};

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// The joint whose curves video and report begin with. A scenario for a full glove also serves a
/// smaller one: for a joint of the hand that it does not measure another stands in, with a remark.
/// Errors: SettingError for what is no joint of the hand.
void ChooseVideoChannel(Study& study, std::string& channel) {
  const std::vector<std::string>& measured = study.measured_joint_names;
  if (Has(measured, channel)) return;
  const std::string asked = channel;
  if (!asked.empty() && !Has(study.hand->joint_names(), asked)) {
    throw controller::SettingError(
        "video.channel", asked + " is not a joint of the hand" + Suggestion(asked, measured));
  }
  channel = Has(measured, "index_mcp") ? "index_mcp" : measured.front();
  if (asked.empty()) return;
  study.remarks.push_back("video.channel: " + asked + " is not measured by the glove; " + channel +
                          " is shown in its place");
}

/// What a study takes while it runs, its trace file and page included.
struct Needs {
  double disk_bytes = 0.0;
  double memory_bytes = 0.0;
};

Needs NeedsOf(const Study& study, const StudyOptions& options) {
  const auto channels = static_cast<double>(study.channel_names().size());
  const auto joints = static_cast<double>(study.joint_count);
  const auto motors = static_cast<double>(study.hand->motor_names().size());
  const auto cables = static_cast<double>(study.hand->cable_names().size());
  const auto controllers = static_cast<double>(study.scenario.controllers.size());
  const double others = options.seeds > 1 ? options.jobs : 0;  // trials beside the first seed's
  constexpr double kGripAndPose = 8.0;
  const bool twins = study.scenario.score.noise_free_twin;
  // Columns of numbers with a row per tick.
  const double glove = (twins ? 6.0 : 3.0) * channels + joints;
  const double twin = twins ? joints + 1.125 * motors : 0.0;
  const double trace =
      2.0 * channels + 2.0 * joints + 2.625 * motors + cables + kGripAndPose + twin;
  const double in_passing =
      9.0 * joints + 0.5 * motors;  // what the scores or the page make and forget
  const double kept = glove + controllers * trace;
  const double in_file = 0.5 * kept;
  const auto ticks = static_cast<double>(LongestTicks(study));
  // Of a long signal's transform there are the values, the result and the factors, all complex, and
  // beside it a few columns.
  constexpr double kComplexColumns = 5.0;
  constexpr double kRest = 400e6;
  return {.disk_bytes =
              ticks * sizeof(double) * (kept + in_file + others * (glove + trace) + in_passing),
          .memory_bytes = ticks * kComplexColumns * 2.0 * sizeof(double) + kRest};
}

/// Bytes of memory that are to be had; as many as one likes if the system does not say.
double AvailableMemory() {
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);) {
    double kilobytes = 0.0;
    if (std::sscanf(line.c_str(), "MemAvailable: %lf kB", &kilobytes) == 1) {
      return 1024.0 * kilobytes;
    }
  }
  return std::numeric_limits<double>::infinity();
}

/// Errors: RunError if a long study will not find the disk and the memory that it needs.
void CheckRoom(const Study& study, const StudyOptions& options) {
  const Needs needs = NeedsOf(study, options);
  if (needs.disk_bytes < static_cast<double>(GetSignalStorageLimits().all_on_heap_bytes)) return;
  const auto fail = [&](double needed, std::string_view where, double free) {
    throw RunError(fmt::format(
        "{:.6g} s of {} need about {:.1f} GB {}, {:.1f} GB are free: a shorter "
        "glove.motion.duration_s, a lower glove.rate_hz or fewer --controllers need less",
        static_cast<double>(LongestTicks(study)) / study.hand->timing().tick_rate_hz(),
        study.scenario.controllers.size() == 1
            ? "one controller"
            : fmt::format("{} controllers", study.scenario.controllers.size()),
        1e-9 * needed, where, 1e-9 * free));
  };
  const SignalSpace space = FreeSignalSpace();
  const auto free_disk = static_cast<double>(space.free_bytes);
  if (needs.disk_bytes > free_disk) {
    fail(needs.disk_bytes, fmt::format("on the disk of {}", space.folder.string()), free_disk);
  }
  const double free_memory = AvailableMemory();
  if (needs.memory_bytes > free_memory) fail(needs.memory_bytes, "of memory", free_memory);
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur == RLIM_INFINITY) return;
  const auto allowed = static_cast<double>(addresses.rlim_cur);
  const double needed = needs.disk_bytes + needs.memory_bytes;
  if (needed > allowed) fail(needed, "of addresses (ulimit -v)", allowed);
}

}  // namespace

controller::RobotConfig RobotOf(const Scenario& scenario, const HandModel& hand,
                                const controller::ControllerConfig& config) {
  return {.controller = config,
          .glove = NominalCalibration(scenario.glove),
          .hand = hand.transmission(),
          .joint_map = scenario.joint_map,
          .timing = hand.timing().controller};
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

TrialSetup SetupOf(const Study& study, const NamedController& named) {
  return {.controller_name = named.name,
          .controller = named.config,
          .calibration = study.calibration,
          .joint_map = study.scenario.joint_map,
          .hand = study.hand};
}

void ChooseVideoCamera(const HandModel& hand, std::string& camera) {
  const std::vector<std::string> cameras = hand.CameraNames();
  if (camera.empty() || Has(cameras, camera)) return;
  if (camera != VideoConfig{}.camera) {
    throw controller::SettingError(
        "video.camera", camera + " is not a camera of the hand" + Suggestion(camera, cameras));
  }
  camera.clear();  // the default: a model need not have it
}

Study PrepareStudy(Scenario scenario) {
  Study study;
  // A recording that cannot be read is found here, before anything is written.
  controller::WithinSetting("glove", [&] {
    const int count = std::max(1, static_cast<int>(scenario.repetitions.gloves.size()));
    for (int i = 0; i < count; ++i) {
      const int seed = scenario.seed + i;
      GloveSignal glove =
          SynthesiseGlove(GloveOf(scenario, seed), static_cast<std::uint64_t>(seed));
      study.repetitions.push_back(FactsOf(glove));
      for (const std::string& remark : glove.remarks) {  // the same of many is said once
        if (!Has(study.remarks, remark)) study.remarks.push_back(remark);
      }
      if (i == 0) study.first_glove = std::make_shared<const GloveSignal>(std::move(glove));
    }
  });
  study.hand = std::make_shared<const HandModel>(scenario.hand, TimingOf(scenario));
  study.calibration = NominalCalibration(scenario.glove);
  const Eigen::Index fewest_ticks =
      std::ranges::min(study.repetitions, {}, &GloveFacts::ticks).ticks;
  controller::WithinSetting(
      "score", [&] { scenario.score.Check(study.hand->timing().tick_rate_hz(), fewest_ticks); });
  controller::WithinSetting("joint_map", [&] {
    study.scenario.joint_map = scenario.joint_map;
    FindMeasuredParts(study);
  });
  if (study.measured_joints.empty()) {
    throw controller::SettingError("joint_map",
                                   "moves no joint of the hand: none of its joints is called like "
                                   "a channel of the glove");
  }
  for (const NamedController& named : scenario.controllers) {
    controller::WithinSetting("controllers." + named.name, [&] {
      return controller::Controller(RobotOf(scenario, *study.hand, named.config));
    });
  }
  ChooseVideoChannel(study, scenario.video.channel);
  ChooseVideoCamera(*study.hand, scenario.video.camera);
  study.scenario = std::move(scenario);
  return study;
}

StudyResult RunStudy(const Study& study, const StudyOptions& asked) {
  StudyOptions options = asked;
  const Repeats repeats(study, asked.seeds);
  if (repeats.alike()) options.seeds = static_cast<int>(study.repetitions.size());
  CheckRoom(study, options);
  Schedule schedule(study, options);
  const std::size_t threads = std::min<std::size_t>(
      static_cast<std::size_t>(std::max(1, options.jobs)), schedule.TaskCount());
  std::vector<std::jthread> others;
  try {
    while (others.size() + 1 < threads) others.emplace_back([&schedule] { schedule.Work(); });
  } catch (const std::system_error& error) {  // those that there are take all the trials
    if (options.remark) {
      options.remark(fmt::format("only {} of {} threads can be started: {}", others.size() + 1,
                                 threads, error.code().message()));
    }
  }
  schedule.Work();
  others.clear();
  StudyResult result = schedule.Finish();
  result.seeds_alike = repeats.alike();
  NumberMotions(repeats, result);
  FindDurations(study, result);
  return result;
}

}  // namespace gauntlet::sim
