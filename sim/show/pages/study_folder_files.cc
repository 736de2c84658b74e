#include "sim/show/pages/study_folder_files.h"

#include <optional>

#include "sim/answers/compare/decisive_second.h"
#include "sim/base/few_signals_on_heap.h"
#include "sim/base/output_file.h"
#include "sim/results/answer_files.h"
#include "sim/show/pages/report_page.h"
#include "sim/show/pages/score_table.h"
#include "sim/show/video/comparison_video.h"
#include "sim/show/video/score_board.h"

namespace gauntlet::sim {
namespace {

/// Content of a video of the finished study, drawn now or later by `gauntlet render`.
VideoBeside VideoOfPage(const FinishedStudy& finished, bool is_drawn) {
  VideoBeside video{.exists = is_drawn};
  std::optional<Excerpt> again;
  if (const auto second = DecisiveSecondOf(finished)) again = SlowMotionOf(*second);
  video.has_poster = is_drawn && again.has_value();
  video.stretches = StretchesOf(!finished.study.scenario.question.empty(),
                                finished.result.first_glove->tick_rate_hz,
                                finished.result.first_reference_rad.rows(),
                                finished.study.scenario.video.frames_per_s, again);
  return video;
}

void WritePageAndAnswer(const std::filesystem::path& place, const FinishedStudy& finished,
                        bool has_video) {
  ReturnFreedMemory();
  WriteOutputFile(place / "report.html", StudyPage(finished, has_video));
  WriteAnswer(place, ScoreText(finished, false), ScoreText(finished, true));
  ReturnFreedMemory();
}

}  // namespace

OutputFiles FilesOfStudy(const FinishedStudy& study) {
  return OutputFiles({.folder = study.folder,
                      .command = "run or compare",
                      .choices = study.choices,
                      .results = {"report.html", "scores.json", "scores.csv", "trace.h5",
                                  "scenario.resolved.yaml", kAnswerFile, kVerboseAnswerFile}});
}

std::string StudyPage(const FinishedStudy& finished, bool has_video) {
  return ReportPage(finished, VideoOfPage(finished, has_video));
}

void WriteStudyFolder(const FinishedStudy& finished, const TraceFormats& formats, bool has_video,
                      OutputFiles& files) {
  files.Write([&](const std::filesystem::path& place) {
    WritePageAndAnswer(place, finished, has_video);
    WriteStudyFiles(place, finished, formats);
  });
  files.Commit();
}

void WriteLastStudyFolder(FinishedStudy& finished, const TraceFormats& formats, bool has_video,
                          OutputFiles& files) {
  files.Write([&](const std::filesystem::path& place) {
    WritePageAndAnswer(place, finished, has_video);
    WriteLastStudyFiles(place, finished, formats);
  });
  files.Commit();
}

}  // namespace gauntlet::sim
