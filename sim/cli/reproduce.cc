

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

namespace gauntlet::sim {
namespace {

struct ReproduceOptions {
  static constexpr auto kName = "reproduce";
  static constexpr auto kPurpose = "Repeat the paper's experiments, test its claims";
  static constexpr auto kGroup = Group::kStudy;
  std::string out = "out/paper";
  bool quick = false;
  int jobs = 0;

  Options Rows() {
    return {
        OutOption(out, "output folder"),
        Option("--quick", &quick, {},
               "6 s of motion instead of the paper's 94, to see how it looks"),
        JobsOption(jobs),
    };
  }

  static constexpr auto kNotes = R"(
Bai, Jiang, Yokoi: Multiple-Channel Real Time Filtering for a Myoelectric Prosthetic
Hand-Arm Robot System (arXiv:2103.02750).

Example:
  gauntlet reproduce --out out/paper
)";
};

void Reproduce(const ReproduceOptions& options) {
  OutputFolder folder(options.out);
  auto experiment = [&] {
    Progress progress("the paper's experiments");
    return RunPaperExperiment(
        {.scenario = OwnOrDataFile("scenarios/paper_claims.yaml"),
         .quick = options.quick,
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
  const auto& finished = experiment.finished;
  for (const std::string& failure : Failures(finished.summary, finished.result.seeds.size())) {
    throw RunError(failure);
  }
}

}  // namespace

Command MakeReproduceCommand() { return MakeCommand(Reproduce); }

}  // namespace gauntlet::sim
