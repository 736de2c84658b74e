#pragma once

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/live/device/frame_decoder.h"

namespace gauntlet::sim {

/// How the lines of a text become values.
class LineForm;

/// Frames of text, one a line: CSV, labels, the alpha encoding, or JSON.
///
/// The form is that of the first lines in a row that agree: two rows of CSV with equally many
/// cells, or one below a line of names; two JSON values with the same keys; three of the last four
/// lines with the same labels or letters. So boot messages and a first line that was cut are left
/// out. A later line of another form is left out, too: no value is taken of it.
class TextFrames : public FrameDecoder {
 public:
  /// `format`: kDetect, kCsv, kLabels, kAlpha or kJson.
  TextFrames(FrameFormat format, ByteFlow flow);
  ~TextFrames() override;

  void Decode(std::string_view bytes, std::int64_t arrival_ns,
              const FrameReceiver& receive) override;
  void EndPacket(std::int64_t arrival_ns, const FrameReceiver& receive) override;
  void Restart() override;
  FrameFormat format() const override { return format_; }

 private:
  struct Line {
    std::string text;
    std::int64_t arrival_ns = 0;
  };

  void DecodeLine(std::string_view line, std::int64_t arrival_ns, const FrameReceiver& receive);
  void DecodeRow(std::string_view line, std::int64_t arrival_ns, const FrameReceiver& receive);
  /// Finds the form that the last lines of the head have; null if they do not agree.
  std::unique_ptr<LineForm> FindForm();
  std::unique_ptr<LineForm> FindTable();
  bool MayBe(FrameFormat format) const {
    return format_ == FrameFormat::kDetect || format_ == format;
  }

  FrameFormat format_;
  ByteFlow flow_;
  bool passes_over_line_;  // up to its end: it began before the bytes, or is too long
  std::string rest_;       // of a line without its end
  std::deque<Line> head_;  // lines before the form is known
  std::size_t first_ = 0;  // line of the head that the form begins with
  bool is_first_line_ = true;
  std::unique_ptr<LineForm> form_;
  std::vector<double> values_;
};

}  // namespace gauntlet::sim
