#pragma once

#include <string>
#include <vector>

#include "sim/answers/sweep/sweep_result.h"
#include "sim/results/table_text.h"
#include "sim/show/pages/cell_points.h"
#include "sim/show/pages/headline.h"

namespace gauntlet::sim {

// A page of many settings, self-contained as ReportPage() is: tables, as the terminal has them, and
// pictures, which stand there without scripts: a heat map per pair of settings, parallel
// coordinates, jitter against delay. With scripts ranges can be brushed, and a click gives a
// point's settings as YAML and the command that repeats it. See docs/reference/report-page.md.

/// Texts of a page besides its points.
struct CellsPageTexts {
  PageHead head;
  ResultText text;  // as the terminal has it: title and answer, which stand in the head, first
  ResultText details = {};          // at the end, without such a beginning
  std::string first_sections = {};  // HTML of pictures before the others
  std::string command_folder = "the folder where the study was run";  // where commands find files
  bool heat = true;
  bool front = true;
};

/// A text without its title and answer.
ResultText TextBehindAnswer(const ResultText& text);

/// `points`: finished.
std::string CellsPage(const CellPoints& points, const CellsPageTexts& texts);

/// Something wide that scrolls by itself; `label` says what it is.
std::string ScrolledDrawing(const std::string& drawing, const std::string& label);
/// Share of the page's width that a section has where the page is wide.
enum class SectionWidth { kHalf, kAll };

/// A section of the page; `title` and `note` are HTML, as is `drawing`.
std::string PageSection(const std::string& id, const std::string& title, const std::string& note,
                        const std::string& drawing, SectionWidth width = SectionWidth::kAll);

/// An axis of a study file, or a free setting of tuning, with a name of its own.
ChartAxis ChartAxisOf(const SweepAxis& setting, const std::string& name, bool grid);

/// ` · jitter_rms_deg<=0.2`; nothing without constraints.
std::string BoundsText(const std::vector<Constraint>& constraints);
std::vector<double> MeansOf(const std::vector<MeanInterval>& scores);

/// Settings `key=value` as a scenario has them: a level per part of the key. What stands in a list
/// becomes a comment, as its neighbours are not known.
std::string SettingsYaml(std::vector<std::string> overrides);

}  // namespace gauntlet::sim
