#include "sim/show/pages/controller_rows.h"

#include "sim/show/figure/palette.h"

namespace gauntlet::sim {

std::vector<ControllerRow> ControllerRows(const Summary& summary) {
  const std::vector<std::size_t>& order = summary.answer.order;
  const std::vector<std::size_t> series = SeriesOf(order, summary.baseline);
  std::vector<ControllerRow> rows;
  for (const std::size_t c : order) {
    rows.push_back({c, ResultCell(summary.controllers[c].name)});
    rows.back().name.terminal_colour = TerminalColourOfSeries(series[c]);
  }
  return rows;
}

}  // namespace gauntlet::sim
