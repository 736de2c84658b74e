#include "sim/glove/sensor/converter.h"

#include <string>

#include "sim/base/channels.h"

namespace gauntlet::sim {
namespace {

constexpr double kMostCounts = 16777216.0;  // 2^24, as in the embedded form of a controller

double OfChannel(const std::vector<double>& values, std::size_t channel) {
  return values.at(PlaceInList(channel, values.size()));
}

void CheckList(const std::string& key, const std::vector<double>& values) {
  CheckListOfChannels(key, values.size());
  for (const double value : values) {
    if (value == std::floor(value)) continue;
    throw controller::SettingError(
        key, "is " + controller::NumberText(value) + ", must be a whole number");
  }
}

}  // namespace

double ConverterConfig::bits_of(std::size_t channel) const { return OfChannel(bits, channel); }

controller::ConverterRange ConverterConfig::range(std::size_t channel) const {
  const double least = OfChannel(min_counts, channel);
  return {.min_counts = least,
          .full_scale_counts = least + std::ldexp(1.0, static_cast<int>(bits_of(channel))) - 1.0};
}

std::vector<controller::ConverterRange> ConverterConfig::ranges() const {
  std::vector<controller::ConverterRange> ranges;
  for (std::size_t c = 0; c < KnownChannels().size(); ++c) ranges.push_back(range(c));
  return ranges;
}

void ConverterConfig::Check() const {
  CheckList("converter.bits", bits);
  CheckList("converter.min_counts", min_counts);
}

void ConverterConfig::Visit(controller::SettingsVisitor& visitor) {
  const controller::Setting resolution = {"bits",
                                          "resolution, one number, or 18 or 22 in the order of the "
                                          "channels; the scale is min_counts to "
                                          "min_counts + 2^bits - 1",
                                          8, 24};
  if (visitor.ShowsList(resolution, bits.size() != 1)) {
    visitor.Numbers(resolution, bits);
  } else {
    int one = 0;
    if (bits.size() == 1) one = static_cast<int>(bits[0]);
    visitor.Integer(resolution, one);
    if (one != 0) bits = {static_cast<double>(one)};
  }
  const controller::Setting least = {
      "min_counts",
      "smallest value, below 0 for signed counts (-2048 of 12 bits); one number, or a list as bits",
      -kMostCounts, kMostCounts};
  if (visitor.ShowsOptional(least, min_counts != std::vector{0.0})) {
    controller::VisitOneForEach(visitor, least, min_counts);
  }
}

}  // namespace gauntlet::sim
