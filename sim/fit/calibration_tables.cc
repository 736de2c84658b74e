#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/base/json.h"
#include "sim/fit/calibration.h"
#include "sim/fit/fit_tables.h"

namespace gauntlet::sim {
namespace {

struct Curve {
  const char* name;
  CurveKind kind;
  std::vector<double> CurveErrors::*rms_deg;
};

constexpr Curve kCurves[] = {
    {"two_point", CurveKind::kTwoPoint, &CurveErrors::two_point_rms_deg},
    {"polynomial", CurveKind::kPolynomial, &CurveErrors::polynomial_rms_deg},
    {"table", CurveKind::kTable, &CurveErrors::table_rms_deg}};

std::string RemarkOn(const ChannelCalibration& channel) {
  std::string remark = channel.hidden_by_rounding ? "rounding hides noise" : "";
  if (channel.spikes > 0) {
    remark += fmt::format("{}{} spike{} left out", remark.empty() ? "" : ", ", channel.spikes,
                          channel.spikes == 1 ? "" : "s");
  }
  return remark;
}

ResultTable CalibrationTable(const Calibration& calibration, const CurveErrors& errors,
                             CurveKind chosen) {
  const bool has_curves = !errors.table_rms_deg.empty();
  ResultTable table{.columns = {{"channel", "channel"}}};
  for (const Curve& curve : kCurves) {
    if (!has_curves) break;
    table.columns.push_back({std::string(curve.name) + "_rms_deg", curve.name, "deg RMS"});
  }
  const std::string interval = fmt::format("{:.4g} % interval", calibration.confidence_percent);
  table.columns.push_back({"variance_counts2", "R", "counts^2"});
  table.columns.push_back(ForPeople(interval, "counts^2"));
  for (const char* key :
       {"variance_low_counts2", "variance_high_counts2", "hidden_by_rounding", "spikes"}) {
    table.columns.push_back({key});
  }
  table.columns.push_back(ForPeople("remarks").Words());
  for (std::size_t i = 0; i < calibration.channels.size(); ++i) {
    const ChannelCalibration& channel = calibration.channels[i];
    ResultRow& row = table.rows.emplace_back();
    row.emplace_back(channel.channel);
    for (const Curve& curve : kCurves) {
      if (!has_curves) break;
      const double error = (errors.*curve.rms_deg)[i];
      row.push_back({{error}, FixedText(error, 3), curve.kind == chosen ? '*' : ' '});
    }
    row.push_back(FixedCell(channel.variance_counts2, 3));
    row.push_back({{},
                   fmt::format("{:.3f} to {:.3f}", channel.variance_low_counts2,
                               channel.variance_high_counts2)});
    for (const ResultValue& value :
         {ResultValue(channel.variance_low_counts2), ResultValue(channel.variance_high_counts2),
          ResultValue(channel.hidden_by_rounding), ResultValue(std::int64_t{channel.spikes})}) {
      row.emplace_back(value);
    }
    row.push_back({{}, RemarkOn(channel)});
  }
  return table;
}

/// The error of the chosen curve and R.
ResultTable ChosenTable(const Calibration& calibration, const std::vector<double>& error_deg) {
  ResultTable table{.columns = {ForPeople("channel")}};
  if (!error_deg.empty()) table.columns.push_back(ForPeople("error", "deg RMS"));
  table.columns.push_back(ForPeople("R", "counts^2"));
  table.columns.push_back(ForPeople("remarks").Words());
  for (std::size_t i = 0; i < calibration.channels.size(); ++i) {
    const ChannelCalibration& channel = calibration.channels[i];
    ResultRow& row = table.rows.emplace_back();
    row.push_back(ResultCell::Text(channel.channel));
    if (!error_deg.empty()) row.push_back(ResultCell::Text(FixedText(error_deg[i], 3)));
    row.push_back(ResultCell::Text(FixedText(channel.variance_counts2, 3)));
    row.push_back(ResultCell::Text(RemarkOn(channel)));
  }
  return table;
}

/// "mean error 0.55 deg RMS, largest 1.10 (little_mcp)"; NaN has no part in it.
std::string ErrorText(const Calibration& calibration, const std::vector<double>& error_deg) {
  double sum = 0.0;
  int count = 0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < error_deg.size(); ++i) {
    if (!std::isfinite(error_deg[i])) continue;
    sum += error_deg[i];
    ++count;
    if (!(error_deg[i] <= error_deg[worst])) worst = i;
  }
  if (count == 0) return "no error known";
  if (count == 1) return fmt::format("error {:.2f} deg RMS", error_deg[worst]);
  return fmt::format("mean error {:.2f} deg RMS, largest {:.2f} ({})", sum / count,
                     error_deg[worst], calibration.channels[worst].channel);
}

std::string VarianceText(const Calibration& calibration) {
  const auto [low, high] =
      std::ranges::minmax(calibration.channels, {}, &ChannelCalibration::variance_counts2);
  if (calibration.channels.size() == 1) {
    return fmt::format("R is {:.3g} counts^2.", low.variance_counts2);
  }
  return fmt::format("R is {:.3g} ({}) to {:.3g} counts^2 ({}).", low.variance_counts2, low.channel,
                     high.variance_counts2, high.channel);
}

}  // namespace

ResultText CalibrationText(const Calibration& calibration, const CurveErrors& errors,
                           CurveKind chosen, const std::string& file, bool verbose) {
  const Curve& curve = *std::ranges::find(kCurves, chosen, &Curve::kind);
  const std::vector<double>& error_deg = errors.*curve.rms_deg;
  const bool has_curves = !errors.table_rms_deg.empty();
  ResultText text = {fmt::format("{}: {} samples at {:.6g} Hz; R from {:.0f} still samples",
                                 calibration.recording, calibration.samples, calibration.rate_hz,
                                 calibration.degrees_of_freedom)};
  text.emplace_back(has_curves
                        ? fmt::format("Curve {}: {}", curve.name, ErrorText(calibration, error_deg))
                        : "Noise R only, no curve: the recording has no known angles");
  std::get<std::string>(text.back()) += fmt::format(
      "; written to {}, for a controller's key calibration. {}", file, VarianceText(calibration));
  text.emplace_back(ChosenTable(calibration, error_deg));
  if (!verbose) return text;
  text.emplace_back(CalibrationTable(calibration, errors, chosen));
  if (has_curves) AddLine("* in the file; the noise of the sensor is part of each error", text);
  return text;
}

std::string CalibrationJson(const Calibration& calibration, const CurveErrors& errors) {
  Json json = {{"recording", calibration.recording},
               {"samples", calibration.samples},
               {"rate_hz", calibration.rate_hz},
               {"degrees_of_freedom", calibration.degrees_of_freedom},
               {"confidence_percent", calibration.confidence_percent},
               {"channels", JsonOf(CalibrationTable(calibration, errors, CurveKind::kTable))}};
  for (std::size_t i = 0; i < calibration.channels.size(); ++i) {
    json["channels"][i]["covariance_counts2"] = calibration.channels[i].covariance_counts2;
  }
  return json.dump(2) + "\n";
}

ResultText PredictorFitText(const PoseRecording& recording, const controller::PredictorFit& fit,
                            const std::optional<controller::PredictionErrors>& held_out,
                            const std::string& unit, const std::string& file, bool verbose) {
  const std::string rms = unit + " RMS";
  const double left = 100.0 * (fit.held_out_rms / fit.hold_rms).mean();
  std::string answer =
      fmt::format("The prediction leaves {} % of the change in the horizon", FixedText(left, 0));
  if (held_out) {
    answer += fmt::format(", and {} % on held-out recordings",
                          FixedText(100.0 * (held_out->left_rms / held_out->hold_rms).mean(), 0));
  }
  answer += fmt::format(
      " (mean over channels): written to {}. The weights come from this recording and serve "
      "motions "
      "like it.",
      file);
  if (left >= 100.0) answer += " Do not use it: without a prediction 100 % are left.";
  std::vector<std::pair<const char*, Eigen::ArrayXd>> columns = {
      {"change in the horizon", fit.hold_rms}, {"left by other fits", fit.held_out_rms}};
  if (held_out) columns.emplace_back("held-out left", held_out->left_rms);
  if (verbose) {
    if (held_out) columns.emplace_back("held-out change", held_out->hold_rms);
    columns.emplace_back("left by the fit", fit.fit_rms);
    columns.emplace_back("noise", fit.noise_variance.sqrt());
  }
  ResultTable table{.columns = {ForPeople("channel")}};
  for (const auto& [heading, values] : columns) table.columns.push_back(ForPeople(heading, rms));
  for (std::size_t i = 0; i < recording.channel_names.size(); ++i) {
    ResultRow& row = table.rows.emplace_back();
    row.push_back(ResultCell::Text(recording.channel_names[i]));
    for (const auto& [heading, values] : columns) {
      row.push_back(ResultCell::Text(FixedText(values[static_cast<Eigen::Index>(i)], 2)));
    }
  }
  ResultText text = {fmt::format("{}: {} samples at {:.6g} Hz", recording.name,
                                 recording.counts.rows(), recording.rate_hz),
                     std::move(answer), std::move(table)};
  if (verbose) {
    AddLine("Left by other fits: each fifth of the recording by weights fitted to the rest of it.",
            text);
  }
  return text;
}

}  // namespace gauntlet::sim
