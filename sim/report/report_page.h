#pragma once

#include <string>

#include "sim/study/summary.h"

namespace gauntlet::sim {

/// `report.html`: one page that holds all that it shows but the video, needs no network, and sends
/// nothing anywhere. The verdict first, then scores, jitter against delay, channels, curves,
/// settings. See sim/report/README.md for what is in it and how large it gets.
/// `video`: comparison.mp4 stands, or will stand, beside the page.
std::string ReportPage(const FinishedStudy& finished, bool video);

/// The parts of a page that are made elsewhere.
struct PageParts {
  std::string title;
  std::string question;
  std::string facts;  // duration, joints, seeds, reference
  std::string verdict;
  std::string data;               // JSON, as JsonForScript() gives it
  std::string resolved_scenario;  // YAML
  bool video = false;
};

/// The page of these parts, all text escaped. ReportPage() without a study: for tests.
std::string AssemblePage(const PageParts& parts);

}  // namespace gauntlet::sim
