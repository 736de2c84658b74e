#pragma once

#include <string>
#include <vector>

#include "sim/answers/compare/summary.h"
#include "sim/show/pages/headline.h"
#include "sim/show/video/frame_clock.h"

namespace gauntlet::sim {

/// comparison.mp4 beside a page.
struct VideoBeside {
  bool exists = false;      // it stands, or will stand there
  bool has_poster = false;  // poster.png as well
  std::vector<VideoStretch> stretches = {};
};

/// `report.html`: one page that holds all that it shows but the video, needs no network, and sends
/// nothing anywhere. The verdict with its numbers, the hand and jitter against delay first, then
/// causes, scores, video, curves, channels, settings. Size and parts: see
/// docs/reference/report-page.md.
std::string ReportPage(const FinishedStudy& finished, const VideoBeside& video);

/// The parts of a page that are made elsewhere.
struct PageParts {
  PageHead head;
  std::string facts = {};         // duration, joints, seeds, reference
  std::string numbers = {};       // HTML of the scores that the verdict is about
  std::string doubts = {};        // HTML of the warnings of the verdict
  std::string answer = {};        // HTML of the table of all controllers, for pages without scripts
  std::string front = {};         // HTML of jitter against delay
  std::string recording = {};     // HTML of its part; empty: nothing was recorded
  std::string data;               // JSON, as JsonForScript() gives it
  std::string resolved_scenario;  // YAML
  VideoBeside video{};
};

/// The page of these parts, all text escaped. ReportPage() without a study: for tests.
std::string AssemblePage(const PageParts& parts);

}  // namespace gauntlet::sim
