#include "sim/settings/steps_csv.h"

#include <fmt/format.h>

#include <array>
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
  constexpr std::array<std::string_view, 4> kNames = {"good", "held", "too_often", "lost"};
  return kNames.at(static_cast<std::size_t>(status));
}

std::string_view NameOf(controller::LoopStatus status) {
  constexpr std::array<std::string_view, 3> kNames = {"in_time", "overrun", "wrong_rate"};
  return kNames.at(static_cast<std::size_t>(status));
}

std::string_view NameOf(Untrusted reason) {
  constexpr std::array<std::string_view, controller::kUntrustedKinds> kNames = {
      "missing", "infinite", "out_of_range", "full_scale", "stuck", "jumped", "stale"};
  return kNames.at(static_cast<std::size_t>(reason));
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
