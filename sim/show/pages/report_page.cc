#include "sim/show/pages/report_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "sim/answers/compare/study_files.h"
#include "sim/answers/compare/summary.h"
#include "sim/base/channels.h"
#include "sim/base/data_folder.h"
#include "sim/base/error.h"
#include "sim/base/hash.h"
#include "sim/base/json.h"
#include "sim/base/quantile.h"
#include "sim/recordings/recording.h"
#include "sim/results/html_text.h"
#include "sim/show/figure/palette.h"
#include "sim/show/figure/panel.h"
#include "sim/show/pages/assets.h"
#include "sim/show/pages/front_chart.h"
#include "sim/show/pages/headline.h"
#include "sim/show/pages/page_data.h"
#include "sim/show/pages/score_table.h"
#include "sim/study/counted_parts.h"
#include "sim/trial/joint_angles.h"
#include "sim/trial/latency_of_trace.h"

namespace gauntlet::sim {
namespace {

/// Rows that are played.
struct Rows {
  std::size_t begin = 0;
  std::size_t end = 0;

  std::size_t count() const { return end - begin; }
};

Rows PlayedRows(const GloveSignal& glove) {
  const std::vector<double>& time_s = glove.recording->time_s;
  const double end_s = glove.recording_start_s +
                       static_cast<double>(glove.true_angle_rad.rows()) / glove.tick_rate_hz;
  const auto place = [&](double t) {
    return static_cast<std::size_t>(std::ranges::lower_bound(time_s, t) - time_s.begin());
  };
  return {place(glove.recording_start_s), place(end_s)};
}

std::string HashText(const std::string& file) {
  try {
    return HashOfFile(file);
  } catch (const RunError&) {
    return "the file is gone";
  }
}

std::string Fact(std::string_view name, std::string_view value) {
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", EscapeHtml(name), EscapeHtml(value));
}

std::string RateText(const std::vector<double>& time_s, const Rows& rows) {
  std::vector<double> steps_ms;
  for (std::size_t i = rows.begin + 1; i < rows.end; ++i) {
    steps_ms.push_back(1e3 * (time_s[i] - time_s[i - 1]));
  }
  const double usual_ms = Quantile(steps_ms, 0.5);
  if (!(usual_ms > 0.0)) return "not known";
  const std::string shortest = fmt::format("{:.3g}", Quantile(steps_ms, 0.05));
  const std::string longest = fmt::format("{:.3g}", Quantile(steps_ms, 0.95));
  return fmt::format("{:.4g} Hz; nine of ten intervals last {}{} ms", 1e3 / usual_ms, shortest,
                     shortest == longest ? "" : " to " + longest);
}

/// Share of the time for which each channel is masked, by the reason: one line for each.
std::string MaskedFacts(const GloveSignal& glove) {
  std::string facts;
  const auto ticks = static_cast<double>(glove.true_angle_rad.rows());
  for (std::size_t reason = 0; reason < kMaskReasonNames.size(); ++reason) {
    std::string channels;
    for (int channel = 0; channel < std::ssize(glove.channel_names); ++channel) {
      double masked = 0.0;
      int stretches = 0;
      for (const MaskedStretch& stretch : glove.masked) {
        const bool is_it =
            stretch.channel == channel && static_cast<std::size_t>(stretch.reason) == reason;
        if (!is_it) continue;
        masked += stretch.end - stretch.begin;
        ++stretches;
      }
      if (stretches == 0) continue;
      channels += fmt::format("{}{} {:.3g} % ({})", channels.empty() ? "" : ", ",
                              glove.channel_names[static_cast<std::size_t>(channel)],
                              100.0 * masked / ticks, stretches);
    }
    constexpr std::array<std::string_view, 3> kWords = {"Gaps", "Restarts of the clock",
                                                        "At their stop"};
    if (!channels.empty()) facts += Fact(kWords[reason], channels);
  }
  return facts;
}

std::string CountedFact(const Study& study) {
  const std::vector<double> shares = CountedShares(study);
  const auto [least, most] = std::ranges::minmax_element(shares);
  if (*least >= 1.0) return Fact("Counts for the scores", "all of it");
  return Fact("Counts for the scores",
              fmt::format("{:.3g} to {:.3g} % of the time, by joint; {:g} s after each gap or "
                          "restart do not count",
                          100.0 * *least, 100.0 * *most, study.scenario.score.recovery_s));
}

/// The rows of one channel as dots, at most so many, and a mark at the lower edge for each row that
/// is missing or was left out.
std::string DotsOf(const GloveSignal& glove, const Rows& rows, std::size_t channel) {
  constexpr std::size_t kMostDots = 3000;
  constexpr FigureLayout kLayout = {.left = 4.0, .top = 4.0, .right = 4.0, .bottom = 16.0};
  const Recording& recording = *glove.recording;
  const auto angle = recording.angle_rad.col(static_cast<Eigen::Index>(channel));
  const auto value = [&](std::size_t row) { return angle[static_cast<Eigen::Index>(row)]; };
  Extent angles;
  for (std::size_t i = rows.begin; i < rows.end; ++i) angles.Include(value(i));
  if (!(angles.high > angles.low)) return "";
  const std::string name(KnownChannels()[channel].name);
  const Extent times = {recording.time_s[rows.begin], recording.time_s[rows.end - 1]};
  const std::size_t every = std::max<std::size_t>(1, rows.count() / kMostDots);
  Figure figure{908.0, 180.0, "rows", "Rows of " + name};
  const Panel panel(figure.Inside(kLayout), {times}, {angles});
  std::vector<FigurePoint> dots, marks;
  const auto add = [](std::vector<FigurePoint>& points, FigurePoint from, FigurePoint to) {
    points.insert(points.end(), {from, to, {kNaN, kNaN}});
  };
  for (std::size_t i = rows.begin; i < rows.end; ++i) {
    const double x = panel.X(recording.time_s[i]);
    if (std::isnan(value(i))) {
      add(marks, {x, panel.area().bottom + 2.0}, {x, panel.area().bottom + 10.0});
    } else if ((i - rows.begin) % every == 0) {
      add(dots, {x, panel.Y(value(i))}, {x, panel.Y(value(i))});
    }
  }
  figure.Path(dots, {"dots"});
  figure.Path(marks, {"marks"});
  return SvgOf(figure) + fmt::format(
                             "<p class=\"note small\">{}: every {}row of the file, {:.3g} to "
                             "{:.3g} deg over {:.4g} "
                             "s. A mark below: nothing there, or left out.</p>\n",
                             name, every == 1 ? "" : fmt::format("{}th ", every),
                             angles.low * kDegPerRad, angles.high * kDegPerRad,
                             times.high - times.low);
}

/// The channel of the first joint that is shown, if it was recorded; else the first that was.
std::size_t ShownChannel(const Study& study, const Recording& recording) {
  const auto is_recorded = [&](std::size_t c) { return recording.has_channel[c]; };
  for (std::size_t c = 0; c < recording.has_channel.size(); ++c) {
    if (is_recorded(c) && KnownChannels()[c].name == study.scenario.video.channel) return c;
  }
  return static_cast<std::size_t>(std::ranges::find(recording.has_channel, true) -
                                  recording.has_channel.begin());
}

/// The part of the report page that tells of the recording, as HTML: file, hash, rows, rate and its
/// jitter, what was repaired, what of each joint does not count and why, and of the first joint the
/// rows as they stand in the file, with marks where they were left out. Of the first seed. Empty
/// where nothing was recorded.
std::string RecordingSection(const FinishedStudy& finished) {
  if (finished.result.first_glove == nullptr || finished.result.first_glove->recording == nullptr) {
    return "";
  }
  const GloveSignal& glove = *finished.result.first_glove;
  const Recording& recording = *glove.recording;
  const Rows rows = PlayedRows(glove);
  if (rows.count() < 2) return "";
  std::string html =
      "<section id=\"recording\" aria-labelledby=\"recording-title\">\n"
      "<h2 id=\"recording-title\">Recording</h2>\n<dl class=\"versions\">\n";
  html += Fact("File", PathFrom(finished.folder, recording.name));
  html += Fact("Hash", HashText(recording.name));
  html += Fact("Rows", fmt::format("{}, from {:.4g} s on", rows.count(), glove.recording_start_s));
  html += Fact("Rate", RateText(recording.time_s, rows));
  html += Fact("Taken as", glove.is_recorded ? "what a real glove measured"
                                             : "the wearer's true motion, under a simulated glove");
  html += Fact("Compared with", glove.reference_name);
  for (std::string remark : recording.remarks) {
    if (remark.starts_with(recording.name + ": ")) remark.erase(0, recording.name.size() + 2);
    html += Fact("Found", remark);
  }
  if (recording.remarks.empty()) html += Fact("Found", "nothing to repair");
  html += MaskedFacts(glove);
  html += CountedFact(finished.study);
  html += "</dl>\n" + DotsOf(glove, rows, ShownChannel(finished.study, recording)) + "</section>\n";
  return html;
}

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
            "muted playsinline preload=\"metadata\" src=\"comparison.mp4\"" +
                std::string(video.has_poster ? " poster=\"poster.png\"" : "") +
                " aria-label=\"The hands of several controllers side by side\"></video></div>"
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

/// The page may also show a picture beside it.
std::string WithPoster(std::string_view page) {
  constexpr std::string_view kPictures = "img-src data:";
  std::string text(page);
  return text.insert(text.find(kPictures) + kPictures.size(), " 'self' file:");
}

}  // namespace

std::string AssemblePage(const PageParts& parts) {
  return FillTemplate(
      parts.video.has_poster ? WithPoster(assets::kPageHtml) : std::string(assets::kPageHtml),
      {{"title", EscapeHtml(parts.head.title)},
       {"kind", EscapeHtml(parts.head.kind)},
       {"head", HtmlOf(parts.head)},
       {"facts", EscapeHtml(parts.facts)},
       {"numbers", parts.numbers},
       {"doubts", parts.doubts},
       {"answer", parts.answer},
       {"settings", EscapeHtml(parts.resolved_scenario)},
       {"video", VideoSection(parts.video)},
       {"front", parts.front},
       {"recording", parts.recording},
       {"data", parts.data},
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
      {.head = {.kind = "Gauntlet report",
                .title = finished.study.scenario.name,
                .question = finished.study.scenario.question,
                .headline = Headline(finished.summary),
                .numbers = HeadlineDifferences(finished.summary),
                .of_numbers = "#scores",
                .answer =
                    fmt::format("{}", fmt::join(finished.summary.answer.verdict.Answer(), " "))},
       .facts = Facts(finished),
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
