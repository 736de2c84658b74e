#include "sim/report/report_page.h"

#include <fmt/format.h>

#include "sim/report/assets.h"
#include "sim/report/html_text.h"
#include "sim/report/page_data.h"
#include "sim/report/score_table.h"
#include "sim/study/study_files.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {
namespace {

std::string Facts(const FinishedStudy& finished) {
  const StudyResult& result = finished.result;
  const int first = result.seeds.front().seed;
  const int last = result.seeds.back().seed;
  const std::string seeds =
      finished.summary.one_run
          ? fmt::format("seed {}", first)
          : fmt::format("{} seeds, {} to {}", result.seeds.size(), first, last);
  return fmt::format("{:.1f} s at {:g} Hz · {} · {} controllers · {} · compared with {}",
                     result.duration_s(), result.first_glove->rate_hz, Measured(finished.study),
                     result.controller_names.size(), seeds, result.reference_name);
}

/// The measured joints of a signal of all joints.
Signal Measured(const Signal& all, const Study& study) {
  return all(Eigen::all, study.measured_joints);
}

FirstSeed MeasureFirstSeed(const FinishedStudy& finished) {
  const Study& study = finished.study;
  FirstSeed first;
  first.reference_rad = Measured(finished.result.first_reference_rad, study);
  const controller::JointMap joint_map = study.joint_map();
  for (const Trace& trace : finished.result.first_traces) {
    const WayOfAngles all = WayOf(trace, joint_map, study.hand->transmission());
    first.ways.push_back({.raw = Measured(all.raw, study),
                          .filtered = Measured(all.filtered, study),
                          .command = Measured(all.command, study)});
    first.hand_rad.push_back(Measured(trace.hand_angle_rad, study));
    first.latency.push_back(
        LatencyOfTrace(*study.hand, first.reference_rad, first.ways.back(), first.hand_rad.back()));
  }
  return first;
}

}  // namespace

std::string AssemblePage(const PageParts& parts) {
  return FillTemplate(assets::kPageHtml, {{"title", EscapeHtml(parts.title)},
                                          {"question", EscapeHtml(parts.question)},
                                          {"facts", EscapeHtml(parts.facts)},
                                          {"verdict", EscapeHtml(parts.verdict)},
                                          {"settings", EscapeHtml(parts.resolved_scenario)},
                                          {"video", parts.video ? "drawn" : "none"},
                                          {"data", parts.data},
                                          {"style", std::string(assets::kStyle)},
                                          {"plot_style", std::string(assets::kPlotStyle)},
                                          {"plot_library", std::string(assets::kPlotLibrary)},
                                          {"script", std::string(assets::kScript)}});
}

std::string ReportPage(const FinishedStudy& finished, bool video) {
  return AssemblePage({.title = finished.study.scenario.name,
                       .question = finished.study.scenario.question,
                       .facts = Facts(finished),
                       .verdict = Verdict(finished.summary),
                       .data = JsonForScript(PageData(finished, MeasureFirstSeed(finished))),
                       .resolved_scenario = ResolvedScenario(finished.study),
                       .video = video});
}

}  // namespace gauntlet::sim
