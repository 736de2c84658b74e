
#include <algorithm>
#include <memory>
#include <optional>
#include <thread>

#include "sim/base/error.h"
#include "sim/base/signal_storage.h"
#include "sim/cli/commands.h"
#include "sim/cli/controllers_option.h"
#include "sim/cli/out_option.h"
#include "sim/cli/output_folder.h"
#include "sim/cli/progress.h"
#include "sim/cli/standard_streams.h"
#include "sim/cli/study_command.h"
#include "sim/study/manifest.h"
#include "sim/video/render_folder.h"

namespace gauntlet::sim {

void AddRenderCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("render", "Draw the comparison video of a finished run or comparison");
  struct Options {
    std::string folder;
    std::string out;
    std::vector<std::string> controllers;
  };
  const auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "output folder of run or compare")->required();
  AddControllersOption(*command, options->controllers);
  AddOutOption(*command, options->out, "video file [comparison.mp4 in the folder]", "FILE.mp4");
  command->footer(
      "\nExample:\n  gauntlet render out/door_opening --controllers raw,tuned_kalman\n");
  command->callback([options] {
    if (!options->out.empty() && !options->out.ends_with(".mp4")) {
      throw UserError({.place = "--out " + options->out, .problem = "must end in .mp4"});
    }
    WarnIfUnchecked(options->folder, Manifest(options->folder).exists());
    // No run may exchange the files while they are drawn.
    std::optional<OutputFolder> locked;
    if (options->out.empty()) locked.emplace(options->folder);
    SetSignalFolder(options->folder);
    Progress progress("video");
    const auto file =
        RenderFolder({.folder = options->folder,
                      .controllers = options->controllers,
                      .target = options->out,
                      .jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()))},
                     [&progress](int done, int total) { return progress.Update(done, total); });
    Say("wrote {}\n", file.string());
  });
}

}  // namespace gauntlet::sim
