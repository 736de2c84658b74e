#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_folder.h"
#include "sim/base/signal_storage.h"
#include "sim/base/threads.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/show/video/render_folder.h"

namespace gauntlet::sim {
namespace {

constexpr Range kMomentRange = {0.0, 1e6};  // of a recording [s]

struct RenderChoices {
  static constexpr auto kName = "render";
  static constexpr auto kPurpose = "Draw the comparison video of a run or comparison";
  static constexpr auto kGroup = Group::kEveryday;
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

  Options Rows() {
    return {
        Argument("folder", &folder, Offer::kFolders, "output folder of run or compare"),
        ControllersOption(controllers),
        Option(
            "--overlay", &overlay,
            {.value = "A,B", .offer = Offer::kControllers, .separator = ',', .is_one_word = true},
            "two controllers in one picture, the second hand translucent behind the first"),
        Option("--channel", &channel, {.value = "JOINT", .offer = Offer::kChannels},
               "joint whose curves are drawn"),
        Option("--camera", &camera, {.value = "NAME"},
               "hand, fingers, close_up (the finger of the channel), arm or another camera of the "
               "model"),
        Option("--from", &excerpt.from_s, {.value = "S", .range = kMomentRange}, "begin here [0]"),
        Option("--to", &excerpt.to_s, {.value = "S", .range = kMomentRange}, "end here [the end]"),
        Option("--speed", &excerpt.speed, {.value = "FACTOR", .range = {0.01, 100.0}},
               "0.25: four times slower [1]"),
        Option("--size", &size, {.value = "WIDTHxHEIGHT"}, "width and height in pixels, even"),
        Option("--fps", &frames_per_s, {.value = "N"}, "frames per second"),
        Option("--look", &look, {.words = {"fast", "good", "best"}},
               "how finely hands are drawn, and how fast [good]"),
        Option("--quality", &quality, {.words = {"small", "good", "best"}},
               "of the encoding [good]"),
        Option("--frame", &frame_s, {.value = "S", .range = kMomentRange},
               "no video, but the frame at this moment"),
        OutOption(out,
                  "file .mp4, .webm, .gif, or .png with --frame [comparison.mp4 or "
                  "comparison.png in the folder]",
                  "FILE"),
    };
  }

  static constexpr auto kNotes = R"(
Examples:
  gauntlet render out/door_opening --controllers raw,tuned_kalman
  gauntlet render out/door_opening --overlay raw,tuned_kalman --speed 0.5
  gauntlet render out/door_opening --from 2 --to 3 --speed 0.25 --out slow.webm
  gauntlet render out/door_opening --size 640x360 --fps 20 --out door.gif
  gauntlet render out/door_opening --frame 2.6 --size 1920x1080 --out door.png
)";
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

void RunRender(const RenderChoices& options) {
  WarnIfUnchecked(options.folder, Manifest(options.folder).exists());
  // No run may exchange the files while they are drawn.
  std::optional<OutputFolder> locked;
  if (options.out.empty()) locked.emplace(options.folder);
  SetSignalFolder(options.folder);
  Progress progress("video");
  const auto file =
      Render(options, [&progress](int done, int total) { return progress.Update(done, total); });
  Say("wrote {}\n", file.string());
}

}  // namespace

Command MakeRenderCommand() { return MakeCommand(RunRender); }

}  // namespace gauntlet::sim
