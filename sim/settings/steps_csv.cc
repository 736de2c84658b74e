#include "sim/settings/steps_csv.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "controller/assert.h"
#include "sim/base/csv_line.h"

namespace gauntlet::sim {
namespace {

using controller::GloveStatus;
using controller::Untrusted;

/// The text of a value of StepRecorder.
std::string Cell(std::string_view column, double value) {
  if (std::isnan(value)) return "";
  if (column == "glove") return std::string(NameOf(static_cast<GloveStatus>(value)));
  if (!column.starts_with("untrusted.")) return fmt::format("{}", value);
  return value == 0.0 ? "" : std::string(NameOf(static_cast<Untrusted>(value - 1.0)));
}

}  // namespace

std::string_view NameOf(GloveStatus status) {
  switch (status) {
    case GloveStatus::kGood:
      return "good";
    case GloveStatus::kHeld:
      return "held";
    case GloveStatus::kTooOften:
      return "too_often";
    case GloveStatus::kLost:
      return "lost";
  }
  return {};
}

std::string_view NameOf(controller::LoopStatus status) {
  switch (status) {
    case controller::LoopStatus::kInTime:
      return "in_time";
    case controller::LoopStatus::kOverrun:
      return "overrun";
    case controller::LoopStatus::kWrongRate:
      return "wrong_rate";
  }
  return {};
}

std::string_view NameOf(Untrusted reason) {
  switch (reason) {
    case Untrusted::kMissing:
      return "missing";
    case Untrusted::kInfinite:
      return "infinite";
    case Untrusted::kOutOfRange:
      return "out_of_range";
    case Untrusted::kFullScale:
      return "full_scale";
    case Untrusted::kStuck:
      return "stuck";
    case Untrusted::kJumped:
      return "jumped";
    case Untrusted::kStale:
      return "stale";
  }
  return {};
}

std::string StepsToCsv(std::span<const std::string> column_names, std::span<const double> rows) {
  GAUNTLET_ASSERT(!column_names.empty() && rows.size() % column_names.size() == 0);
  std::vector<std::string> cells(column_names.begin(), column_names.end());
  std::string text = CsvLine(cells);
  for (; !cells.empty() && rows.size() >= cells.size(); rows = rows.subspan(cells.size())) {
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = Cell(column_names[i], rows[i]);
    text += CsvLine(cells);
  }
  return text;
}

}  // namespace gauntlet::sim
