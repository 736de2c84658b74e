#include <fmt/format.h>

#include "sim/settings/libraries/library.h"
#include "sim/settings/libraries/one_euro_like.h"

namespace gauntlet::sim {
namespace {

using controller::OneEuroConfig;

/// Settings in the order of both packages: freq, mincutoff, beta, dcutoff. Empty for a filter that
/// takes its speed from the last sample.
std::vector<std::string> ArgumentsOf(const PlainFilter& filter) {
  const auto& config = std::get<OneEuroConfig>(filter.settings);
  if (config.speed_from != OneEuroConfig::SpeedFrom::kFiltered) return {};
  return {LineNumber(filter.rate_hz), LineNumber(config.min_cutoff_hz), LineNumber(config.beta),
          LineNumber(config.derivative_cutoff_hz)};
}

std::string PypiLines(const PlainFilter& filter) {
  const std::vector<std::string> a = ArgumentsOf(filter);
  if (a.empty()) return "";
  return fmt::format(R"(from OneEuroFilter import OneEuroFilter

one_euro = OneEuroFilter(freq={}, mincutoff={}, beta={}, dcutoff={})  # one for each channel

def smooth(samples):
    return [one_euro(sample) for sample in samples]
)",
                     a[0], a[1], a[2], a[3]);
}

std::string NpmLines(const PlainFilter& filter) {
  const std::vector<std::string> a = ArgumentsOf(filter);
  if (a.empty()) return "";
  return fmt::format(R"(const {{ OneEuroFilter }} = require("1eurofilter");

const oneEuro = new OneEuroFilter({}, {}, {}, {}); // one for each channel
const smooth = (samples) => samples.map((sample) => oneEuro.filter(sample));
)",
                     a[0], a[1], a[2], a[3]);
}

class PackageLike final : public OneEuroLike {
 public:
  PackageLike() : OneEuroLike(OneEuroConfig::SpeedFrom::kFiltered) {}

  void Visit(controller::SettingsVisitor& visitor) override {
    VisitValues(visitor, "mincutoff", "dcutoff");
    VisitUnit(visitor);
  }
};

const std::vector<std::string_view> kDifferences = {
    "With timestamps each interval is its own; Gauntlet has one rate. Give none, or regular ones.",
    "It takes a missing sample (NaN) into its state for ever: give the last good sample again."};

}  // namespace

Library OneEuroOfPypi() {
  return {.name = "oneeurofilter",
          .package = "OneEuroFilter 0.2.1 (PyPI)",
          .comment = "#",
          .kinds = {OneEuroConfig::kKind},
          .differences = kDifferences,
          .lines = PypiLines,
          .like = MakeLike<PackageLike>,
          .like_kind = OneEuroConfig::kKind};
}

Library OneEuroOfNpm() {
  return {.name = "1eurofilter",
          .package = "1eurofilter 1.3.0 (npm)",
          .comment = "//",
          .kinds = {OneEuroConfig::kKind},
          .differences = kDifferences,
          .lines = NpmLines,
          .like = MakeLike<PackageLike>,
          .like_kind = OneEuroConfig::kKind};
}

}  // namespace gauntlet::sim
