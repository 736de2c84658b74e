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
  Signal reference_rad;  // ticks x joints of the hand
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

Scores Score(const Study& study, const GloveSignal& glove, const Signal& reference_rad,
             const Trace& trace) {
  const Columns reference(reference_rad, study.measured_joints);
  const Columns hand(trace.hand_angle_rad, study.measured_joints);
  const Columns command(trace.command_counts, study.measured_motors);
  const Columns speed(trace.spool_speed_rad_s, study.measured_motors);
  const Columns tension(trace.tension_n, study.measured_cables);
  std::vector<double> saturation_share;
  for (const int motor : study.measured_motors) {
    saturation_share.push_back(trace.saturation_share[motor]);
  }
  const std::vector<double> stall_tension_n = StallTensions(study);
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

std::string HashOf(const GloveSignal& glove) {
  Hash hash;
  for (const Signal* signal : {&glove.counts, &glove.true_angle_rad}) {
    for (Eigen::Index c = 0; c < signal->cols(); ++c) {
      hash.Add(std::span(signal->col(c).data(), static_cast<std::size_t>(signal->rows())));
      TrimSignals();
    }
  }
  return hash.Text();
}

std::shared_ptr<const GloveSignal> GloveOfSeed(const Study& study, int seed) {
  if (seed == study.scenario.seed) return study.first_glove;
  return std::make_shared<const GloveSignal>(
      SynthesiseGlove(study.scenario.glove, static_cast<std::uint64_t>(seed)));
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
      glove.signal = GloveOfSeed(study_, seed.seed);
      glove.reference_rad = JointAngles(study_.joint_map(), glove.signal->true_angle_rad);
    });
    const NamedController& named = study_.scenario.controllers[controller_index];
    const Eigen::Index block_count =
        glove.signal->true_angle_rad.rows() / TraceRecorder::kBlockTicks + 1;
    const auto blocks = static_cast<double>(block_count);
    Trace trace =
        RunTrial(SetupOf(study_, named), *glove.signal, [&] { return Progress(1.0 / blocks); });
    outcome.scores = Score(study_, *glove.signal, glove.reference_rad, trace);
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
      result_.reference_name = glove.signal->reference_name;
      result_.first_glove = std::move(glove.signal);
      result_.first_reference_rad = std::move(glove.reference_rad);
    }
    glove.signal.reset();
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
  StudyResult result_;
  std::atomic<std::size_t> next_task_{0};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;
  std::exception_ptr error_;
  double trials_done_ = 0.0;
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
  // Columns of numbers with a row per tick.
  const double glove = 3.0 * channels + joints;
  const double trace = 2.0 * channels + 2.0 * joints + 2.5 * motors + cables + kGripAndPose;
  const double in_passing = 9.0 * joints;  // what the scores or the page make and forget
  const double kept = glove + controllers * trace;
  const double in_file = 0.5 * kept;
  const auto ticks = static_cast<double>(study.ticks);
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
        static_cast<double>(study.ticks) / study.hand->timing().tick_rate_hz(),
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
  GloveSignal glove = controller::WithinSetting("glove", [&scenario] {
    return SynthesiseGlove(scenario.glove, static_cast<std::uint64_t>(scenario.seed));
  });
  study.hand = std::make_shared<const HandModel>(scenario.hand, TimingOf(scenario));
  study.calibration = NominalCalibration(scenario.glove);
  study.glove_hash = HashOf(glove);
  study.ticks = glove.true_angle_rad.rows();
  controller::WithinSetting(
      "score", [&] { scenario.score.Check(study.hand->timing().tick_rate_hz(), study.ticks); });
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
  study.remarks = glove.remarks;
  ChooseVideoChannel(study, scenario.video.channel);
  ChooseVideoCamera(*study.hand, scenario.video.camera);
  study.scenario = std::move(scenario);
  study.first_glove = std::make_shared<const GloveSignal>(std::move(glove));
  return study;
}

StudyResult RunStudy(const Study& study, const StudyOptions& asked) {
  StudyOptions options = asked;
  const bool alike =
      asked.seeds > 1 && HashOf(*GloveOfSeed(study, study.scenario.seed + 1)) == study.glove_hash;
  if (alike) options.seeds = 1;
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
  result.seeds_alike = alike;
  return result;
}

}  // namespace gauntlet::sim
