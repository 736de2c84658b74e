#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "sim/fit/validation.h"
#include "sim/results/html_text.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/plain_page.h"
#include "sim/show/pages/svg_chart.h"

namespace gauntlet::sim {
namespace {

constexpr double kShownOfEpisode_s = 8.0;

std::string FigureOf(const ValidatedPart& part) {
  const ValidatedCurve& curve = part.shown;
  if (!part.problem.empty() || curve.command_deg.empty()) return "";
  const std::size_t rows = std::min(
      curve.command_deg.size(), static_cast<std::size_t>(kShownOfEpisode_s * curve.rate_hz) + 1);
  const auto curve_of = [&](const std::string& name, const std::vector<double>& values) {
    return ChartCurve{
        .name = name,
        .step_x = 1.0 / curve.rate_hz,
        .values = {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rows)}};
  };
  Chart angles{
      .title = part.part,
      .x_label = "time [s]",
      .y_label = "angle [deg]",
      .bars = {},
      .curves = {curve_of("command", curve.command_deg), curve_of("measured", curve.measured_deg),
                 curve_of("simulated", curve.simulated_deg)}};
  angles.curves.front().is_command = true;
  std::vector<double> difference(curve.measured_deg);
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] -= curve.simulated_deg[k];
  const Chart errors{.title = part.part + ", measured less simulated",
                     .x_label = "time [s]",
                     .y_label = "angle [deg]",
                     .bars = {},
                     .curves = {curve_of("difference", difference)}};
  return fmt::format(
      "<figure><div class=\"pair\">{}{}</div><figcaption>{}</figcaption></figure>\n",
      SvgChart(angles), SvgChart(errors),
      EscapeHtml(fmt::format(
          "Error {:.2f} deg RMS, {:.0f} % of the motion. Squared error: {:.0f} % at rest, {:.0f} % "
          "in slow motion, {:.0f} % in fast motion.",
          part.rms_deg, 100.0 * part.share_of_motion(), 100.0 * part.speed_share[0],
          100.0 * part.speed_share[1], 100.0 * part.speed_share[2])));
}

}  // namespace

std::string ValidationPage(const Validation& validation) {
  const ChainResult& identified = validation.identified;
  std::string figures;
  for (const ValidatedPart& part : validation.parts) figures += FigureOf(part);
  PageHead head{.kind = "Gauntlet validate",
                .title = std::filesystem::path(identified.log().name).stem().string(),
                .question = "Does the simulated servo move as the real one?",
                .facts = fmt::format("{} parts · {} episodes, {:.1f} s at {:.6g} Hz",
                                     validation.parts.size(), identified.episodes.size(),
                                     identified.duration_s(), identified.log().rate_hz)};
  SetAnswer(VerdictOf(validation), head);
  return PlainPage(
      {.head = std::move(head),
       .heading = "Result",
       .table = HtmlOf(TextBehindAnswer(ValidationText(validation))),
       .sections = PageSection("parts", "Measured beside simulated",
                               "The held-out episode in which each part moves most.", figures)});
}

}  // namespace gauntlet::sim
