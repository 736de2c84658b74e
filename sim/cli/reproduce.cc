

#include "sim/answers/compare/study_files.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"
#include "sim/base/output_folder.h"
#include "sim/base/threads.h"
#include "sim/cli/commands.h"
#include "sim/cli/progress.h"
#include "sim/cli/shared_options.h"
#include "sim/cli/standard_streams.h"
#include "sim/show/paper/paper_page.h"
#include "sim/show/video/render_folder.h"

namespace gauntlet::sim {
namespace {

struct ReproduceOptions {
  static constexpr auto kName = "reproduce";
  static constexpr auto kPurpose = "Repeat the paper's experiments, test its claims";
  static constexpr auto kGroup = Group::kStudy;
  std::string out = "out/paper";
  bool quick = false;
  std::vector<std::string> set = {};
  bool video = false;
  int jobs = 0;

  Options Rows() {
    return {
        OutOption(out, "output folder"),
        Option("--quick", &quick, {},
               "6 s of motion instead of the paper's 94, to see how it looks"),
        SetOption(set, "another value than the paper's"),
        Option("--video", &video, {},
               "a video of the first 20 s, without a filter and with the paper's"),
        JobsOption(jobs),
    };
  }

  static constexpr auto kNotes = R"(
Bai, Jiang, Yokoi: Multiple-Channel Real Time Filtering for a Myoelectric Prosthetic
Hand-Arm Robot System (arXiv:2103.02750).

Examples:
  gauntlet reproduce --out out/paper
  gauntlet reproduce --quick --set controllers.paper_kalman.filter.q=0.1 --out out/other_q
)";
};

void RenderVideo(const std::filesystem::path& folder) {
  Progress progress("video");
  const auto file = RenderFolder({.folder = folder,
                                  .controllers = {"raw", "paper_kalman"},
                                  .excerpt = {.from_s = 0.0, .to_s = 20.0},
                                  .jobs = JobsOrCores(0)},
                                 [&](int done, int total) { return progress.Update(done, total); });
  Say("wrote {}\n", file.string());
}

void Reproduce(const ReproduceOptions& options) {
  OutputFolder folder(options.out);
  auto experiment = [&] {
    Progress progress("the paper's experiments");
    return RunPaperExperiment(
        {.scenario = OwnOrDataFile("scenarios/paper_claims.yaml"),
         .quick = options.quick,
         .set = options.set,
         .jobs = JobsOrCores(options.jobs),
         .progress = [&](double done, double total) { return progress.Update(done, total); },
         .remark = [](const std::string& line) { Say("gauntlet: {}\n", line); }});
  }();
  experiment.finished.folder = folder.path();
  const std::vector<PaperFigure> figures = PaperFigures(experiment);
  OutputFiles files({.folder = folder.path(), .command = "reproduce"});
  files.Write([&](const std::filesystem::path& place) {
    WriteStudyFiles(place, experiment.finished);
    for (const PaperFigure& figure : figures) {
      for (const PaperChart& chart : figure.charts) {
        WriteOutputFile(place / chart.file, chart.svg);
      }
    }
    WriteOutputFile(place / "reproduce.html", PaperPage(experiment, figures));
  });
  files.Commit();
  folder.Keep();
  PrintText(PaperTable(experiment));
  FlushOutput();
  Say("wrote {}: reproduce.html, figure_*.svg, scores.json, scores.csv, "
      "trace.h5, scenario.resolved.yaml, manifest.json\n",
      folder.path().string());
  if (options.video) RenderVideo(folder.path());
  const auto& finished = experiment.finished;
  for (const std::string& failure : Failures(finished.summary, finished.result.seeds.size())) {
    throw RunError(failure);
  }
}

}  // namespace

Command MakeReproduceCommand() { return MakeCommand(Reproduce); }

}  // namespace gauntlet::sim
