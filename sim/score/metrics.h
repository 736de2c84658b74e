#pragma once

#include <span>
#include <variant>

#include "sim/score/scored_parts.h"

namespace gauntlet::sim {

/// How a metric is measured on a part of its kind, in the order of ScoredPart. kNoScore where it
/// does not exist.
using Measure = std::variant<double (*)(const ScoredJoint&), double (*)(const ScoredMotor&),
                             double (*)(const ScoredCable&), double (*)(const ScoredHand&)>;

/// A metric is one row: what it is and how it is measured. Its part is that of the measure.
struct MetricRow {
  Metric metric;
  Measure measure;
};

/// All rows, in the order of Metrics().
std::span<const MetricRow> MetricRows();

}  // namespace gauntlet::sim
