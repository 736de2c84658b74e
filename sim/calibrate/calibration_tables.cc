#include "sim/calibrate/calibration_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

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

std::string Fixed(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

std::string RemarkOn(const ChannelCalibration& channel) {
  std::string remark = channel.hidden_by_rounding ? "rounding hides it" : "";
  if (channel.spikes > 0) {
    remark += fmt::format("{}{} spikes left out", remark.empty() ? "" : ", ", channel.spikes);
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
      row.push_back({{error}, Fixed(error, 3), curve.kind == chosen ? '*' : ' '});
    }
    row.push_back({{channel.variance_counts2}, Fixed(channel.variance_counts2, 3)});
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

}  // namespace

ResultText CalibrationText(const Calibration& calibration, const CurveErrors& errors,
                           CurveKind chosen) {
  ResultText text = {
      fmt::format("{} samples at {:.6g} Hz; R from {:.0f} still ones", calibration.samples,
                  calibration.rate_hz, calibration.degrees_of_freedom),
      CalibrationTable(calibration, errors, chosen)};
  if (!errors.table_rms_deg.empty()) {
    AddLine("* in the file; the noise of the sensor is part of each error", text);
  }
  return text;
}

std::string CalibrationJson(const Calibration& calibration, const CurveErrors& errors) {
  nlohmann::ordered_json json = {
      {"recording", calibration.recording},
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
                            const std::string& unit) {
  const std::string rms = unit + " RMS";
  std::vector<std::pair<const char*, Eigen::ArrayXd>> columns = {
      {"noise", fit.noise_variance.sqrt()},
      {"change in the horizon", fit.hold_rms},
      {"left by the fit", fit.fit_rms},
      {"left by other fits", fit.held_out_rms}};
  if (held_out) {
    columns.push_back({"held-out change", held_out->hold_rms});
    columns.push_back({"held-out left", held_out->left_rms});
  }
  ResultTable table{.columns = {ForPeople("channel")}};
  for (const auto& [heading, values] : columns) table.columns.push_back(ForPeople(heading, rms));
  for (std::size_t i = 0; i < recording.channel_names.size(); ++i) {
    ResultRow& row = table.rows.emplace_back();
    row.push_back({{}, recording.channel_names[i]});
    for (const auto& [heading, values] : columns) {
      row.push_back({{}, Fixed(values[static_cast<Eigen::Index>(i)], 2)});
    }
  }
  std::string note =
      "Left by other fits: each fifth of the recording by weights fitted to the rest of it.";
  if (held_out) {
    note += fmt::format(
        " Of the recordings that are held out the weights leave {} % of the change, mean over "
        "channels.",
        Fixed(100.0 * (held_out->left_rms / held_out->hold_rms).mean(), 0));
  }
  return {fmt::format("{} samples at {:.6g} Hz", recording.counts.rows(), recording.rate_hz),
          std::move(table), std::move(note)};
}

}  // namespace gauntlet::sim
