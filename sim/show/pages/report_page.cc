#include "sim/show/pages/report_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/answers/compare/study_files.h"
#include "sim/base/json.h"
#include "sim/results/html_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/pages/assets.h"
#include "sim/show/pages/controllers_front.h"
#include "sim/show/pages/page_data.h"
#include "sim/show/pages/recording_section.h"
#include "sim/show/pages/score_table.h"
#include "sim/study/counted_parts.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {
namespace {

std::string Facts(const FinishedStudy& finished) {
  const StudyResult& result = finished.result;
  const int first = result.seeds.front().seed;
  const int last = result.seeds.back().seed;
  const std::string seeds = !finished.summary.blocks.empty() ? finished.summary.blocks.Text()
                            : finished.summary.one_run
                                ? fmt::format("seed {}", first)
                                : fmt::format("{} seeds, {} to {}: {}", result.seeds.size(), first,
                                              last, WhatVaries(result));
  return fmt::format("{} at {:g} Hz · {} · {} controllers · {} · compared with {}",
                     DurationText(result), result.first_glove->rate_hz,
                     Measured(finished.study, result), result.controller_names.size(), seeds,
                     result.reference_name);
}

/// Ways of a trial's samples, of the measured joints.
WayOfAngles MeasuredWay(const Study& study, const Trace& trace) {
  WayOfAngles way = WayOf(trace, study.joint_map(), study.hand->transmission());
  if (std::ssize(study.measured_joints) == way.raw.cols()) return way;
  for (Signal* angle_rad : {&way.raw, &way.filtered, &way.target, &way.command}) {
    *angle_rad = (*angle_rad)(Eigen::all, study.measured_joints);
  }
  return way;
}

FirstSeed MeasureFirstSeed(const FinishedStudy& finished) {
  const Study& study = finished.study;
  const std::vector<Trace>& traces = finished.result.first_traces;
  const Columns reference(finished.result.first_reference_rad, study.measured_joints);
  FirstSeed first(*reference, traces.size());
  first.counted = CountedPartsOf(study, finished.result.first_glove->masked,
                                 static_cast<int>(reference->rows()));
  for (std::size_t c = 0; c < traces.size(); ++c) {
    const Trace& trace = traces[c];
    const WayOfAngles way = MeasuredWay(study, trace);
    const Columns hand(trace.hand_angle_rad, study.measured_joints);
    first.latency.push_back(trace.health.ok
                                ? LatencyOfTrace(*study.hand, study.scenario.controllers[c].config,
                                                 *reference, way, *hand, first.counted)
                                : std::nullopt);
    first.Add(way, *hand);
  }
  return first;
}

/// [[video_s, from_s, to_s, speed], ..]
std::string StretchesText(const VideoBeside& video) {
  std::string text;
  for (const auto& [video_s, from_s, to_s, speed] : video.stretches) {
    text += fmt::format("{}[{},{},{},{}]", text.empty() ? "" : ",", video_s, from_s, to_s, speed);
  }
  return fmt::format("[{}]", text);
}

std::string VideoSection(const VideoBeside& video) {
  const std::string inside =
      video.exists
          ? "<p class=\"note\">The baseline and the controllers of the verdict, then the second in "
            "which they differ most in slow motion.</p>\n<div id=\"video-place\"><video controls "
            "muted playsinline preload=\"metadata\" src=\"comparison.mp4\" aria-label=\"The hands "
            "of "
            "several controllers side by side\"></video></div>"
          : "<p class=\"note\">None was drawn with these scores. <code>gauntlet render</code> "
            "draws "
            "comparison.mp4 beside this page.</p>\n<div id=\"video-place\" class=\"needs-script\">"
            "<p class=\"controls\"><button type=\"button\" id=\"video-show\">Show "
            "comparison.mp4</button></p></div>";
  return fmt::format(
      "<section id=\"video\" aria-labelledby=\"video-title\" data-stretches=\"{}\">\n<h2 "
      "id=\"video-title\">Video</h2>\n{}\n</section>\n",
      StretchesText(video), inside);
}

}  // namespace

std::string AssemblePage(const PageParts& parts) {
  return FillTemplate(
      assets::kPageHtml,
      {{"title", EscapeHtml(parts.title)},
       {"question", EscapeHtml(parts.question)},
       {"facts", EscapeHtml(parts.facts)},
       {"verdict", EscapeHtml(parts.verdict)},
       {"numbers", parts.numbers},
       {"doubts", parts.doubts},
       {"answer", parts.answer},
       {"settings", EscapeHtml(parts.resolved_scenario)},
       {"video", VideoSection(parts.video)},
       {"front", parts.front},
       {"recording", parts.recording},
       {"data", parts.data},
       {"kind", "Gauntlet report"},
       {"sources", std::string(assets::kScriptSources) + "media-src 'self' file:; "},
       {"style", std::string(assets::kPlotStyle) + PaletteCss() + std::string(assets::kStyle)},
       {"plot_library", std::string(assets::kPlotLibrary)},
       {"replay_library", std::string(assets::kReplayLibrary)},
       {"script", std::string(assets::kScript)}});
}

std::string ReportPage(const FinishedStudy& finished, const VideoBeside& video) {
  ResultText notes;
  AddAnswerNotes(finished, notes);
  return AssemblePage(
      {.title = finished.study.scenario.name,
       .question = finished.study.scenario.question,
       .facts = Facts(finished),
       .verdict = fmt::format("{}", fmt::join(finished.summary.answer.verdict.Answer(), " ")),
       .numbers = HtmlOf(ShownText(finished)),
       .doubts = HtmlOf(notes),
       .answer = HtmlOf(AnswerText(finished)),
       .front = ControllersFront(finished.summary),
       .recording = RecordingSection(finished),
       .data = JsonForScript(PageData(finished, MeasureFirstSeed(finished))),
       .resolved_scenario = ResolvedScenario(finished),
       .video = video});
}

}  // namespace gauntlet::sim
