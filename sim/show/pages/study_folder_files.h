#pragma once

#include <filesystem>
#include <string>

#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/summary.h"
#include "sim/base/manifest.h"

namespace gauntlet::sim {

/// The files of `run` and `compare` in the folder of a study that is not finished yet, to be made
/// before the trials. Errors: as OutputFiles.
OutputFiles FilesOfStudy(const FinishedStudy& study);

/// report.html of a finished study. `has_video`: comparison.mp4 will stand beside.
std::string StudyPage(const FinishedStudy& finished, bool has_video);

/// Writes all of them with the page, and commits them. Errors: RunError.
void WriteStudyFolder(const FinishedStudy& finished, const TraceFormats& formats, bool has_video,
                      OutputFiles& files);
/// Writes them as the last use of the traces: see WriteLastStudyFiles().
void WriteLastStudyFolder(FinishedStudy& finished, const TraceFormats& formats, bool has_video,
                          OutputFiles& files);

}  // namespace gauntlet::sim
