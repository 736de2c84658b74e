
#include <memory>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/stop.h"
#include "sim/cli/commands.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/live/device/frame_sink.h"
#include "sim/live/glove_player.h"
#include "sim/settings/yaml_reader.h"
#include "sim/study/scenario/scenario_reader.h"

namespace gauntlet::sim {
namespace {

struct GloveCommand {
  static constexpr auto kName = "glove";
  static constexpr auto kPurpose = "Send a scenario's glove in real time, as a device";
  static constexpr auto kGroup = Group::kOther;
  std::string scenario_file;
  std::string to;
  std::string format;
  double seconds = 0.0;
  std::vector<std::string> overrides;

  Options Rows() {
    return {
        ScenarioArgument(scenario_file),
        Option("--to", &to, {.value = "SINK", .required = true},
               "udp:HOST:PORT, osc:HOST:PORT, serial:DEVICE or stdout"),
        Option("--format", &format, {.words = {"csv", "labels", "json", "binary"}},
               "form of the frames, as of docs/reference/live-formats.md [csv]"),
        Option("--seconds", &seconds, {.range = {0.1, 36000.0}},
               "how long; the motion repeats [once]"),
        SetOption(overrides, "change a value of the scenario; may be repeated"),
    };
  }

  static constexpr auto kNotes = R"(
Frames leave at glove.rate_hz with their number, the time of their capture and the counts of
every channel. Where the scenario sets link.glove, they are delayed, lost, repeated and
reordered as that says.

Example:
  gauntlet glove door_opening --to udp:127.0.0.1:9000
  gauntlet glove wireless_glove --to udp:127.0.0.1:9000,binary --seconds 60
)";
};

void RunGlove(const GloveCommand& command) {
  const ScenarioSource source{.file = command.scenario_file,
                              .text = ReadYamlText(command.scenario_file),
                              .overrides = command.overrides};
  const Scenario scenario = ParseScenario(source);
  DeviceAddress address = ParseDeviceAddress(command.to, DeviceRole::kSink);
  if (!command.format.empty()) address.format = ParseFrameFormat(command.format);
  GlovePlay play;
  play.glove = std::make_shared<const GloveSignal>(controller::WithinSetting("glove", [&] {
    return SynthesiseGlove(GloveOf(scenario, scenario.seed),
                           static_cast<std::uint64_t>(scenario.seed));
  }));
  if (scenario.link) play.link = scenario.link->glove;
  play.timing = TimingOf(scenario).controller;
  play.seed = static_cast<std::uint64_t>(scenario.seed);
  play.seconds = command.seconds;
  std::vector<std::string> names;
  for (const std::string& channel : play.glove->channel_names) names.push_back(channel + "_counts");
  const std::unique_ptr<FrameSink> sink = OpenFrameSink(address, names, true);
  Say("gauntlet: {} samples per second, {} channels, to {}\n", play.timing.sample_rate_hz(),
      names.size(), sink->Description());
  const GlovePlayed played = PlayGlove(play, *sink);
  Say("gauntlet: {:.1f} s: {} samples; lost on the simulated link {}; without a receiver {}; "
      "without room {}; sent late by {:.3f} ms (p99), {:.3f} (max)\n",
      played.duration_s, played.samples, played.lost, played.failed, played.dropped,
      1e-3 * played.lateness.Quantile_us(0.99), 1e-3 * played.lateness.max_us());
  ThrowIfStopped();
}

}  // namespace

Command MakeGloveCommand() { return MakeCommand(RunGlove); }

}  // namespace gauntlet::sim
