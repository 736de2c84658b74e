#pragma once

#include <string>

#include "sim/comparison/summary.h"

namespace gauntlet::sim {

/// comparison.mp4 beside a page.
struct VideoBeside {
  bool exists = false;           // it stands, or will stand there
  double motion_starts_s = 0.0;  // in the video
};

/// `report.html`: one page that holds all that it shows but the video, needs no network, and sends
/// nothing anywhere. The verdict first, then scores, jitter against delay, channels, curves,
/// settings. See docs/reference/report-page.md for what is in it and how large it gets.
std::string ReportPage(const FinishedStudy& finished, const VideoBeside& video);

/// The parts of a page that are made elsewhere.
struct PageParts {
  std::string title;
  std::string question;
  std::string facts;  // duration, joints, seeds, reference
  std::string verdict;
  std::string answer = {};        // HTML of the table and the warnings of the verdict
  std::string front = {};         // HTML of jitter against delay
  std::string recording = {};     // HTML of its part; empty: nothing was recorded
  std::string data;               // JSON, as JsonForScript() gives it
  std::string resolved_scenario;  // YAML
  VideoBeside video{};
};

/// The page of these parts, all text escaped. ReportPage() without a study: for tests.
std::string AssemblePage(const PageParts& parts);

}  // namespace gauntlet::sim
