#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/json.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/output_folder.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/commands.h"
#include "sim/cli/interrupt.h"
#include "sim/cli/live_files.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/live/live_report.h"
#include "sim/live/live_session.h"
#include "sim/live/server/live_server.h"
#include "sim/live/session_recording.h"
#include "sim/settings/yaml_reader.h"
#include "sim/show/pages/pages.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/trial/external/external_filters.h"

namespace gauntlet::sim {
namespace {

constexpr std::string_view kSimulated = "simulated";
constexpr std::string_view kLoopback = "127.0.0.1";
constexpr int kNoPage = -1;

std::string ProblemOfIpv4(std::string& address) {
  return IsIpv4(address) ? "" : "must be an IPv4 address, as 127.0.0.1 or 0.0.0.0";
}

struct LiveCommand {
  static constexpr auto kName = "live";
  static constexpr auto kPurpose = "Run a controller live, from a glove to motors";
  static constexpr auto kGroup = Group::kEveryday;
  std::string scenario_file;
  std::string controller;
  std::string glove{kSimulated};
  std::string motors{kSimulated};
  std::string map;
  double rate_hz = 0.0;   // of a file without a time; 0: not given
  std::string array;      // of a file
  std::string time_unit;  // of a file's column of time; empty: found
  std::string unit;       // of columns whose names have none
  double seconds = 0.0;
  std::vector<std::string> shadows;
  std::string record;
  int page = kNoPage;
  std::string listen{kLoopback};
  std::string out;
  std::vector<std::string> overrides;
  bool allow_programs = false;
  bool json = false;
  TerminalOptions terminal;

  Options Rows() {
    return {
        ScenarioArgument(scenario_file),
        Option("--controller", &controller,
               {.value = "NAME", .offer = Offer::kControllers, .required = true},
               "which controller of the scenario"),
        Option("--glove", &glove, {.value = "SOURCE", .shows_default = true},
               "simulated (the scenario's glove), stdin, file:PATH, udp:HOST:PORT, osc:PORT or "
               "serial:DEVICE"),
        Option("--motors", &motors, {.value = "SINK", .shows_default = true},
               "simulated (the hand alone), stdout, none, udp:HOST:PORT, osc:HOST:PORT or "
               "serial:DEVICE"),
        Option("--map", &map, {.value = "MAP.csv", .offer = Offer::kFiles},
               "column map of the glove's frames, or the name of a preset"),
        Option("--seconds", &seconds, {.range = {0.1, 36000.0}},
               "length of the session [until the source ends, or Ctrl-C]"),
        Option("--shadow", &shadows,
               {.value = "NAME,..", .offer = Offer::kControllers, .separator = ','},
               "further controllers that get the same samples and drive nothing"),
        Option("--record", &record,
               {.value = "FILE.csv", .offer = Offer::kFiles, .check = ProblemOfPath},
               "file for the glove's samples, as a recording that every command takes "
               "[recording.csv in the output folder]"),
        Option("--page", &page, {.value = "PORT", .range = {0, 65535}},
               "show the running session to a browser on this computer; 0 takes any free port"),
        Option("--listen", &listen,
               {.value = "ADDRESS",
                .shows_default = true,
                .needs = {"--page"},
                .check = ProblemOfIpv4},
               "IPv4 address of the page; another one admits browsers on other computers"),
        OutOption(out, "output folder [out/<scenario>_live]"),
        AllowProgramsOption(allow_programs),
        SetOption(overrides, "change a value of the scenario; may be repeated"),
        Option("--json", &json, {}, "print live.json instead of the report"),
        terminal.Rows(),
        Option("--rate", &rate_hz, {.value = "HZ", .range = {0.01, 100000.0}},
               "with file:PATH: rows per second [by its column of time]"),
        ArrayOptions(array),
        UnitOption(unit, {"deg", "rad", "counts", "share"},
                   "unit of columns with the name of a channel alone, as index_mcp [deg]",
                   {"--map"}),
        TimeUnitOption(time_unit, {"--rate"}),
    };
  }

  static constexpr auto kNotes = R"(
The loop is that of gauntlet run, in real time: link.glove says what its receiver and its
watchdog do with frames that come late, repeated, in another order or not at all. Where the
scenario sets no link.glove, the newest frame counts, and the watchdog holds after 50 ms,
relaxes after 200 ms and stops sending after 1 s.

Values of a frame are channels by their names (index_mcp_deg, index_mcp_counts), by --map, or
in their order where there are as many as channels. Real motors start, end and return from a
gap at a limited speed. Ctrl-C brings them to rest and ends the session; a second one ends it
at once.

Example:
  gauntlet live door_opening --controller tuned_kalman --seconds 5

  gauntlet live door_opening --controller raw --glove udp:127.0.0.1:9000 \
    --motors udp:127.0.0.1:9001 --shadow tuned_kalman,one_euro
)";
};

/// The device of an option, or nothing for `simulated`.
std::optional<DeviceAddress> AddressOf(const std::string& option, const std::string& text,
                                       DeviceRole role) {
  if (text == kSimulated) return std::nullopt;
  try {
    return ParseDeviceAddress(text, role);
  } catch (const UserError& error) {
    throw UserError({.place = option + " " + error.place(), .problem = error.problem()});
  }
}

/// Only the controllers that take part, the first of them drives.
std::vector<std::string> ControllersOf(const LiveCommand& command, const Scenario& scenario) {
  std::vector<std::string> names = {FindController(scenario, command.controller).name};
  for (const std::string& shadow : command.shadows) {
    if (shadow == command.controller) {
      throw UserError({.place = "--shadow " + shadow, .problem = "drives the motors already"});
    }
    names.push_back(shadow);
  }
  return names;
}

/// Leaves out the scenario's simulated link of a real glove; a watchdog is always there.
void UseRealLink(LinksConfig& links) {
  if (!links.glove) {
    links.glove.emplace();
    links.glove->watchdog.settings = TieredWatchdog{};
  }
  links.glove->transport = {};
}

void CheckMotors(const LiveCommand& command, const Scenario& scenario) {
  if (scenario.hand.joint_sensors.kind == JointSensorsKind::kNone) return;
  throw UserError({.place = "--motors " + command.motors,
                   .key = "hand.joint_sensors",
                   .problem = "must be none: the joint angles of real motors are not measured"});
}

void SayHow(const LiveSetup& setup, const LinksConfig& wanted) {
  if (!setup.simulated_glove && wanted.glove) {
    Say("gauntlet: the glove's link is real: of link.glove only receiver and watchdog are used\n");
  }
  if (setup.sink != nullptr) {
    Say("gauntlet: motors start from their rest positions at a limited speed; Ctrl-C brings them "
        "back there\n");
  }
}

std::vector<std::string> ControllerNames(const LiveSetup& setup) {
  std::vector<std::string> names = {setup.trial.controller_name};
  for (const ShadowSetup& shadow : setup.shadows) names.push_back(shadow.name);
  return names;
}

/// The page of a session; nothing without --page.
std::unique_ptr<LiveServer> ServePage(const LiveCommand& command, const Study& study,
                                      const LiveSetup& setup, const std::string& recording) {
  if (command.page == kNoPage) return nullptr;
  LiveServerConfig config{.address = command.listen,
                          .port = command.page,
                          .nonce = RandomToken(),
                          .controllers = ControllerNames(setup),
                          .say = setup.say};
  config.page = LivePage(study, setup, recording, config.nonce);
  auto server = std::make_unique<LiveServer>(std::move(config), *setup.view);
  Say("gauntlet: page at {}\n", server->Address());
  if (!command.listen.starts_with("127.")) {
    Say("gauntlet: the page is not encrypted: the network can read its address, and who has the "
        "address can switch controllers\n");
  }
  return server;
}

LiveContext ContextOf(const LiveCommand& command, const Study& study, const LiveSetup& setup) {
  LiveContext context{
      .scenario = study.scenario.name,
      .controller = command.controller,
      .controllers = ControllerNames(setup),
      .glove = setup.source == nullptr ? std::string(kSimulated) : setup.source->Description(),
      .motors = setup.sink == nullptr ? std::string(kSimulated) : setup.sink->Description(),
      .has_real_glove = setup.source != nullptr,
      .has_motors = setup.sink != nullptr,
      .timing = study.hand->timing().controller,
      .event_delay_ms = study.scenario.event.delay_ms,
      .receiver = {}};
  if (setup.trial.links.config.glove) {
    context.receiver = controller::KindName(setup.trial.links.config.glove->receiver.settings);
  }
  return context;
}

/// How a session that ended otherwise than asked ends the program.
void ThrowIfFailed(const LiveFacts& facts, const HandHealth& health) {
  if (facts.end == LiveEnd::kSinkGone) {
    throw RunError("the reader of the motor commands is gone");
  }
  if (facts.end == LiveEnd::kHandStopped) {
    throw RunError("the simulated hand stopped: " + health.problem);
  }
}

/// Writes the results of a session: all of them, or where that fails its measurements alone.
/// Returns the failure. Its samples are on the disk already.
std::exception_ptr WriteResults(OutputFiles& files, const std::string& json,
                                const std::filesystem::path& counts,
                                const std::optional<FinishedStudy>& finished) {
  std::exception_ptr failure;
  for (const bool has_all : {true, false}) {
    try {
      files.Write([&](const std::filesystem::path& place) {
        WriteOutputFile(place / "live.json", json);
        if (!counts.empty()) std::filesystem::copy_file(counts, place / "counts.csv");
        if (finished && has_all) WriteSession(place, *finished);
      });
      files.Commit();
      return failure;
    } catch (const RunError&) {
      if (!failure) failure = std::current_exception();
    } catch (const std::filesystem::filesystem_error& error) {
      if (!failure) {
        failure = std::make_exception_ptr(
            RunError(fmt::format("{}: cannot write: {}", counts.string(), error.code().message())));
      }
    }
  }
  return failure;
}

void RunLiveCommand(const LiveCommand& command) {
  if (command.allow_programs) AllowPrograms();
  const ScenarioSource source{.file = command.scenario_file,
                              .text = ReadYamlText(command.scenario_file),
                              .overrides = command.overrides};
  Scenario scenario = ParseScenario(source);
  KeepControllers(ControllersOf(command, scenario), scenario);
  for (const NamedController& named : scenario.controllers) {
    if (!HasSlowPrograms(named.config)) continue;
    throw UserError(
        {.place = "--controller " + named.name,
         .key = "filter",
         .problem = "is a program or its answers (kind external), which has no place in real time; "
                    "must be a filter of Gauntlet or a library"});
  }
  const auto glove_address = AddressOf("--glove", command.glove, DeviceRole::kSource);
  const auto motors_address = AddressOf("--motors", command.motors, DeviceRole::kSink);
  if (!command.map.empty() && !glove_address) {
    throw UserError({.place = "--map " + command.map,
                     .problem = "needs a real glove: --glove udp:HOST:PORT or another"});
  }
  const bool is_file = glove_address && glove_address->kind == DeviceKind::kFile;
  if (!glove_address && !command.unit.empty()) {
    throw UserError({.place = "--unit " + command.unit,
                     .problem = "needs a real glove: --glove udp:HOST:PORT or another"});
  }
  if (!is_file && (command.rate_hz > 0.0 || !command.array.empty() || !command.time_unit.empty())) {
    throw UserError({.place = !command.array.empty()      ? "--topic " + Shown(command.array)
                              : command.time_unit.empty() ? "--rate"
                                                          : "--time-unit " + command.time_unit,
                     .problem = "needs a file as glove: --glove file:PATH"});
  }
  const bool drives_motors = motors_address && motors_address->kind != DeviceKind::kNone;
  if (drives_motors) CheckMotors(command, scenario);
  const std::string out = command.out.empty() ? "out/" + scenario.name + "_live" : command.out;
  SetSignalFolder(out);
  const Study study = PrepareStudy(source, std::move(scenario));
  LiveSetup setup{.trial = SetupOf(study, study.scenario.controllers.front(), study.scenario.seed)};
  std::vector<TrialPrograms> libraries;  // of each controller
  libraries.emplace_back(setup.trial.controller);
  setup.trial.controller = libraries.back().config();
  const LinksConfig wanted = setup.trial.links.config;
  for (std::size_t i = 1; i < study.scenario.controllers.size(); ++i) {
    const NamedController& shadow = study.scenario.controllers[i];
    libraries.emplace_back(SetupOf(study, shadow, study.scenario.seed).controller);
    setup.shadows.push_back({shadow.name, libraries.back().config()});
  }
  std::unique_ptr<FrameSource> glove;
  std::unique_ptr<FrameSink> motors;
  if (glove_address) {
    glove = OpenFrameSource(*glove_address, {.file_rate_hz = command.rate_hz,
                                             .file_array = command.array,
                                             .file_time_unit = command.time_unit});
    setup.source = glove.get();
    setup.names_may_follow =
        glove_address->kind == DeviceKind::kUdp || glove_address->kind == DeviceKind::kSerial;
    UseRealLink(setup.trial.links.config);
  } else {
    setup.simulated_glove = study.gloves.front();
  }
  if (drives_motors) {
    motors = OpenFrameSink(*motors_address, study.hand->transmission().motor_names);
    setup.sink = motors.get();
    setup.sink_comes_back = motors_address->kind != DeviceKind::kStdout;
  }
  setup.channels = {.glove = study.calibration,
                    .source = "--glove " + command.glove,
                    .map = command.map,
                    .unit = command.unit,
                    .drives_motors = drives_motors};
  setup.seconds = command.seconds;
  const double motion_s = static_cast<double>(study.gloves.front()->true_angle_rad.rows()) /
                          study.hand->timing().tick_rate_hz();
  setup.trace_s = TraceLength_s(command.seconds, glove_address ? 0.0 : motion_s);
  setup.say = [](const std::string& line) { Say("gauntlet: {}\n", line); };
  OutputFolder folder(out);
  OutputFiles files({.folder = folder.path(),
                     .command = "live",
                     .results = {"live.json", "counts.csv", "report.html", "scores.json",
                                 "scores.csv", "trace.h5", "scenario.resolved.yaml"}});
  const std::filesystem::path recording = command.record.empty()
                                              ? folder.path() / "recording.csv"
                                              : std::filesystem::path(command.record);
  const bool has_recording = glove_address || !command.record.empty();
  LiveView view(study.calibration.channel_names.size(), study.hand->joint_names().size(),
                1 + setup.shadows.size(), study.hand->timing().tick_rate_hz());
  if (command.page != kNoPage) setup.view = &view;
  // Only who watches may mark the hand still, and only then the counts are asked for.
  const RecordingPlaces places{.angles = has_recording ? recording : std::filesystem::path(),
                               .counts = command.page != kNoPage
                                             ? folder.path() / "counts.unfinished.csv"
                                             : std::filesystem::path()};
  std::optional<SessionRecording> samples;
  if (has_recording || command.page != kNoPage) {
    samples.emplace(study.calibration, 1.0 / study.scenario.glove.rate_hz, places);
  }
  if (samples) setup.recording = &*samples;
  SayHow(setup, wanted);
  LiveResult result;
  {
    const EndsAtSecondSignal gently;
    const auto server = ServePage(command, study, setup, has_recording ? recording.string() : "");
    std::optional<SessionScores> scores;
    if (server) scores.emplace(RunningScoringOf(study, setup), view);
    result = RunLive(setup);
  }
  if (!result.columns_remark.empty()) Say("gauntlet: {}\n", result.columns_remark);
  LiveContext context = ContextOf(command, study, setup);
  context.counts_file = (folder.path() / "counts.csv").string();
  context.converters = controller::ConvertersOf(study.calibration);
  const bool has_counts = !result.facts.still.empty();
  const LiveRecord record{.setup = &setup, .study = &study, .source = &source};
  LiveOutcome outcome = ScoreSession(record, recording, folder.path(), result);
  if (!outcome.remark.empty()) Say("gauntlet: {}\n", outcome.remark);
  const std::string json = LiveJson(result.facts, context, outcome.shadows).dump(1) + "\n";
  const std::exception_ptr failure = WriteResults(
      files, json, has_counts ? places.counts : std::filesystem::path(), outcome.finished);
  if (!failure) folder.Keep();
  if (!failure && !places.counts.empty()) std::filesystem::remove(places.counts);
  ResultText text = LiveText(result.facts, context);
  if (!outcome.shadows.empty()) {
    for (auto& part : ShadowText(outcome.shadows, outcome.finished->result.reference_name)) {
      text.push_back(std::move(part));
    }
  }
  // Standard output may be that of the motors.
  const std::string report = command.json ? json : TextOf(text, StyleOf(command.terminal));
  if (motors_address && motors_address->kind == DeviceKind::kStdout) {
    SayText(report);
  } else {
    PrintText(report);
    FlushOutput();
  }
  if (failure) {
    if (!result.recorded.problem.empty()) Say("gauntlet: {}\n", result.recorded.problem);
    std::rethrow_exception(failure);
  }
  Say("wrote {}: live.json{}{}{}\n", folder.path().string(), has_counts ? ", counts.csv" : "",
      outcome.finished ? ", report.html, scores.json, scores.csv, trace.h5, scenario.resolved.yaml"
                       : "",
      has_recording ? "; " + recording.string() : "");
  if (!result.recorded.problem.empty()) throw RunError(result.recorded.problem);
  ThrowIfFailed(result.facts, result.trace.health);
  for (std::size_t i = 0; i < libraries.size(); ++i) {
    if (libraries[i].ok()) continue;
    throw RunError(fmt::format("{}: {}; from there on it passed its samples unfiltered",
                               context.controllers[i], libraries[i].problem()));
  }
}

}  // namespace

Command MakeLiveCommand() { return MakeCommand(RunLiveCommand); }

}  // namespace gauntlet::sim
