#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "sim/fit/chain_episodes.h"
#include "sim/fit/fit_tables.h"
#include "sim/fit/identified_hand.h"
#include "sim/results/html_text.h"
#include "sim/results/table_text.h"
#include "sim/show/pages/cells_page.h"
#include "sim/show/pages/pages.h"
#include "sim/show/pages/plain_page.h"
#include "sim/show/pages/svg_chart.h"

namespace gauntlet::sim {
namespace {

constexpr double kShown_s = 5.0;

std::vector<double> ValuesOf(const Signal& signal, std::size_t part) {
  const auto column = signal.col(static_cast<Eigen::Index>(part));
  return {column.begin(), column.end()};
}

/// The first sample of the stretch in which the command goes the longest way.
std::size_t BusiestStart(const std::vector<double>& command_deg, std::size_t samples) {
  double way = 0.0;
  double longest = -1.0;
  std::size_t start = 0;
  for (std::size_t k = 1; k < command_deg.size(); ++k) {
    way += std::abs(command_deg[k] - command_deg[k - 1]);
    if (k < samples) continue;
    if (way > longest) {
      longest = way;
      start = k - samples;
    }
    way -= std::abs(command_deg[k - samples + 1] - command_deg[k - samples]);
  }
  return start;
}

ChartCurve PartCurve(const std::string& name, const std::vector<double>& values, std::size_t start,
                     std::size_t samples, double rate_hz) {
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(start);
  return {.name = name,
          .first_x = static_cast<double>(start) / rate_hz,
          .step_x = 1.0 / rate_hz,
          .values = {begin, begin + static_cast<std::ptrdiff_t>(samples)}};
}

std::string PartFigures(const ChainLog& log, const ChainFit& fit, std::size_t part) {
  const std::vector<double> command_deg = ValuesOf(log.command_deg, part);
  const std::vector<double> angle_deg = ValuesOf(log.angle_deg, part);
  const std::size_t samples = std::min(
      command_deg.size(), static_cast<std::size_t>(std::lround(kShown_s * log.rate_hz)) + 1);
  const std::size_t start = BusiestStart(command_deg, samples);
  const bool has_model = fit.problem.empty() && fit.split_problem.empty();
  const std::string unit = log.unit_known ? "deg" : "units";
  const std::string y_label = "angle [" + unit + "]";
  Chart curves{.title = log.parts[part] + ", where it moves most",
               .x_label = "time [s]",
               .y_label = y_label,
               .bars = {},
               .curves = {PartCurve("command", command_deg, start, samples, log.rate_hz),
                          PartCurve("measured", angle_deg, start, samples, log.rate_hz)}};
  curves.curves.front().is_command = true;
  std::string html;
  std::string caption = has_model ? "" : fit.problem.empty() ? fit.split_problem : fit.problem;
  if (has_model) {
    std::vector<double> simulated_deg(command_deg.size());
    SimulateChain(fit.model, RefineCommand(command_deg, log.rate_hz, fit.frames), simulated_deg);
    curves.curves.push_back(PartCurve("simulated", simulated_deg, start, samples, log.rate_hz));
    std::vector<double> difference_deg;
    for (std::size_t k = 0; k < angle_deg.size(); ++k) {
      difference_deg.push_back(angle_deg[k] - simulated_deg[k]);
    }
    // The model begins at rest, the hand in the middle of something.
    const auto settling = static_cast<std::size_t>(log.rate_hz);
    const Chart difference{.title = log.parts[part] + ", residual of the model",
                           .x_label = "time [s]",
                           .y_label = y_label,
                           .bars = {},
                           .curves = {PartCurve("measured less simulated", difference_deg, settling,
                                                difference_deg.size() - settling, log.rate_hz)}};
    html = SvgChart(curves) + SvgChart(difference);
    caption = fmt::format(
        "Simulated: the log's own command through the model ({}). It leaves {:.2f} {} RMS, {:.2f} "
        "in parts of the log that the fit did not contain; a shift in time alone leaves {:.2f}.{}",
        fit.model_text, fit.residual_rms_deg, unit, fit.held_out_rms_deg, fit.shifted_rms_deg,
        fit.remarks.empty() ? "" : " Remarks: " + RemarksOf(log, fit) + ".");
  } else {
    html = SvgChart(curves);
  }
  return fmt::format("<figure><div class=\"pair\">{}</div><figcaption>{}</figcaption></figure>\n",
                     html, EscapeHtml(caption));
}

/// The name of the log's file; of a trace, that of its folder.
std::string NameOf(const ChainLog& log) {
  const std::filesystem::path file = std::filesystem::absolute(log.name).lexically_normal();
  return (file.filename() == "trace.h5" ? file.parent_path().filename() : file.stem()).string();
}

/// Range of the finite ones, as a number of the head; none without any.
void AddRange(const std::string& name, std::vector<double> values, int digits,
              const std::string& unit, const std::string& note, std::vector<HeadNumber>& numbers) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return;
  numbers.push_back({.name = name, .value = RangeText(values, digits) + " " + unit, .note = note});
}

std::vector<HeadNumber> NumbersOf(const std::vector<ChainFit>& fits, const std::string& unit) {
  std::vector<double> delays_ms, residuals_deg;
  std::size_t limited = 0;
  for (const ChainFit& fit : fits) {
    if (!fit.problem.empty()) continue;
    delays_ms.push_back(fit.delay_ms.value);
    if (std::isfinite(fit.speed_limit_deg_s.value)) ++limited;
    if (fit.split_problem.empty()) residuals_deg.push_back(fit.held_out_rms_deg);
  }
  std::vector<HeadNumber> numbers;
  AddRange("delay", delays_ms, 0, "ms", "angle behind its command", numbers);
  AddRange("residual of the model", residuals_deg, 2, unit + " RMS", "in held-out parts of the log",
           numbers);
  if (limited > 0) {
    numbers.push_back({.name = "parts with a limited speed",
                       .value = fmt::format("{} of {}", limited, fits.size())});
  }
  return numbers;
}

}  // namespace

std::string ChainPage(const ChainResult& result, const IdentifiedChain& chain,
                      const std::string& file) {
  const ChainLog& log = result.log();
  const std::vector<ChainFit>& fits = result.fits;
  std::string figures;
  for (std::size_t part = 0; part < fits.size(); ++part)
    figures += PartFigures(log, fits[part], part);
  std::string sections;
  if (const ResultText held_out = HeldOutText(result); !held_out.empty()) {
    sections += PageSection("held-out", "Held-out episodes",
                            "The chain of the fitted episodes, in episodes that no fit contains.",
                            HtmlOf(held_out));
  }
  sections += PageSection(
      "parts", "Measured beside simulated",
      log.episode && result.episodes.size() > 1
          ? fmt::format("Episode {}. Both follow the same command. A difference is motion that the "
                        "fitted model does not contain, such as a contact or a motor at its torque "
                        "limit.",
                        *log.episode)
          : "Both follow the same command. A difference is motion that the fitted model does not "
            "contain, such as a contact or a motor at its torque limit.",
      figures);
  PageHead head{
      .kind = "Gauntlet identify",
      .title = NameOf(log),
      .question = "How large is the delay of each joint behind its command, and why?",
      .numbers = NumbersOf(fits, log.unit_known ? "deg" : "units"),
      .facts = fmt::format("{} · {}", Counted(std::ssize(log.parts), "part"), ExtentText(result))};
  SetAnswer(VerdictOf(result, chain, file), head);
  return PlainPage({.head = std::move(head),
                    .heading = "Result",
                    .table = HtmlOf(ChainText(result)),
                    .sections = sections});
}

}  // namespace gauntlet::sim
