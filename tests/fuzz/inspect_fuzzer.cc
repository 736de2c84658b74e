// What gauntlet inspect finds in a text of anybody: the place of its table, its time, the joints in
// its names, and column maps. Whatever it is, it ends with a table or with a UserError of one line.
#include <cstdlib>
#include <string_view>

#include "sim/base/error.h"
#include "sim/inspect/joint_names.h"
#include "sim/inspect/table_layout.h"
#include "sim/inspect/time_guess.h"
#include "sim/recordings/time_text.h"

namespace gauntlet::sim {
namespace {

void Read(std::string_view text) {
  if (const auto seconds = SecondsOfText(text); seconds && !(*seconds > -1e12 && *seconds < 1e12)) {
    std::abort();
  }
  try {
    const TableLayout layout = FindTable("fuzz", TextSource(text));
    if (layout.names.size() != layout.columns || layout.skipped_lines < 0) std::abort();
    for (const auto& row : layout.rows) {
      if (row.size() != layout.columns) std::abort();
    }
    for (const TimePart& part : GuessTime(layout).parts) {
      if (part.column >= layout.columns) std::abort();
    }
    std::vector<std::string> why;
    if (ChannelsByNames(layout.names, why).size() != layout.columns) std::abort();
  } catch (const UserError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

}  // namespace
}  // namespace gauntlet::sim

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gauntlet::sim::Read({reinterpret_cast<const char*>(data), size});
  return 0;
}
