#include "sim/settings/glove_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

namespace gauntlet::sim {
namespace {

using controller::SettingError;

/// Index of each named channel in the calibration.
std::vector<std::size_t> PlacesOf(const Calibration& calibration,
                                  const std::vector<std::string>& channel_names) {
  std::vector<std::size_t> places;
  for (const std::string& name : channel_names) {
    const auto found = std::ranges::find(calibration.channels, name, &ChannelCalibration::channel);
    if (found == calibration.channels.end()) {
      throw SettingError("calibration", "has nothing for channel " + name);
    }
    places.push_back(found - calibration.channels.begin());
  }
  return places;
}

/// R of the channels at `places`, row by row. Quantisation is noise too: it bounds the variances on
/// the diagonal from below.
std::vector<double> CovarianceOf(const Calibration& calibration,
                                 const std::vector<std::size_t>& places) {
  const double rounding = calibration.resolution_counts * calibration.resolution_counts / 12.0;
  std::vector<double> covariance;
  for (const std::size_t row : places) {
    const std::vector<double>& values = calibration.channels[row].covariance_counts2;
    if (values.size() != calibration.channels.size()) {
      throw SettingError("calibration",
                         fmt::format("channels[{}].covariance_counts2: has {} "
                                     "values, must have {}, one per channel",
                                     row, values.size(), calibration.channels.size()));
    }
    for (const std::size_t column : places) {
      covariance.push_back(row == column ? std::max(values[column], rounding) : values[column]);
    }
  }
  return covariance;
}

std::vector<double> DiagonalOf(const std::vector<double>& covariance, std::size_t size) {
  std::vector<double> diagonal;
  for (std::size_t i = 0; i < size; ++i) diagonal.push_back(covariance[i * size + i]);
  return diagonal;
}

controller::ChannelCurve CurveOf(const Calibration& calibration, const std::string& channel) {
  for (const controller::ChannelCurve& curve : calibration.linearisation.channels) {
    if (curve.channel == channel) return curve;
  }
  throw SettingError("calibration", "linearisation.channels has no curve for channel " + channel);
}

}  // namespace

void ChannelCalibration::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({.key = "channel", .help = "name of the channel", .required = true}, channel);
  visitor.Number({"rms_error_deg", "of the curve on the settled samples", 0}, rms_error_deg);
  visitor.Number({"largest_error_deg", "of the curve on a settled sample", 0}, largest_error_deg);
  visitor.Numbers(
      {"half_width_95_deg", "half of the 95 % interval of each angle or coefficient of the curve"},
      half_width_95_deg);
  visitor.Number({"variance_counts2", "R of the channel", 0}, variance_counts2);
  visitor.Number({"variance_low_counts2", "lower end of its confidence interval"},
                 variance_low_counts2);
  visitor.Number({"variance_high_counts2", "upper end of its confidence interval"},
                 variance_high_counts2);
  visitor.Flag(
      {"hidden_by_rounding", "noise below 0.7 counts: R is the most likely one, its interval wide"},
      hidden_by_rounding);
  visitor.Integer({"spikes", "samples left out of R", 0}, spikes);
  visitor.Number({"neighbour_correlation", "of samples that follow each other; 0 is white noise"},
                 neighbour_correlation);
  visitor.Numbers({.key = "covariance_counts2",
                   .help = "row of the full R: with every channel, in the order of this list",
                   .required = true},
                  covariance_counts2);
  visitor.Numbers({"covariance_low_counts2", "lower ends of the intervals"},
                  covariance_low_counts2);
  visitor.Numbers({"covariance_high_counts2", "upper ends of the intervals"},
                  covariance_high_counts2);
}

void Calibration::Visit(controller::SettingsVisitor& visitor) {
  visitor.Text({"recording", "what it was made from"}, recording);
  visitor.Integer({"samples", "of the recording", 0}, samples);
  visitor.Number({.key = "rate_hz", .help = "samples per second", .min = 0, .open_range = true},
                 rate_hz);
  visitor.Number({.key = "confidence_percent",
                  .help = "of the intervals of R",
                  .min = 0,
                  .max = 100,
                  .open_range = true},
                 confidence_percent);
  visitor.Number({"resolution_counts", "steps of the recorded values", 0}, resolution_counts);
  visitor.Number({"degrees_of_freedom", "still samples less still stretches, the weight of R", 0},
                 degrees_of_freedom);
  controller::VisitGroup(visitor, {"linearisation", "the curves; kind glove if it has none"},
                         linearisation);
  controller::VisitList(visitor, {"channels", "how good curves are; R"}, channels);
}

void UseCalibration(const Calibration& calibration, const std::vector<std::string>& channel_names,
                    bool take_linearisation, const std::vector<bool>& take_r,
                    controller::ControllerConfig& config) {
  const std::vector<std::size_t> places = PlacesOf(calibration, channel_names);
  if (take_linearisation &&
      calibration.linearisation.kind != controller::LinearisationKind::kGlove) {
    config.linearisation.kind = calibration.linearisation.kind;
    config.linearisation.channels.clear();
    for (const std::string& name : channel_names) {
      config.linearisation.channels.push_back(CurveOf(calibration, name));
    }
  }
  const std::vector<double> covariance = CovarianceOf(calibration, places);
  const auto set_r = [&](std::vector<double>& r, bool full) {
    if (config.filter_on == controller::FilterOn::kAngle) {
      throw SettingError("calibration",
                         "gives r in counts^2, but filter_on is angle: give the filter its own r, "
                         "in rad^2");
    }
    r = full ? covariance : DiagonalOf(covariance, channel_names.size());
  };
  for (std::size_t i = 0; i < config.filters.size(); ++i) {
    if (!take_r[i]) continue;
    std::visit(
        [&](auto& settings) {
          if constexpr (requires { settings.noise.r; }) set_r(settings.noise.r, false);
          if constexpr (requires { settings.r; }) set_r(settings.r, true);
        },
        config.filters[i].settings);
  }
}

}  // namespace gauntlet::sim
