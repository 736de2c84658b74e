#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/commands.h"
#include "sim/cli/controllers_option.h"
#include "sim/cli/jobs_option.h"
#include "sim/cli/out_option.h"
#include "sim/cli/output_folder.h"
#include "sim/cli/progress.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/cli/usage_error.h"
#include "sim/video/render_folder.h"

namespace gauntlet::sim {
namespace {

constexpr double kLongest_s = 1e6;  // of a recording

struct RenderChoices {
  std::string folder;
  std::string out;
  std::vector<std::string> controllers;
  std::vector<std::string> overlay;
  std::string channel;
  std::string camera;
  std::string size;
  std::string frames_per_s;
  std::string look{kGoodLook.name};
  std::string quality = "good";
  Excerpt excerpt;
  std::optional<double> frame_s;
};

/// An option that takes the place of a setting of the scenario.
struct Replacement {
  std::string option;  // as it was given: --camera arm
  std::string setting;
  std::string value;
};

std::vector<Replacement> ReplacementsOf(const RenderChoices& options) {
  std::vector<Replacement> replacements;
  const auto add = [&](const char* option, const std::string& text, const char* setting,
                       const std::string& value) {
    if (!text.empty()) replacements.push_back({option + (" " + text), setting, value});
  };
  add("--channel", options.channel, "video.channel", options.channel);
  add("--camera", options.camera, "video.camera", options.camera);
  add("--fps", options.frames_per_s, "video.frames_per_s", options.frames_per_s);
  const std::size_t by = options.size.find('x');
  if (!options.size.empty() && by == std::string::npos) {
    throw UserError({.place = "--size " + options.size,
                     .problem = "must be width x height in pixels, as 1280x720"});
  }
  add("--size", options.size, "video.width_px", options.size.substr(0, by));
  if (by != std::string::npos) {
    add("--size", options.size, "video.height_px", options.size.substr(by + 1));
  }
  return replacements;
}

/// The encoders' constant rate factor.
int RateFactorOf(const std::string& quality) {
  if (quality == "small") return 28;
  if (quality == "good") return VideoFormat{}.rate_factor;
  if (quality == "best") return 14;
  throw UserError(
      {.place = "--quality " + quality, .problem = "must be one of small, good and best"});
}

const Look& LookNamed(const std::string& name) {
  const auto look = std::ranges::find(kLooks, name, &Look::name);
  if (look != kLooks.end()) return *look;
  throw UserError({.place = "--look " + name, .problem = "must be one of fast, good and best"});
}

/// Errors: UserError for an overlay of other than two controllers, or with others.
void CheckOverlay(const RenderChoices& options) {
  const std::vector<std::string>& names = options.overlay;
  if (names.empty()) return;
  const auto fail = [&names](const char* problem) {
    throw UserError(
        {.place = fmt::format("--overlay {}", fmt::join(names, ",")), .problem = problem});
  };
  if (names.size() != 2) fail("must be two controllers, as raw,tuned_kalman");
  if (names[0] == names[1]) fail("must be two controllers, not one twice");
  if (!options.controllers.empty()) fail("says which controllers: leave --controllers out");
}

RenderOptions CheckedOptions(const RenderChoices& options) {
  CheckOverlay(options);
  const Excerpt& excerpt = options.excerpt;
  if (!(excerpt.from_s < excerpt.to_s)) {
    throw UserError({.place = fmt::format("--from {:g} --to {:g}", excerpt.from_s, excerpt.to_s),
                     .problem = "--from must come before --to"});
  }
  const bool picture = options.frame_s.has_value();
  const std::string ending = std::filesystem::path(options.out).extension();
  const bool fits =
      picture ? ending == ".png" : ending == ".mp4" || ending == ".webm" || ending == ".gif";
  if (!options.out.empty() && !fits) {
    throw UserError({.place = "--out " + options.out,
                     .problem = picture
                                    ? "must end in .png with --frame"
                                    : "must end in .mp4, .webm or .gif, or in .png with --frame"});
  }
  return {.folder = options.folder,
          .controllers = options.overlay.empty() ? options.controllers : options.overlay,
          .overlay = !options.overlay.empty(),
          .overrides = {},
          .excerpt = excerpt,
          .look = LookNamed(options.look),
          .rate_factor = RateFactorOf(options.quality),
          .frame_s = options.frame_s,
          .target = options.out,
          .jobs = JobsOrCores(0)};
}

/// RenderFolder(); a mistake in a setting that an option replaced is one of the option.
std::filesystem::path Render(const RenderChoices& given,
                             const std::function<bool(int, int)>& go_on) {
  RenderOptions options = CheckedOptions(given);
  const std::vector<Replacement> replacements = ReplacementsOf(given);
  for (const Replacement& replacement : replacements) {
    options.overrides.push_back(replacement.setting + "=" + replacement.value);
  }
  try {
    return RenderFolder(options, go_on);
  } catch (const UserError& error) {
    for (const Replacement& replacement : replacements) {
      if (error.key() != replacement.setting) continue;
      throw UserError({.place = replacement.option, .problem = error.problem()});
    }
    if (error.place() == "--controllers" && options.overlay) {
      throw UserError({.place = "--overlay", .key = error.key(), .problem = error.problem()});
    }
    throw;
  }
}

}  // namespace

void AddRenderCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("render", "Draw the comparison video of a finished run or comparison");
  const auto options = std::make_shared<RenderChoices>();
  command->add_option("folder", options->folder, "output folder of run or compare")->required();
  AddControllersOption(*command, options->controllers);
  command
      ->add_option("--overlay", options->overlay,
                   "two controllers in one picture, the second hand translucent behind the first")
      ->type_name("A,B")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--channel", options->channel, "joint whose curves are drawn")
      ->type_name("JOINT");
  command
      ->add_option(
          "--camera", options->camera,
          "hand, fingers, close_up (the finger of the channel), arm or another camera of the "
          "model")
      ->type_name("NAME");
  command->add_option("--from", options->excerpt.from_s, "begin here [0]")
      ->type_name("S")
      ->transform(Number(0.0, kLongest_s));
  command->add_option("--to", options->excerpt.to_s, "end here [the end]")
      ->type_name("S")
      ->transform(Number(0.0, kLongest_s));
  command->add_option("--speed", options->excerpt.speed, "0.25: four times slower [1]")
      ->type_name("FACTOR")
      ->transform(Number(0.01, 100.0));
  command->add_option("--size", options->size, "width and height in pixels, even")
      ->type_name("WIDTHxHEIGHT");
  command->add_option("--fps", options->frames_per_s, "frames per second")->type_name("N");
  command->add_option("--look", options->look, "how finely hands are drawn, and how fast [good]")
      ->type_name("{fast,good,best}");
  command->add_option("--quality", options->quality, "of the encoding [good]")
      ->type_name("{small,good,best}");
  command->add_option("--frame", options->frame_s, "no video, but the frame at this moment")
      ->type_name("S")
      ->transform(Number(0.0, kLongest_s));
  AddOutOption(
      *command, options->out,
      "file .mp4, .webm, .gif, or .png with --frame [comparison.mp4 or comparison.png in the "
      "folder]",
      "FILE");
  command->footer(
      "\nExamples:\n"
      "  gauntlet render out/door_opening --controllers raw,tuned_kalman\n"
      "  gauntlet render out/door_opening --overlay raw,tuned_kalman --speed 0.5\n"
      "  gauntlet render out/door_opening --from 2 --to 3 --speed 0.25 --out slow.webm\n"
      "  gauntlet render out/door_opening --size 640x360 --fps 20 --out door.gif\n"
      "  gauntlet render out/door_opening --frame 2.6 --size 1920x1080 --out door.png\n");
  command->callback([options] {
    WarnIfUnchecked(options->folder, Manifest(options->folder).exists());
    // No run may exchange the files while they are drawn.
    std::optional<OutputFolder> locked;
    if (options->out.empty()) locked.emplace(options->folder);
    SetSignalFolder(options->folder);
    Progress progress("video");
    const auto file =
        Render(*options, [&progress](int done, int total) { return progress.Update(done, total); });
    Say("wrote {}\n", file.string());
  });
}

}  // namespace gauntlet::sim
