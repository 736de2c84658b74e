// `gauntlet inspect` of any text, with the column map, the scenario and the picture that it makes.
// The text is refused in one line, or the numbers are finite and the files can be read. Files with
// arrays are read in a helper process: `arrays` is for them.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "sim/show/video/drawing_library.h"
#include "sim/show/video/recording_picture.h"
#include "sim/study/scenario/scenario_reader.h"
#include "sim/tables/time_columns.h"
#include "tests/inspect/inspected_text.h"

namespace gauntlet::sim {

/// Without the drawing library, which has no sanitizers.
std::unique_ptr<Painter> OpenPainter(ImageView image) { return OpenCairoPainter(image); }

namespace {

void Check(const std::string& problem) {
  if (problem.empty()) return;
  std::fprintf(stderr, "%s\n", problem.c_str());
  std::abort();
}

void Read(std::string_view text) {
  static const std::filesystem::path folder =
      "/dev/shm/gauntlet_fuzz_inspect_" + std::to_string(getpid());
  std::filesystem::create_directory(folder);
  if (const auto seconds = SecondsOfText(text); seconds && !(*seconds > -1e12 && *seconds < 1e12)) {
    std::abort();
  }
  const FileFormat format = FormatOfBytes(text);
  if (format != FileFormat::kText && format != FileFormat::kUtf16) return;
  const InspectedText result = InspectText(text, folder);
  Check(result.problem);
  if (result.scenario.empty()) return;
  try {
    ParseScenario({.file = "starter.yaml", .text = result.scenario});
    // A picture takes a hundred times as long as all else.
    constexpr std::size_t kPerPicture = 256;
    if (std::hash<std::string_view>()(text) % kPerPicture == 0) DrawRecording(*result.inspection);
  } catch (const UserError& error) {
    if (result.inspection->picture_time_s.size() > 1) Check(error.what());
  }
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
