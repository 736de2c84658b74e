#pragma once

#include <deque>
#include <string>
#include <vector>

#include "sim/device/frame_decoder.h"

namespace gauntlet::sim {

/// Frames of text, one a line.
///
/// The shape of the frames is that of the first two lines in a row that agree, or of a line of
/// names and the line of values below it. So boot messages and a first line that was cut are left
/// out. A later line of another shape is left out, too: no value is taken from it.
class TextFrames : public FrameDecoder {
 public:
  /// `format`: kDetect, kCsv, kLabels, kAlpha or kJson.
  TextFrames(FrameFormat format, bool begins_whole);

  void Take(std::string_view bytes, std::int64_t arrival_ns, const FrameReceiver& receive) override;
  void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) override;
  void Restart() override;
  FrameFormat format() const override { return format_; }

 private:
  struct Line {
    std::string text;
    std::int64_t arrival_ns = 0;
  };

  void TakeLine(std::string_view line, std::int64_t arrival_ns, const FrameReceiver& receive);
  /// Decides on the shape if the lines of the head agree.
  void LookAtHead(const FrameReceiver& receive);
  bool FindTable();
  void TakeRow(std::string_view line, std::int64_t arrival_ns, const FrameReceiver& receive);

  FrameFormat format_;
  bool begins_whole_;
  bool is_in_line_ = false;  // the rest of a line that began before the bytes, or that is too long
  std::string rest_;         // of a line without its end
  std::deque<Line> head_;    // lines before the shape is known
  bool is_known_ = false;    // the shape
  char separator_ = ',';
  std::vector<double> values_;
};

}  // namespace gauntlet::sim
