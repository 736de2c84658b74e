#include "controller/linearisation/linearisation.h"

#include <algorithm>
#include <array>
#include <string>

#include "controller/linearisation/polynomial_linearisation.h"
#include "controller/linearisation/table_linearisation.h"
#include "controller/linearisation/two_point_linearisation.h"

namespace gauntlet::controller {
namespace {

void CheckShapes(const GloveCalibration& glove) {
  const std::size_t channels = glove.low_counts.size();
  const auto count = [](const std::vector<double>& values) {
    return std::to_string(values.size());
  };
  if (channels == 0 || glove.high_counts.size() != channels ||
      glove.low_angle_rad.size() != channels || glove.high_angle_rad.size() != channels) {
    throw SettingError("calibration", "must have two poses for each of at least one channel, has " +
                                          count(glove.low_counts) + ", " +
                                          count(glove.high_counts) + ", " +
                                          count(glove.low_angle_rad) + ", " +
                                          count(glove.high_angle_rad) + " values");
  }
}

/// The curves in the order of the channels.
std::vector<ChannelCurve> InOrder(const std::vector<ChannelCurve>& curves,
                                  const std::vector<std::string>& names, std::size_t channels) {
  std::vector<ChannelCurve> ordered(channels);
  std::vector<bool> given(channels, false);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::string place = "linearisation.channels[" + std::to_string(i) + "]";
    const std::string& name = curves[i].channel;
    std::size_t channel = i;
    if (!name.empty()) {
      channel = std::find(names.begin(), names.end(), name) - names.begin();
      if (channel >= channels) {
        throw SettingError(place + ".channel", "is " + name + ", which the glove does not have");
      }
    } else if (channel >= channels) {
      throw SettingError(place,
                         "is one too many: there are " + std::to_string(channels) + " channels");
    }
    if (given[channel]) throw SettingError(place, "is the second curve of its channel");
    given[channel] = true;
    ordered[channel] = curves[i];
  }
  const auto missing = std::find(given.begin(), given.end(), false);
  if (missing != given.end()) {
    const std::size_t channel = missing - given.begin();
    throw SettingError("linearisation.channels",
                       "has no curve for channel " +
                           (channel < names.size() ? names[channel] : std::to_string(channel)));
  }
  return ordered;
}

}  // namespace

void ChannelCurve::Visit(SettingsVisitor& visitor) {
  visitor.Text({"channel", "name of the channel; empty is the next in order"}, channel);
  visitor.Numbers({"counts", "corners of the table, growing"}, counts);
  visitor.Numbers({"angle_deg", "bending angle at each corner"}, angle_deg);
  visitor.Numbers(
      {"coefficients_deg",
       "of the polynomial in (counts - center_counts) / scale_counts, from the constant upwards"},
      coefficients_deg);
  visitor.Number({"center_counts", "middle of the polynomial's range"}, center_counts);
  visitor.Number({.key = "scale_counts",
                  .help = "half of the polynomial's range",
                  .min = 0,
                  .open_range = true},
                 scale_counts);
}

void LinearisationConfig::Visit(SettingsVisitor& visitor) {
  static constexpr std::array<std::string_view, 3> kNames = {"glove", "table", "polynomial"};
  VisitEnum(visitor,
            {"kind",
             "glove: the line through the glove's two known poses; table, polynomial: a measured "
             "curve per channel, as `gauntlet calibrate` writes it"},
            kNames, kind);
  VisitList(visitor, {"channels", "the measured curves, one per channel"}, channels);
}

std::unique_ptr<Linearisation> MakeLinearisation(const LinearisationConfig& config,
                                                 const GloveCalibration& glove,
                                                 const std::vector<std::string>& channel_names) {
  CheckShapes(glove);
  switch (config.kind) {
    case LinearisationKind::kTable:
      return MakeTableLinearisation(
          InOrder(config.channels, channel_names, glove.low_counts.size()));
    case LinearisationKind::kPolynomial:
      return MakePolynomialLinearisation(
          InOrder(config.channels, channel_names, glove.low_counts.size()));
    case LinearisationKind::kGlove:
      break;
  }
  return MakeTwoPointLinearisation(glove);
}

}  // namespace gauntlet::controller
