#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/recordings/inspect/health.h"
#include "sim/recordings/inspect/inspection.h"
#include "sim/show/figure/figure.h"

namespace gauntlet::sim {

/// Kept rows of an inspection, both ends included.
struct RowStretch {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Places of the defects of a column among the kept rows.
struct DefectMarks {
  std::vector<RowStretch> gaps;     // between the times of two rows
  std::vector<RowStretch> missing;  // without a value
  std::vector<RowStretch> clipped;  // at an end of the range; only if that is a finding
  std::vector<std::size_t> spikes;  // only if that is a finding, and all rows are kept
};
DefectMarks FindDefects(const Inspection& inspection, const std::vector<HealthFinding>& findings,
                        std::size_t column);

/// A small picture of a column over time, with its name, its worst finding and marks of its
/// defects.
Figure ChannelChart(const Inspection& inspection, const std::vector<HealthFinding>& findings,
                    std::size_t column);

/// Legend of the marks that these columns use, as HTML.
std::string LegendOfMarks(const std::vector<DefectMarks>& marks);

}  // namespace gauntlet::sim
