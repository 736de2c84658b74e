// `gauntlet calibrate` of any texts: a recording, and behind bytes of zero a column map and a table
// of poses, if there are any. They are refused in one line, or the calibration is finite.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>

#include "sim/base/error.h"
#include "sim/fit/calibration.h"
#include "sim/fit/pose_recording.h"
#include "sim/tables/file_format.h"

namespace gauntlet::sim {
namespace {

void Check(const PoseRecording& recording, const Calibration& calibration) {
  const Eigen::Index samples = recording.counts.rows();
  if (!recording.counts.allFinite() || !(recording.rate_hz > 0.0) ||
      !std::isfinite(recording.rate_hz)) {
    std::abort();
  }
  if (recording.counts.cols() != std::ssize(recording.channel_names)) std::abort();
  for (const Eigen::Index begin : recording.stretch_begins) {
    if (begin < 0 || begin >= samples) std::abort();
  }
  for (const ChannelCalibration& channel : calibration.channels) {
    if (!std::isfinite(channel.variance_counts2) || channel.variance_counts2 < 0.0) std::abort();
    if (channel.covariance_counts2.size() != calibration.channels.size()) std::abort();
  }
}

void Read(std::string_view text) {
  static const std::string name = "/dev/shm/gauntlet_fuzz_calibrate_" + std::to_string(getpid());
  std::string files[] = {name + ".csv", name + ".map.csv", name + ".poses.csv"};
  for (std::string& file : files) {
    const std::string_view part = text.substr(0, text.find('\0'));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    const bool is_text = FormatOfBytes(part) == FileFormat::kText;
    if (!is_text && &file == files) return;  // `arrays` is for other formats
    std::ofstream(file, std::ios::binary) << part;
    if (part.empty()) file.clear();
  }
  try {
    const PoseRecording recording =
        LoadPoseRecording(files[0], {.map = files[1], .poses = files[2], .settle_ms = 1.0});
    CurveErrors errors;
    Check(recording, Calibrate(recording, {}, errors));
  } catch (const UserError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
