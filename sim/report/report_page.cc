#include "sim/report/report_page.h"

#include <fmt/format.h>

#include "sim/report/assets.h"
#include "sim/report/html_text.h"
#include "sim/report/page_data.h"
#include "sim/report/score_table.h"
#include "sim/study/study_files.h"
#include "sim/trial/command_angles.h"
#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {
namespace {

std::string Facts(const StudyResult& result, bool comparison) {
  const double seconds = result.first_glove.counts.rows() / result.rate_hz;
  const int first = result.seeds.front().seed;
  const int last = result.seeds.back().seed;
  const std::string seeds =
      comparison && result.seeds.size() > 1
          ? fmt::format("{} seeds, {} to {}", result.seeds.size(), first, last)
          : fmt::format("seed {}", first);
  return fmt::format("{:.1f} s at {:g} Hz · {} channels · {} controllers · {} · compared with {}",
                     seconds, result.rate_hz, result.channel_names.size(),
                     result.controller_names.size(), seeds, result.reference_name);
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

std::string ReportPage(const Study& study, const StudyResult& result, const Summary& summary,
                       const ReportOptions& options) {
  FirstSeed first_seed;
  for (const Trace& trace : result.first_traces) {
    first_seed.command_angle_rad.push_back(
        CommandAngles(study.hand->transmission(), trace.command_counts));
    first_seed.latency.push_back(
        LatencyOfTrace(*study.hand, study.scenario.event, result.first_glove, trace));
  }
  return AssemblePage({.title = study.scenario.name,
                       .question = study.scenario.question,
                       .facts = Facts(result, options.comparison),
                       .verdict = Verdict(summary),
                       .data = JsonForScript(PageData(study.scenario, result, summary, first_seed,
                                                      options.comparison)),
                       .resolved_scenario = ResolvedScenario(study),
                       .video = options.video});
}

}  // namespace gauntlet::sim
