#include "sim/show/paper/paper_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/show/pages/svg_chart.h"
#include "sim/trial/joint_angles.h"

namespace gauntlet::sim {
namespace {

/// The filter follows the raw signal so closely that it would cover it: the raw one is drawn wider.
constexpr double kBehind_px = 4.0;
constexpr double kOver_px = 1.2;

std::vector<double> Degrees(const Signal& angle_rad, int channel, Eigen::Index samples) {
  const Eigen::VectorXd degrees =
      kDegPerRad * angle_rad.col(channel).head(std::min(samples, angle_rad.rows()));
  return {degrees.begin(), degrees.end()};
}

Chart EmptyChart(std::string title, std::string x_label, std::string y_label) {
  Chart chart;
  chart.title = std::move(title);
  chart.x_label = std::move(x_label);
  chart.y_label = std::move(y_label);
  return chart;
}

PaperFigure Figure4(const PaperExperiment& experiment) {
  const GloveSignal& glove = *experiment.finished.result.first_glove;
  Chart chart = EmptyChart("Figure 4: the raw signal of the glove", "time [s]", "counts");
  for (const int channel : {0, 7, 10}) {
    const Eigen::VectorXd counts =
        glove.counts.col(channel).head(std::min<Eigen::Index>(2000, glove.counts.rows()));
    chart.curves.push_back({.name = glove.channel_names[static_cast<std::size_t>(channel)],
                            .first_x = 0.0,
                            .step_x = 1.0 / glove.rate_hz,
                            .values = {counts.begin(), counts.end()}});
  }
  return {"figure_04",
          "Three of the 18 channels for two seconds: integer counts of the converter, with the "
          "paper's noise.",
          {{"figure_04.svg", SvgChart(chart)}}};
}

PaperFigure Figure7(const GeneratorTest& test) {
  ChartCurve law{
      .name = "normal law", .first_x = test.first_bin, .step_x = test.bin_width, .values = {}};
  for (std::size_t i = 0; i < test.normal_density.size(); ++i) {
    const double z = test.first_bin + test.bin_width * static_cast<double>(i);
    law.values.push_back(std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi));
  }
  const Chart chart{.title = "Figure 7: noise by Box-Muller",
                    .x_label = "standard deviations",
                    .y_label = "density",
                    .bars = {{.name = fmt::format("{} draws", test.draws),
                              .first_x = test.first_bin,
                              .step_x = test.bin_width,
                              .heights = test.normal_density}},
                    .curves = {{}, law}};
  return {"figure_07",
          "The basic form of the transform, from the generator that the glove uses.",
          {{"figure_07.svg", SvgChart(chart)}}};
}

PaperFigure Figure9(const GeneratorTest& test) {
  ChartCurve law{.name = "normal law", .first_x = 0.0, .step_x = 0.1, .values = {}};
  const double variance = 0.25 * test.galton_rows;
  for (int i = 0; i <= 10 * test.galton_rows; ++i) {
    const double z = 0.1 * i - 0.5 * test.galton_rows;
    law.values.push_back(std::exp(-0.5 * z * z / variance) /
                         std::sqrt(2.0 * std::numbers::pi * variance));
  }
  const Chart chart{.title = fmt::format("Figure 9: a Galton board of {} rows", test.galton_rows),
                    .x_label = "bin",
                    .y_label = "share of the balls",
                    .bars = {{.name = fmt::format("{} balls", test.draws),
                              .first_x = 0.0,
                              .step_x = 1.0,
                              .heights = test.galton_share}},
                    .curves = {{}, law}};
  return {"figure_09",
          "Binomial, and near to the normal law: how near is said in row P10.",
          {{"figure_09.svg", SvgChart(chart)}}};
}

PaperFigure Figure10(const OneChannelTest& test) {
  const auto part = [](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + 900, values.begin() + 1200);
  };
  const auto curves = [&](bool zoom) {
    std::vector<ChartCurve> all;
    for (const auto& [name, values] :
         {std::pair{"Z", &test.measured}, std::pair{"Xaposteriori", &test.filtered},
          std::pair{"truth", &test.truth}}) {
      all.push_back({.name = name,
                     .first_x = zoom ? 900.0 : 0.0,
                     .step_x = 1.0,
                     .values = zoom ? part(*values) : *values,
                     .width_px = all.empty() && !zoom ? kBehind_px : kOver_px});
    }
    return all;
  };
  Chart whole = EmptyChart("Figure 10: 6000 steps of one channel", "step", "counts");
  whole.curves = curves(false);
  Chart near = EmptyChart("The same, nearer", "step", "counts");
  near.curves = curves(true);
  return {"figure_10",
          "One channel with R = 21.18 and Q = 1. Nearer, one sees that the filter follows most of "
          "the noise.",
          {{"figure_10.svg", SvgChart(whole)}, {"figure_10_near.svg", SvgChart(near)}}};
}

/// From where to where a joint's angle changes most within so many ticks.
std::pair<Eigen::Index, Eigen::Index> LiveliestPart(const Signal& angle_rad, int joint,
                                                    Eigen::Index samples, Eigen::Index length) {
  const Eigen::Index end = std::min(samples, angle_rad.rows());
  Eigen::Index first = 0;
  double most_rad = -1.0;
  for (Eigen::Index k = 0; k + length <= end; ++k) {
    const double change_rad = std::abs(angle_rad(k + length - 1, joint) - angle_rad(k, joint));
    if (change_rad > most_rad) {
      most_rad = change_rad;
      first = k;
    }
  }
  return {first, std::min(first + length, end)};
}

/// The three curves of a channel, from one tick to before another.
Chart ChartOfChannel(std::string title, const WayOfAngles& way, int joint,
                     std::pair<Eigen::Index, Eigen::Index> ticks, double rate_hz,
                     double behind_px) {
  Chart chart = EmptyChart(std::move(title), "time [s]", "deg");
  const auto [first, end] = ticks;
  for (const auto& [name, angle] :
       {std::pair{"original", &way.raw}, std::pair{"processed", &way.filtered},
        std::pair{"sent to the motor", &way.command}}) {
    const std::vector<double> all = Degrees(*angle, joint, end);
    chart.curves.push_back({.name = name,
                            .first_x = static_cast<double>(first) / rate_hz,
                            .step_x = 1.0 / rate_hz,
                            .values = {all.begin() + first, all.end()},
                            .width_px = chart.curves.empty() ? behind_px : kOver_px});
  }
  return chart;
}

PaperFigure Figure12(const PaperExperiment& experiment) {
  const StudyResult& result = experiment.finished.result;
  const Trace& trace = result.first_traces[ControllerIndex(result, "paper_kalman")];
  const Study& study = experiment.finished.study;
  const WayOfAngles way = WayOf(trace, study.joint_map(), study.hand->transmission());
  const double rate_hz = result.first_glove->tick_rate_hz;
  const auto ticks = [rate_hz](double time_s) {
    return static_cast<Eigen::Index>(std::lround(time_s * rate_hz));
  };
  const Eigen::Index samples = std::min(ticks(4.0), way.raw.rows());
  constexpr std::array kOfThePaper = {1, 5, 8, 10, 13, 16};
  std::vector<PaperChart> charts;
  const int channels = static_cast<int>(result.first_glove->channel_names.size());
  for (int number = 1; number <= channels; ++number) {
    const int joint = number - 1;  // of a hand that has a joint for each channel
    const bool is_extra = std::ranges::count(kOfThePaper, number) == 0;
    const std::string& name = study.hand->joint_names()[static_cast<std::size_t>(joint)];
    const auto near = LiveliestPart(way.filtered, joint, samples, ticks(0.3));
    charts.push_back(
        {fmt::format("figure_12_channel_{:02}.svg", number),
         SvgChart(ChartOfChannel(fmt::format("Figure 12: channel {}, {}", number, name), way, joint,
                                 {0, samples}, rate_hz, kBehind_px)),
         is_extra});
    charts.push_back(
        {fmt::format("figure_12_channel_{:02}_near.svg", number),
         SvgChart(ChartOfChannel(fmt::format("Channel {}, nearer: its fastest 0.3 s", number), way,
                                 joint, near, rate_hz, kOver_px)),
         is_extra});
  }
  return {"figure_12",
          "Six channels as in the paper for four seconds, with the paper's filter. The command is "
          "what the servos hold: integer, a frame every 20 ms, later by the link delay.",
          charts, "The other twelve channels"};
}

}  // namespace

std::vector<PaperFigure> PaperFigures(const PaperExperiment& experiment) {
  return {Figure4(experiment), Figure7(experiment.generators), Figure9(experiment.generators),
          Figure10(experiment.one_channel), Figure12(experiment)};
}

}  // namespace gauntlet::sim
