#include "sim/results/answer_files.h"

#include "sim/base/error.h"
#include "sim/base/limited_text.h"
#include "sim/base/manifest.h"
#include "sim/base/output_file.h"

namespace gauntlet::sim {

void WriteAnswer(const std::filesystem::path& folder, const ResultText& answer,
                 const ResultText& verbose) {
  WriteOutputFile(folder / kAnswerFile, TextOf(answer, TerminalStyle{}));
  WriteOutputFile(folder / kVerboseAnswerFile, TextOf(verbose, TerminalStyle{}));
}

KeptAnswer ReadAnswer(const std::filesystem::path& folder, bool verbose) {
  const Manifest manifest(folder);
  const char* name = verbose ? kVerboseAnswerFile : kAnswerFile;
  std::error_code ignored;
  if (!std::filesystem::exists(folder / name, ignored)) {
    throw UserError({.place = folder.string(),
                     .problem = std::string("no ") + name +
                                " there, must be the output folder of a finished run, compare, "
                                "tune, sweep or robust of this version"});
  }
  return {.text = LimitedText(manifest.Checked(name), kMostEditableBytes),
          .checked = manifest.exists()};
}

}  // namespace gauntlet::sim
