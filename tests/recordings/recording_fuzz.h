#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/base/channels.h"
#include "sim/base/error.h"
#include "sim/recordings/glitches.h"
#include "sim/recordings/keypoints/keypoint_table.h"
#include "sim/recordings/recording_reader.h"
#include "sim/recordings/table_source.h"
#include "sim/tables/file_format.h"

namespace gauntlet::sim {

/// One input of the fuzzer: the first byte chooses how to read, the rest is the file, a text.
/// Whatever it is, the reader ends with rows of rising time and NaN, sane or far angles, or with a
/// UserError; and only values are glitches.
inline void ReadFuzzedRecording(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  RecordingFormat format;
  format.handling = static_cast<ProblemHandling>(data[0] % 4);
  format.rate_hz = data[0] & 128 ? 100.0 : 0.0;
  const std::string_view text(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    TableInput input = TextSource(text);
    if (auto* const read = TextReaderOf(FormatOfBytes(text))) {
      input = AnglesOfKeypoints("fuzz", std::make_shared<const Table>(read("fuzz", text)));
    }
    RecordingReader reader("fuzz", std::move(input), format);
    std::vector<double> angles(KnownChannels().size());
    double before_s = -std::numeric_limits<double>::infinity();
    double time_s = 0.0;
    std::vector<double> times_s, index_mcp;
    while (reader.NextRow(time_s, angles)) {
      if (!(time_s > before_s)) std::abort();
      before_s = time_s;
      for (std::size_t c = 0; c < angles.size(); ++c) {
        if (IsFarBeyondRange(KnownChannels()[c], angles[c])) angles[c] = kMissing;
        if (!std::isnan(angles[c]) && !(std::abs(angles[c]) < 10.0)) std::abort();
      }
      times_s.push_back(time_s);
      index_mcp.push_back(angles[4]);
    }
    for (const std::size_t place : FindGlitches(times_s, index_mcp, 2.0, {true, true})) {
      if (std::isnan(index_mcp.at(place))) std::abort();
    }
    if (reader.Remarks().size() > size) std::abort();
  } catch (const UserError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace gauntlet::sim
